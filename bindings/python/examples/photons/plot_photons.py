"""
Photons in a crystal
====================

Optical photons in a crystal bar with a diffuse wrapping and a photodiode at one end: where and when they are detected.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave.photons as photons

BAR = """
<gdml>
  <define>
    <matrix name="INDEX" coldim="2" values="1.5*eV 1.79 4*eV 1.79"/>
    <matrix name="LENGTH" coldim="2" values="1.5*eV 400 4*eV 400"/>
    <matrix name="WRAP" coldim="2" values="1.5*eV 0.95 4*eV 0.95"/>
    <matrix name="QUANTUM" coldim="2" values="1.5*eV 0.3 4*eV 0.3"/>
    <matrix name="NONE" coldim="2" values="1.5*eV 0 4*eV 0"/>
  </define>
  <materials>
    <element name="Cs" Z="55"><atom value="132.9"/></element>
    <element name="I" Z="53"><atom value="126.9"/></element>
    <material name="Crystal"><D value="4.51"/><fraction n="0.511" ref="Cs"/><fraction n="0.489" ref="I"/>
      <property name="RINDEX" ref="INDEX"/><property name="ABSLENGTH" ref="LENGTH"/></material>
    <material name="Opaque"><D value="2"/><fraction n="1" ref="Cs"/></material>
  </materials>
  <solids>
    <box name="Room" x="200" y="200" z="200" lunit="mm"/>
    <box name="BarBox" x="20" y="20" z="100" lunit="mm"/>
    <box name="DiodeBox" x="20" y="20" z="1" lunit="mm"/>
    <opticalsurface name="Wrapping" model="unified" finish="groundfrontpainted" type="dielectric_dielectric" value="0">
      <property name="REFLECTIVITY" ref="WRAP"/></opticalsurface>
    <opticalsurface name="Cathode" model="unified" finish="polished" type="dielectric_metal" value="0">
      <property name="REFLECTIVITY" ref="NONE"/><property name="EFFICIENCY" ref="QUANTUM"/></opticalsurface>
  </solids>
  <structure>
    <volume name="Bar"><materialref ref="Crystal"/><solidref ref="BarBox"/></volume>
    <volume name="Diode"><materialref ref="Opaque"/><solidref ref="DiodeBox"/></volume>
    <volume name="World"><materialref ref="Opaque"/><solidref ref="Room"/>
      <physvol name="bar"><volumeref ref="Bar"/></physvol>
      <physvol name="diode"><volumeref ref="Diode"/><position name="p" z="50.5" unit="mm"/></physvol>
    </volume>
    <bordersurface name="end" surfaceproperty="Cathode"><physvolref ref="bar"/><physvolref ref="diode"/></bordersurface>
    <skinsurface name="wrap" surfaceproperty="Wrapping"><volumeref ref="Bar"/></skinsurface>
  </structure>
  <setup name="Default" version="1.0"><world ref="World"/></setup>
</gdml>
"""

detector = photons.loads(BAR)
run = detector.simulate(photons.point([0, 0, 0], 550), n=20_000, seed=1)
hits = run.hits
print(run.ends)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
counts, _, _, shown = left.hist2d(hits["x"], hits["y"], bins=10, range=[[-10, 10], [-10, 10]])
figure.colorbar(shown, ax=left, label="hits in 4 mm²")
left.set(aspect="equal", xlabel="x in mm", ylabel="y in mm")
right.hist(hits["time"], bins=60)
right.set(xlabel="time in ns", ylabel="hits")

# no photon is faster than light from the middle of the bar to its end
assert counts.sum() == hits.rows
assert hits["time"].min() >= 50 * 1.79 / 299.792458
