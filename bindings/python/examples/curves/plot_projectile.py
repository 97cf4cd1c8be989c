"""
A throw through a window
========================

Parabolas through a wall with a round window: where each stone lands or hits the wall.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw
import rayweave.space as rs

wall = rw.box([0.5, 10, 10]).translate([15, 0, 5]) - rw.cylinder(1.5).rotate_y(90).translate([0, 0, 5])
scene = wall.named("wall") | rw.half_space([0, 0, 1], 0).named("ground")

figure, axis = plt.subplots(figsize=(7, 3.4), layout="constrained")
for contour in rw.section(wall, "xz").contours("solid"):
    axis.fill(*contour.T, color="slategray")
for speed in np.linspace(6, 12, 9):
    stone = rs.Parabola([0, 0, 1.5], [16, 0, speed], [0, 0, -9.81])
    found = scene.crossings_along(stone, 0, 10)
    end = found.t[0]
    path = np.array([stone.position(t) for t in np.linspace(0, end, 80)])
    hits_wall = found.surface_names[found.surface[0]].startswith("wall")
    axis.plot(path[:, 0], path[:, 2], color="indianred" if hits_wall else "seagreen", lw=1)
    axis.plot(*path[-1, [0, 2]], "k.")
    if not hits_wall:
        # the flight ends where z = 1.5 + v t - g t^2 / 2 = 0
        assert np.isclose(end, (speed + np.sqrt(speed**2 + 2 * 9.81 * 1.5)) / 9.81, rtol=1e-13)
axis.set(xlabel="x in m", ylabel="z in m", ylim=(-0.5, 10.5))
axis.axhline(0, color="black")
