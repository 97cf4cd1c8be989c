"""
Sources of photons
==================

Where photons of five kinds of sources begin, and with which wavelengths.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave.photons as photons

ROOM = """
<gdml>
  <define>
    <matrix name="INDEX" coldim="2" values="1.5*eV 1.5 4*eV 1.5"/>
  </define>
  <materials>
    <material name="Glass" Z="14"><D value="2.2"/><atom value="28"/><property name="RINDEX" ref="INDEX"/></material>
  </materials>
  <solids>
    <box name="Room" x="100" y="100" z="100" lunit="mm"/>
    <torus name="Ring" rmin="0" rmax="8" rtor="25" startphi="0" deltaphi="360" aunit="deg" lunit="mm"/>
  </solids>
  <structure>
    <volume name="Torus"><materialref ref="Glass"/><solidref ref="Ring"/></volume>
    <volume name="World"><materialref ref="Glass"/><solidref ref="Room"/>
      <physvol name="t"><volumeref ref="Torus"/></physvol></volume>
  </structure>
  <setup name="Default" version="1.0"><world ref="World"/></setup>
</gdml>
"""
detector = photons.loads(ROOM)
sources = {
    "point, in a cone": photons.point([0, 0, 0], 500, towards=[0, 1, 0], cone_degrees=20),
    "disc": photons.disc([0, 0, 0], 20, ("uniform", 400, 500), normal=[0, 0, 1]),
    "line": photons.line([-30, -30, 0], [30, 30, 0], ("table", 400, 0, 450, 1, 600, 0)),
    "volume": photons.volume(detector, "Torus", ("black body", 3000, 400, 700)),
    "surface": photons.surface(detector, "Torus", 550),
}
figure, axes = plt.subplots(2, 5, figsize=(12, 4.6), layout="constrained")
for (upper, lower), (name, source) in zip(axes.T, sources.items(), strict=True):
    steps = detector.simulate(source, n=2_000, record="steps").histories
    start = steps["step"] == 0
    x, y = steps["x"][start], steps["y"][start]
    upper.plot(x, y, ",")
    upper.quiver(x[:60], y[:60], steps["dx"][start][:60], steps["dy"][start][:60], color="C1", width=0.006, scale=8)
    upper.set(aspect="equal", xlim=(-50, 50), ylim=(-50, 50), title=name)
    lower.hist(steps["wavelength_nm"][start], bins=40, range=(390, 710))
    lower.set_xlabel("nm")
    if name == "volume":
        assert np.all((np.hypot(x, y) > 17) & (np.hypot(x, y) < 33))
