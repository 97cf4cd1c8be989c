"""
Hit arrays of PyRayT
====================

PyRayT's function `array_csg`, with one import changed: many rays at a time through a biconvex lens.
"""

# sphinx_gallery_thumbnail_path = "guides/images/pyrayt-collimator.png"
import numpy as np

from rayweave import Operation, array_csg, sphere, timeline

front = sphere(50).translate([0, 0, 48])
back = sphere(50).translate([0, 0, -48])

heights = np.linspace(-20, 20, 9)
origins = np.stack([heights, np.zeros(9), np.full(9, -10.0)], axis=1)
direction = np.array([0.0, 0.0, 1.0])

# hit arrays in the form of PyRayT: a column for each ray, padded with inf
lens = array_csg(front.hits(origins, direction), back.hits(origins, direction), Operation.INTERSECT)
assert np.array_equal(lens[:2], (front & back).hits(origins, direction))
print(lens[:2])

# the vectors of the article, and its figure
a, b = (1, 4, 5, 10), (0, 2, 3, 5, 6, 7, 8, 9, 11, 12)
union = array_csg(a, b, Operation.UNION)
assert list(union[:4]) == [0, 10, 11, 12]
figure = timeline({"A": a, "B": b}, {"A | B": union})
assert figure.svg.lstrip().startswith("<svg")
