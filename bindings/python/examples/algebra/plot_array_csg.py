"""
Boolean operations on arrays
============================

`array_csg` combines the hits of many rays at a time: a column for each ray, sorted, padded with infinity. Here two fans of
intervals are combined by the three operations.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw
from rayweave import Operation

rays = np.linspace(-2, 2, 161)
origins = np.stack([np.full_like(rays, -5.0), rays, np.zeros_like(rays)], axis=1)
left, right = rw.sphere(1.5).translate([-0.8, 0, 0]), rw.sphere(1.5).translate([0.8, 0, 0])
a, b = left.hits(origins, [1, 0, 0]), right.hits(origins, [1, 0, 0])

figure, axes = plt.subplots(1, 3, figsize=(10, 3.4), layout="constrained")
for axis, operation in zip(axes, Operation, strict=True):
    hits = rw.array_csg(a, b, operation)
    # even rows are entries, odd rows exits
    for start, end in zip(hits[::2], hits[1::2], strict=True):
        inside = np.isfinite(start)
        axis.hlines(rays[inside], start[inside] - 5, end[inside] - 5, lw=1.5)
    axis.set(title=operation.name.lower(), aspect="equal", xlim=(-2.5, 2.5), ylim=(-1.8, 1.8))

# the same from the solids
assert np.array_equal(rw.array_csg(a, b, Operation.UNION)[:2], (left | right).hits(origins, [1, 0, 0])[:2])
