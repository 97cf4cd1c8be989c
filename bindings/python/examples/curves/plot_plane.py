"""
Regions of the plane
====================

A solid of two dimensions, bounded by polygons, and a circular cut through it.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw
import rayweave.space as rs

contours = [[[0, 0], [6, 0], [6, 4], [0, 4]], [[1, 1], [1, 3], [3, 3], [3, 1]]]
frame = rw.from_polygons(contours)
tool = rs.Arc([2, 2], [[2.5, 0], [0, 2.5]])
found = frame.solid().crossings_along(tool, 0, 360)

figure, axis = plt.subplots(figsize=(5, 3.6), layout="constrained")
axis.fill(*np.array(contours[0]).T, color="lightgray")
axis.fill(*np.array(contours[1]).T, color="white")
edges = np.concatenate([[0], found.t, [360]])
is_inside = bool(found.start_inside[0])
for start, end in zip(edges, edges[1:], strict=False):
    arc = np.array([tool.position(t) for t in np.linspace(start, end, 60)])
    axis.plot(*arc.T, color="red" if is_inside else "steelblue", lw=2 if is_inside else 1)
    is_inside = not is_inside
axis.set(aspect="equal")

# x = 0 is crossed at cos(t) = -2 / 2.5, y = 0 and 4 at sin(t) = -+2 / 2.5
exact = np.degrees(np.arccos(-0.8)), np.degrees(np.arcsin(0.8))
print("degrees:", found.t.round(6), "with", exact)
assert np.isclose(found.t, exact[0]).any() and np.isclose(found.t, exact[1]).any()
