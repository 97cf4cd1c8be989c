"""
A helix through tiles
=====================

A charged particle in a magnetic field crosses a ring of detector tiles.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw
import rayweave.space as rs

tile = rw.box([20, 60, 300]).translate([200, 0, 0])
turns = np.tile(np.eye(4), (16, 1, 1))
angles = np.radians(np.arange(16) * 22.5)
turns[:, 0, 0] = turns[:, 1, 1] = np.cos(angles)
turns[:, 1, 0], turns[:, 0, 1] = np.sin(angles), -np.sin(angles)
ring = rw.place(tile, turns)

helix = rs.Helix([0, 0, 0], [150, 0, 20], [0, 0, 1], 130.0)
found = ring.crossings_along(helix, 0.0, 6.0)
times = np.linspace(0, 6, 400)
path = np.array([helix.position(t) for t in times])

figure, axis = plt.subplots(figsize=(4.5, 4.5), layout="constrained")
for name in (cut := rw.section(ring, "xy")).names:
    for contour in cut.contours(name):
        axis.fill(*contour.T, color="lightgray")
axis.plot(path[:, 0], path[:, 1])
axis.plot(found.point[:, 0], found.point[:, 1], "r.")
axis.set(aspect="equal", xlabel="x in mm", ylabel="y in mm")
assert len(found) >= 2 and len(found) % 2 == 0
