"""
Copies
======

`place` repeats a solid under many maps: here 400 spheres on a spiral. The solid is compiled once, and rays find the
copies through a tree of boxes, so that copies cost little time and memory.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

# Vogel's model of a sunflower: the golden angle between neighbours
k = np.arange(400)
angle, radius = np.radians(137.50776405) * k, np.sqrt(k + 0.5)
places = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(400)], axis=1)
seeds = rw.place(rw.sphere(0.8).named("seed"), places)
flower = {"seeds": seeds, "disc": rw.cylinder(21, 1)}

figure, axis = plt.subplots(figsize=(6, 4.6), layout="constrained")
axis.imshow(rw.render(flower, size=(600, 460), shadows=True))
axis.axis("off")

# which copy does a ray hit?
found = seeds.nearest([*places[123, :2], 9], [0, 0, -1])
paths = seeds.occurrence_paths(found.occurrence, placed=True)
print(paths, "at distance", found.t)
assert paths == ["seed[123]"] and np.isclose(found.t[0], 9 - 0.8)
