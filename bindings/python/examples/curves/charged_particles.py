"""
Charged particles
=================

Traces charged particles through a detector of tubes and tiles in a magnetic field, and lists and draws when and where
they hit its cells.

Lengths in mm, times in ns, momenta in GeV/c. The table is printed and, if a path is given, written there as CSV.
"""

import csv
import sys

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw
import rayweave.space as rs

LIGHT = 299.792458  # mm / ns
FIELD = 2.0  # tesla, along +z
PION, PROTON = 0.13957, 0.93827  # GeV / c^2

# four layers of silicon around the beam, and a ring of 24 scintillating tiles
LAYERS = [100.0, 200.0, 300.0, 400.0]
layers = rw.union(
    rw.tube(radius + 0.3, radius, 1200).named(f"layer{k + 1}") for k, radius in enumerate(LAYERS)
)
tile = rw.box([30, 120, 1500]).translate([520, 0, 0]).named("tile")
turns = np.tile(np.eye(4), (24, 1, 1))
angles = np.radians(np.arange(24) * 15)
turns[:, 0, 0] = turns[:, 1, 1] = np.cos(angles)
turns[:, 1, 0] = np.sin(angles)
turns[:, 0, 1] = -np.sin(angles)
detector = layers | rw.place(tile, turns)


def particle(mass: float, charge: int, momentum: np.ndarray) -> rs.Helix:
    """The path from the centre: gyro radius = momentum across the field / (charge * field)."""
    energy = np.sqrt(mass**2 + momentum @ momentum)
    velocity = LIGHT * momentum / energy
    radius = np.hypot(momentum[0], momentum[1]) / (1e-6 * LIGHT * charge * FIELD)
    return rs.Helix([0, 0, 0], velocity, [0, 0, 1], radius)


rng = np.random.default_rng(7)
kinds = [("pi+", PION, 1), ("pi-", PION, -1), ("p", PROTON, 1), ("pbar", PROTON, -1)]
names, helices = [], []
for k in range(40):
    name, mass, charge = kinds[k % 4]
    across, azimuth, along = rng.uniform(0.05, 1.5), rng.uniform(0, 2 * np.pi), rng.normal(0, 0.3)
    momentum = np.array([across * np.cos(azimuth), across * np.sin(azimuth), along])
    names.append(name)
    helices.append(particle(mass, charge, momentum))

found = detector.crossings_along(helices, 0.0, 10.0)
rows = []
for ray, t, point, surface, placement, enters in zip(
    found.ray, found.t, found.point, found.surface, found.placement, found.enters, strict=True
):
    if enters:
        cell = found.surface_names[surface].split(".")[0]
        rows.append([ray, names[ray], cell, max(placement, 0), f"{t:.4f}", *(f"{x:.3f}" for x in point)])

header = ["track", "particle", "cell", "tile", "t_ns", "x_mm", "y_mm", "z_mm"]
for row in [header, *rows[:12]]:
    print("  ".join(f"{entry!s:>9}" for entry in row))
print(f"... {len(rows)} cells are hit by {len(helices)} particles in 10 ns")
if len(sys.argv) > 1 and sys.argv[1].endswith(".csv"):
    with open(sys.argv[1], "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header, *rows])

# a circle of radius R through the axis intersects the cylinder of radius r after an angle of 2 asin(r / 2R)
slow = particle(PION, 1, np.array([0.2, 0.0, 0.0]))
first = detector.crossings_along(slow, 0.0, 10.0)
radius = 0.2 / (1e-6 * LIGHT * FIELD)
speed = np.linalg.norm(slow.velocity(0.0))
assert np.isclose(first.t[0], 2 * radius * np.arcsin(LAYERS[0] / (2 * radius)) / speed, rtol=1e-12)
# half of that momentum gives a circle 334 mm across, which crosses three layers again and again
curl = detector.crossings_along(particle(PION, -1, np.array([0.1, 0.0, 0.0])), 0.0, 10.0)
assert {found.surface_names[k].split(".")[0] for k in curl.surface} == {"layer1", "layer2", "layer3"}

figure, axis = plt.subplots(figsize=(5.5, 5.5), layout="constrained")
for contour in rw.section(detector, "xy").contours("solid"):
    axis.plot(*np.vstack([contour, contour[:1]]).T, color="gray", lw=0.6)
times = np.linspace(0, 10, 600)
for name, helix in zip(names, helices, strict=True):
    path = np.array([helix.position(t) for t in times])
    path = path[np.hypot(path[:, 0], path[:, 1]) < 560]
    axis.plot(path[:, 0], path[:, 1], lw=0.8, color="C0" if "+" in name or name == "p" else "C1")
axis.plot(found.point[:, 0], found.point[:, 1], "k.", ms=2)
axis.set(aspect="equal", xlabel="x in mm", ylabel="y in mm")
