"""
A mesh as an operand
====================

Triangles become a solid that combines with exact shapes: here an icosahedron, hollowed by a sphere, with a round hole.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

g = (1 + 5**0.5) / 2
vertices = np.array([[0, s, t * g] for s in (-1, 1) for t in (-1, 1)])
vertices = np.concatenate([vertices, vertices[:, [2, 0, 1]], vertices[:, [1, 2, 0]]])
# three vertices are a face if all their distances are 2; the order is that of a right-handed outward normal
faces = []
for i in range(12):
    for j in range(i + 1, 12):
        for k in range(j + 1, 12):
            a, b, c = vertices[[i, j, k]]
            if np.allclose([np.linalg.norm(a - b), np.linalg.norm(b - c), np.linalg.norm(c - a)], 2):
                faces.append([i, j, k] if np.dot(np.cross(b - a, c - a), a) > 0 else [i, k, j])
icosahedron = rw.mesh(vertices, faces)
shell = icosahedron - rw.sphere(1.45) - rw.cylinder(0.5)

figure, axes = plt.subplots(1, 2, figsize=(8, 3.6), layout="constrained")
axes[0].imshow(rw.render(icosahedron, size=(360, 300)))
axes[1].imshow(rw.render(shell, size=(360, 300), cut="x>50%,y<50%"))
for axis in axes:
    axis.axis("off")

exact = 5 / 12 * (3 + 5**0.5) * 2**3
print(f"{len(faces)} triangles, volume {icosahedron.volume:.6f}, exactly {exact:.6f}")
assert len(faces) == 20 and abs(icosahedron.volume - exact) < 5e-3 * exact
