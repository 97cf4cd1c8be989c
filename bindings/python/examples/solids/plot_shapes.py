"""
Shapes
======

Sixteen shapes of the catalogue, each with the call that makes it. All are exact: none is made of triangles.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

shapes = {
    "sphere(1)": rw.sphere(1),
    "box([2, 1.5, 1])": rw.box([2, 1.5, 1]),
    "cylinder(0.8, 2)": rw.cylinder(0.8, 2),
    "cone(1, 0.3, 2)": rw.cone(1, 0.3, 2),
    "torus(1, 0.4)": rw.torus(1, 0.4),
    "tube(1, 0.7, 1.5)": rw.tube(1, 0.7, 1.5),
    "prism(6, 1, 1)": rw.prism(6, 1, 1),
    "ellipsoid([1.2, 0.8, 0.6])": rw.ellipsoid([1.2, 0.8, 0.6]),
    "paraboloid(0.25, 1.5)": rw.paraboloid(0.25, 1.5),
    "asphere(1, 0.6, -1, ...)": rw.asphere(1, 0.6, -1, even=[0, 0.1], height=1),
    "biconic(1, 0.9, -0.5, ...)": rw.biconic(1, 0.9, -0.5, height=1),
    "freeform(1, zernike=...)": rw.freeform(1, zernike=[0, 0, 0, 0, 0, 0, 0, 0, 0.12], height=0.7),
    "convex(planes)": rw.convex([[x, y, z, 1] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]),
    "wedge(0, 270) & sphere(1)": rw.wedge(0, 270) & rw.sphere(1),
    "slab([1, 0, 1], 0, 0.6) & sphere(1)": rw.slab([1, 0, 1], 0, 0.6) & rw.sphere(1),
    "quadric(matrix) & box(2)": rw.quadric(np.diag([1, 1, -1, -0.15])) & rw.box(2),
}

figure, axes = plt.subplots(4, 4, figsize=(10, 8.4), layout="constrained")
for axis, (text, solid) in zip(axes.flat, shapes.items(), strict=True):
    axis.imshow(rw.render(solid, size=(200, 150)))
    axis.set_title(text, fontsize=8)
    axis.axis("off")

# a regular octahedron of distance 1 / sqrt(3) between the centre and its faces, with the vertices at distance 1
assert abs(shapes["convex(planes)"].volume - 4 / 3) < 5e-3
