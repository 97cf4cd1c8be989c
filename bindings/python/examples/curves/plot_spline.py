"""
A spline past obstacles
=======================

The path of a tool is a cubic spline through given points. The times at which it is inside an obstacle are exact: the path is
not sampled.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw
import rayweave.space as rs

posts = rw.place(rw.cylinder(0.8, 4), [[2, 1, 0], [4, -1, 0], [6, 1, 0], [8, -0.4, 0]])
points = np.array([[0, 0, 0], [2, 0.4, 0], [4, -0.1, 0], [6, 0.6, 0], [8, 0.5, 0], [10, 0, 0]])
path = rs.Spline(np.arange(6), points)
found = posts.crossings_along(path, 0, 5)

figure, axis = plt.subplots(figsize=(7, 3), layout="constrained")
for contour in rw.section(posts, "xy").contours("solid"):
    axis.fill(*contour.T, color="lightgray")
line = np.array([path.position(t) for t in np.linspace(0, 5, 400)])
axis.plot(line[:, 0], line[:, 1])
axis.plot(points[:, 0], points[:, 1], "k.", ms=4)
for enter, leave in zip(found.t[::2], found.t[1::2], strict=True):
    inside = np.array([path.position(t) for t in np.linspace(enter, leave, 40)])
    axis.plot(inside[:, 0], inside[:, 1], color="red", lw=2.5)
    print(f"collision from t = {enter:.6f} to {leave:.6f}")
axis.set(aspect="equal", xlabel="x", ylabel="y")

# every crossing is on the surface of a post
centres = np.array([[2, 1], [4, -1], [6, 1], [8, -0.4]])
distances = np.linalg.norm(found.point[:, None, :2] - centres, axis=2).min(axis=1)
assert len(found) > 0 and np.allclose(distances, 0.8)
