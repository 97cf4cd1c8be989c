"""
From GDML to a hit map
======================

A scintillating tile with four light sensors, described in GDML: checked, simulated, mapped, and used to find where a flash of
light was.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave.photons as photons

# %%
# The detector
# ------------
# A tile of plastic with a white wrapping, and four sensors on its top face. The sensors are copies of one volume.

SENSORS = "".join(
    f'<physvol name="s{k}" copynumber="{k}"><volumeref ref="Sensor"/>'
    f'<position name="p{k}" x="{x}" y="{y}" z="5.5" unit="mm"/></physvol>'
    for k, (x, y) in enumerate([(-30, -30), (30, -30), (-30, 30), (30, 30)])
)
BORDERS = "".join(
    f'<bordersurface name="b{k}" surfaceproperty="Cathode"><physvolref ref="tile"/><physvolref ref="s{k}"/></bordersurface>'
    for k in range(4)
)
GDML = f"""
<gdml>
  <define>
    <matrix name="INDEX" coldim="2" values="2*eV 1.58 4*eV 1.58"/>
    <matrix name="LENGTH" coldim="2" values="2*eV 1000 4*eV 1000"/>
    <matrix name="WHITE" coldim="2" values="2*eV 0.97 4*eV 0.97"/>
    <matrix name="QUANTUM" coldim="2" values="2*eV 0.4 4*eV 0.4"/>
    <matrix name="NONE" coldim="2" values="2*eV 0 4*eV 0"/>
  </define>
  <materials>
    <material name="Plastic" Z="6"><D value="1.03"/><atom value="12"/>
      <property name="RINDEX" ref="INDEX"/><property name="ABSLENGTH" ref="LENGTH"/></material>
    <material name="Opaque" Z="14"><D value="2"/><atom value="28"/></material>
  </materials>
  <solids>
    <box name="Room" x="300" y="300" z="300" lunit="mm"/>
    <box name="TileBox" x="100" y="100" z="10" lunit="mm"/>
    <box name="SensorBox" x="6" y="6" z="1" lunit="mm"/>
    <opticalsurface name="Wrapping" model="unified" finish="groundfrontpainted" type="dielectric_dielectric" value="0">
      <property name="REFLECTIVITY" ref="WHITE"/></opticalsurface>
    <opticalsurface name="Cathode" model="unified" finish="polished" type="dielectric_metal" value="0">
      <property name="REFLECTIVITY" ref="NONE"/><property name="EFFICIENCY" ref="QUANTUM"/></opticalsurface>
  </solids>
  <structure>
    <volume name="Tile"><materialref ref="Plastic"/><solidref ref="TileBox"/></volume>
    <volume name="Sensor"><materialref ref="Opaque"/><solidref ref="SensorBox"/>
      <auxiliary auxtype="SensDet" auxvalue="diode"/></volume>
    <volume name="World"><materialref ref="Opaque"/><solidref ref="Room"/>
      <physvol name="tile"><volumeref ref="Tile"/></physvol>{SENSORS}</volume>
    {BORDERS}
    <skinsurface name="wrap" surfaceproperty="Wrapping"><volumeref ref="Tile"/></skinsurface>
  </structure>
  <setup name="Default" version="1.0"><world ref="World"/></setup>
</gdml>
"""
detector = photons.loads(GDML)
detector

# %%
# ``check`` looks for probable mistakes of the optical part and finds none.

findings = detector.check()
assert findings.to_pandas().empty
findings

# %%
# A flash
# -------
# 40,000 photons from one point, in all directions, with a decay time of 2 ns.

flash = photons.point([15, -20, 0], 420, time_decay=2.0)
run = detector.simulate(flash, n=40_000, seed=1)
print(run.ends)
run.hits.to_pandas()[["copy", "x", "y", "time", "steps"]].head()

# %%
# The hit map: where photons are detected, and how many in each sensor.

hits = run.hits
counts = np.bincount(hits["copy"], minlength=4)
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
left.plot(hits["x"], hits["y"], ".", ms=2)
left.plot(15, -20, "r*", ms=12)
left.set(aspect="equal", xlim=(-50, 50), ylim=(-50, 50), xlabel="x in mm", ylabel="y in mm")
for sensor in range(4):
    right.hist(hits["time"][hits["copy"] == sensor], bins=50, range=(0, 25), histtype="step", label=f"sensor {sensor}: {counts[sensor]}")
right.set(xlabel="time in ns", ylabel="hits")
right.legend()
assert counts.argmax() == 1

# %%
# The position of a flash
# -----------------------
# The nearest sensor gets the most light. A first estimate of x is the asymmetry of the right and the left sensors. It is
# measured for flashes along a line:

positions = np.linspace(-40, 40, 9)
asymmetry, errors = [], []
for x in positions:
    copies = detector.simulate(photons.point([x, 0, 0], 420), n=10_000, seed=2).hits["copy"]
    right_side, left_side = np.isin(copies, [1, 3]).sum(), np.isin(copies, [0, 2]).sum()
    total = right_side + left_side
    asymmetry.append((right_side - left_side) / total)
    errors.append(2 * np.sqrt(right_side * left_side / total**3))

figure, axis = plt.subplots(figsize=(5.5, 3.4), layout="constrained")
axis.errorbar(positions, asymmetry, errors, fmt="o-")
axis.set(xlabel="x of the flash in mm", ylabel="(right - left) / (right + left)")
assert np.all(np.diff(asymmetry) > -0.1) and abs(asymmetry[4]) < 5 * errors[4]

# %%
# The wrapping
# ------------
# How much light is lost if the wrapping reflects less? The photons are the same, so that the curve is smooth.

reflectances = np.array([0.80, 0.90, 0.95, 0.97, 0.99])
yields = []
for reflectance in reflectances:
    changed = photons.loads(GDML.replace("2*eV 0.97 4*eV 0.97", f"2*eV {reflectance} 4*eV {reflectance}"))
    yields.append(changed.simulate(flash, n=20_000, seed=1).hits.rows / 20_000)
figure, axis = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
axis.plot(reflectances, yields, "o-")
axis.set(xlabel="reflectance of the wrapping", ylabel="detected fraction")
assert np.all(np.diff(yields) > 0)
