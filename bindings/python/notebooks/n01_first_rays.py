"""
First rays
==========

From a solid to a picture, by hand: this notebook builds a solid, asks for single crossings, then for those of all pixels of a
camera, and shades them.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

# %%
# A solid
# -------
# Shapes are functions, operators combine them. Shapes are centred at the origin, and methods return new solids.

die = (rw.box(2).named("cube") & rw.sphere(1.35).named("ball")) - rw.cylinder(0.5).named("bore")
print(die.bounds)

# %%
# One ray
# -------
# A ray is an origin and a direction. ``hits`` returns the distances of all crossings, a column for each ray. This one passes
# through the rounded cube and its bore:

die.hits([-5, 0, 0], [1, 0, 0])

# %%
# ``crossings`` has a row for each crossing, with the point, the normal and the name of the face.

die.crossings([-5, 0, 0], [1, 0, 0]).to_pandas()

# %%
# The distances have closed forms: the ball at height 0.8 is ``sqrt(1.35**2 - 0.8**2)`` wide, which is more than the cube.

times = die.hits([-5, 0.8, 0.7], [1, 0, 0])[:, 0]
half = np.sqrt(1.35**2 - 0.8**2 - 0.7**2)
print(times, "expected", 5 - half, 5 + half)
assert np.allclose(times[:2], [5 - half, 5 + half])

# %%
# A camera of rays
# ----------------
# A perspective camera: all rays start at the eye, and each pixel has a direction. The arrays have the shape (height, width, 3).

eye = np.array([4.0, -6.0, 4.0])
forward = -eye / np.linalg.norm(eye)
right = np.cross(forward, [0, 0, 1])
right /= np.linalg.norm(right)
up = np.cross(right, forward)
x, y = np.meshgrid(np.linspace(-0.28, 0.28, 320), np.linspace(0.21, -0.21, 240))
directions = forward + x[..., None] * right + y[..., None] * up

first = die.nearest(eye, directions)
print(f"{np.isfinite(first.t).sum()} of {first.t.size} rays hit the die")

# %%
# Shading
# -------
# The normals are unit vectors that point outwards. Light from the upper left is their cosine with the direction to the lamp.

lamp = np.array([-1.0, -1.0, 2.0]) / np.sqrt(6)
light = np.clip(first.normal @ lamp, 0.1, 1).reshape(240, 320)
hit = np.isfinite(first.t).reshape(240, 320)

# a shadow: a second ray from each visible point to the lamp; t_min leaves out the point itself
points = first.point[np.isfinite(first.t)]
blocked = np.isfinite(die.nearest(points, lamp, t_min=1e-6).t)
shade = np.where(hit, light, 1.0)
shade[hit] = np.where(blocked, 0.1, shade[hit])

figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
axes[0].imshow(shade, cmap="gray", vmin=0, vmax=1)
axes[0].set_title("shaded by hand")
axes[1].imshow(rw.render(die, size=(320, 240)))
axes[1].set_title("rw.render")
for axis in axes:
    axis.axis("off")

# %%
# Which face?
# -----------
# ``surface`` is a number for each ray, and ``surface_names`` lists the names: a map of the faces.

faces = np.where(hit, first.surface.reshape(240, 320), -1)
figure, axis = plt.subplots(figsize=(5, 3.4), layout="constrained")
axis.imshow(faces, cmap="tab20")
axis.set_title(", ".join(first.surface_names[k] for k in np.unique(faces[faces >= 0])), fontsize=8)
axis.axis("off")
