"""
A plane section
===============

The contours of a pipe cut at an angle, with areas. The section of a cylinder at 45 degrees is an ellipse, so that the area
is known.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

pipe = rw.Model(
    [
        rw.Region("pipe", rw.tube(10, 8, 60), medium="steel"),
        rw.Region("water", rw.cylinder(8, 60), medium="water"),
    ]
)
cut = rw.section(pipe, point=[0, 0, 0], normal=[1, 0, 1])

figure, axis = plt.subplots(figsize=(5, 4), layout="constrained")
for name, colour in (("steel", "slategray"), ("water", "lightskyblue")):
    for contour in cut.contours(name):
        axis.fill(*contour.T, color="white")
        axis.fill(*contour.T, color=colour, alpha=0.8, label=name)
axis.set(aspect="equal", title="the plane x + z = 0")

exact = {"steel": np.pi * (10**2 - 8**2) * 2**0.5, "water": np.pi * 8**2 * 2**0.5}
for name, area, perimeter in zip(cut.names, cut.areas, cut.perimeters, strict=True):
    print(f"{name}: area {area:.4f}, exactly {exact[name]:.4f}")
    assert abs(area - exact[name]) <= cut.tolerance * perimeter
