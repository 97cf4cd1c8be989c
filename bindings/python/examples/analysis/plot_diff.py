"""
The difference of two models
============================

Two versions of a part are compared: which one has material where the other has none, how much, and how thick. The section
is through the thickest difference.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw


def part(bore: float, height: float) -> rw.Solid:
    """A plate with a hub."""
    return (rw.box([40, 40, 6]) | rw.cylinder(12, height).translate([0, 0, height / 2 - 3])) - rw.cylinder(bore)


old, new = part(6, 14), part(7, 16)
found = rw.diff(old, new, cells=64)
print(f"only in the old one: {found.a_only[0]:.1f}, only in the new one: {found.b_only[0]:.1f}")

# the ring from 6 to 7, 14 high; the ring from 7 to 12, 2 high
exact_old, exact_new = np.pi * (7**2 - 6**2) * 14, np.pi * (12**2 - 7**2) * 2
print(f"exactly: {exact_old:.1f} and {exact_new:.1f}")
assert abs(found.a_only[0] - exact_old) < 0.02 * exact_old and abs(found.b_only[0] - exact_new) < 0.02 * exact_new

figure, axis = plt.subplots(figsize=(6, 3.4), layout="constrained")
pieces = {"in both": old & new, "only in the old one": old - new, "only in the new one": new - old}
for colour, (name, solid) in zip(("lightgray", "indianred", "seagreen"), pieces.items(), strict=True):
    cut = rw.section(solid, "xz")
    for k, contour in enumerate(cut.contours(cut.names[0])):
        axis.fill(*contour.T, color=colour, label=name if k == 0 else None)
axis.set(aspect="equal", xlabel="x", ylabel="z")
axis.legend(fontsize=8)
