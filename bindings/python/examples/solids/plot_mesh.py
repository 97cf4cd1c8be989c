"""
Triangles
=========

The surface of a solid as a mesh, for other programs: its volume approaches that of the solid from below or above as the
tolerance becomes smaller.
"""

import matplotlib.pyplot as plt

import rayweave as rw

solid = rw.cylinder(10, 20) - rw.cylinder(6) - rw.box([30, 6, 6])
figure = plt.figure(figsize=(9, 3.5), layout="constrained")
for k, tolerance in enumerate([1.0, 0.1]):
    mesh = solid.to_mesh(tolerance)
    axis = figure.add_subplot(1, 2, k + 1, projection="3d")
    axis.plot_trisurf(*mesh.vertices.T, triangles=mesh.triangles, edgecolor="black", linewidth=0.2)
    axis.set_title(f"tolerance {tolerance}: {len(mesh.triangles)} triangles, volume {mesh.volume:.1f}")
assert abs(solid.to_mesh(0.01).volume - solid.volume) < 0.01 * solid.volume
