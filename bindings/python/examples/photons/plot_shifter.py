"""
A wavelength shifter
====================

Ultraviolet light enters a plate that absorbs it and emits blue light. Total reflection guides a large part of the blue light to the
edges.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave.photons as photons

PLATE = """
<gdml>
  <define>
    <matrix name="N" coldim="2" values="1.5*eV 1.58 4.2*eV 1.58"/>
    <matrix name="ONE" coldim="2" values="1.5*eV 1 4.2*eV 1"/>
    <matrix name="ABS" coldim="2" values="1.5*eV 3000 4.2*eV 3000"/>
    <matrix name="WLSABS" coldim="2" values="1.5*eV 1e6 2.9*eV 1e6 3.1*eV 0.5 4.2*eV 0.5"/>
    <matrix name="EMIT" coldim="2" values="2.3*eV 0 2.6*eV 0.6 2.85*eV 1 2.95*eV 0"/>
    <matrix name="ZERO" coldim="2" values="1.5*eV 0 4.2*eV 0"/>
  </define>
  <materials>
    <material name="Air" Z="7"><D value="0.00129"/><atom value="14"/><property name="RINDEX" ref="ONE"/></material>
    <material name="Plastic" Z="6"><D value="1.03"/><atom value="12"/>
      <property name="RINDEX" ref="N"/><property name="ABSLENGTH" ref="ABS"/><property name="WLSABSLENGTH" ref="WLSABS"/>
      <property name="WLSCOMPONENT" ref="EMIT"/></material>
  </materials>
  <solids>
    <box name="Room" x="400" y="400" z="400" lunit="mm"/>
    <box name="PlateBox" x="100" y="100" z="4" lunit="mm"/>
  </solids>
  <structure>
    <volume name="Plate"><materialref ref="Plastic"/><solidref ref="PlateBox"/></volume>
    <volume name="World"><materialref ref="Air"/><solidref ref="Room"/><physvol name="p"><volumeref ref="Plate"/></physvol></volume>
  </structure>
  <setup name="Default" version="1.0"><world ref="World"/></setup>
</gdml>
"""
detector = photons.loads(PLATE)
source = photons.disc([0, 0, -50], 20, ("uniform", 330, 380), towards=[0, 0, 1])
steps = detector.simulate(source, n=3_000, seed=3, record="steps").histories
names = np.array(steps.process_names)[steps["process"]]

emitted = names == "reemission"
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
left.hist(steps["wavelength_nm"][names == "emission"], bins=60, range=(320, 560), alpha=0.7, label="incoming")
left.hist(steps["wavelength_nm"][emitted], bins=60, range=(320, 560), alpha=0.7, label="emitted again")
left.set(xlabel="wavelength in nm", ylabel="photons")
left.legend()
leaves = (names == "fresnel_refraction") & (np.abs(steps["x"]) <= 50.001) & (steps["wavelength_nm"] > 400)
x, y, z = steps["x"][leaves], steps["y"][leaves], steps["z"][leaves]
at_edge = np.maximum(np.abs(x), np.abs(y)) > 50 - 1e-6
for place, label in ((~at_edge, "faces"), (at_edge, "edges")):
    right.plot(x[place], y[place], ".", ms=2, label=label)
right.set(aspect="equal", xlabel="x in mm", ylabel="y in mm", title="where blue light leaves the plate")
right.legend()

print(f"{emitted.sum()} photons are shifted; {at_edge.mean():.1%} of the blue light leaves through the edges")
# the two faces have two escape cones: without them, this fraction of isotropic light is guided
print(f"guided by total reflection at the faces: {np.sqrt(1 - 1 / 1.58**2):.1%}")
