"""
Depth and normals of a pixel grid
=================================

Rays in a grid (height, width, 3): the first crossing of each, as pictures.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

solid = rw.torus(2, 0.7) | (rw.sphere(1.2) - rw.box([3, 0.5, 3]))
x, y = np.meshgrid(np.linspace(-3, 3, 200), np.linspace(3, -3, 200))
grid = np.stack([x, y, np.full_like(x, 10.0)], axis=-1)
first = solid.nearest(grid, [0, 0, -1])

figure, axes = plt.subplots(1, 2, figsize=(8, 3.6), layout="constrained")
shown = axes[0].imshow(np.where(np.isfinite(first.t), first.t, np.nan).reshape(200, 200), extent=(-3, 3, -3, 3))
figure.colorbar(shown, ax=axes[0], label="distance")
axes[1].imshow(np.nan_to_num((first.normal + 1) / 2, nan=1.0).reshape(200, 200, 3), extent=(-3, 3, -3, 3))
axes[1].set_title("normals as colours")

hit = np.isfinite(first.t)
assert np.allclose(np.linalg.norm(first.normal[hit], axis=1), 1)
