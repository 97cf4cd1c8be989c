"""
Filled contours
===============

The contours of a part with holes as one filled path of matplotlib: outlines are counter-clockwise and holes clockwise, so
that holes stay empty.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import PathPatch
from matplotlib.path import Path

import rayweave as rw

plate = rw.box([60, 40, 8]) - rw.cylinder(9) - rw.place(rw.cylinder(3), [[22, 12, 0], [-22, 12, 0], [-22, -12, 0], [22, -12, 0]])
cut = rw.section(plate, "z=0")

# each contour ends where it began; fill them one by one instead, and the holes are filled, too
path = Path.make_compound_path(*(Path(np.vstack([c, c[:1]]), closed=True) for c in cut.contours("solid")))
figure, axis = plt.subplots(figsize=(5, 3.5), layout="constrained")
axis.add_patch(PathPatch(path, facecolor="lightsteelblue", edgecolor="black"))
axis.autoscale_view()
axis.set(aspect="equal", title=f"area {cut.areas[0]:.1f} \u00b1 {cut.area_errors[0]:.1f} mm\u00b2")

exact = 60 * 40 - np.pi * (9**2 + 4 * 3**2)
print(f"area {cut.areas[0]:.3f}, exactly {exact:.3f}")
assert abs(cut.areas[0] - exact) <= cut.area_errors[0]
