"""
A Cerenkov (Cherenkov) ring
===========================

A genstep describes a piece of the track of a charged particle. Its Cerenkov photons leave on a cone, which makes a ring on a
screen.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rayweave.photons as photons

MODEL = """
rayweave = 1
unit = "mm"
[solid.tank]
box = { size = [2000, 2000, 2000] }
[solid.screen]
box = { size = [2000, 2000, 10] }
transform = [{ translate = [0, 0, 995] }]
[[region]]
solid = "tank"
medium = "water"
[[region]]
solid = "screen"
medium = "opaque"
[medium.water]
[medium.opaque]
[photons.medium.water]
RINDEX = { eV = [1.5, 4], value = [1.33, 1.33] }
[[photons.surface]]
name = "cathode"
model = "unified"
finish = "polished"
type = "dielectric_metal"
border = [["tank", "screen"]]
REFLECTIVITY = 0
EFFICIENCY = 1
"""
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "tank.toml"
    path.write_text(MODEL, encoding="utf-8")
    detector = photons.load(path)

# a particle of 0.99 c along z, 20 mm of its track; the fields of Geant4's interface
beta, n, count = 0.99, 1.33, 4_000
speed = beta * 299.792458
step = [15, 0, 0, 0, 0, 0, count, 1, 20, speed, 0, 0, 0, 20, count / 20, count / 20]
source = photons.gensteps(detector, np.array([step]), materials={0: "water"})
hits = detector.simulate(source, seed=1).hits

radius = np.hypot(hits["x"], hits["y"])
# the cone has cos(angle) = 1 / (beta n), and starts at 0 to 20 mm
tangent = np.tan(np.arccos(1 / (beta * n)))
print(f"radius from {radius.min():.1f} to {radius.max():.1f} mm, exactly {970 * tangent:.1f} to {990 * tangent:.1f}")
assert radius.min() >= 970 * tangent - 0.1 and radius.max() <= 990 * tangent + 0.1

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
left.plot(hits["x"], hits["y"], ",")
left.set(aspect="equal", xlabel="x in mm", ylabel="y in mm")
right.hist(radius, bins=60)
right.set(xlabel="distance from the track in mm", ylabel="hits")
