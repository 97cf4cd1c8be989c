"""
A model of OpenSCAD
===================

Rayweave reads the flattened models of OpenSCAD (`openscad -o part.csg part.scad`). Round shapes are exactly round here;
with `facets=True` they have the facets of OpenSCAD instead.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

PART = """
difference() {
    union() {
        cylinder($fn = 12, h = 12, r1 = 20, r2 = 12, center = false);
        multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 12], [0, 0, 0, 1]]) {
            sphere($fn = 12, r = 12);
        }
    }
    cylinder($fn = 12, h = 60, r1 = 5, r2 = 5, center = true);
}
"""

figure, axes = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "part.csg"
    path.write_text(PART, encoding="utf-8")
    for axis, facets in zip(axes, (False, True), strict=True):
        model = rw.load(path, facets=facets)
        volume = rw.measure(model).volume[0]
        axis.imshow(rw.render(model, size=(360, 280)))
        axis.set_title(f"facets={facets}: volume {volume:.0f}")
        axis.axis("off")
        if not facets:
            round_volume = volume

# the frustum and the upper half of the sphere, without the bore through both; the lower half lies in the frustum
frustum, half_ball = np.pi * 12 / 3 * (20**2 + 20 * 12 + 12**2), 2 / 3 * np.pi * 12**3
bore = np.pi * 5**2 * 12 + 2 / 3 * np.pi * (12**3 - (12**2 - 5**2) ** 1.5)
exact = frustum + half_ball - bore
print(f"volume {round_volume:.1f}, by formula {exact:.1f}")
assert abs(round_volume - exact) < 5e-3 * exact
