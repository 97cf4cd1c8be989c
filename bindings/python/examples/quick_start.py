"""
A die
=====

A die, traced along a few rays: times, faces, normals, a picture.
"""

# sphinx_gallery_thumbnail_path = "../models/die.png"
import numpy as np

import rayweave as rw

die = (rw.box(2).named("cube") & rw.sphere(1.35).named("ball")) - rw.cylinder(0.5).named("bore")

origins = np.array([[-5.0, 0.0, 0.0], [-5.0, 0.8, 0.0], [-5.0, 3.0, 0.0]])
directions = np.array([1.0, 0.0, 0.0])

hits = die.hits(origins, directions)
print("times, a column for each ray:")
print(hits)
assert np.allclose(hits[:, 0], [4.0, 4.5, 5.5, 6.0])
assert np.all(np.isinf(hits[:, 2]))

first = die.nearest(origins, directions)
for ray, (t, surface) in enumerate(zip(first.t, first.surface)):
    what = first.surface_names[surface] if surface >= 0 else "nothing"
    print(f"ray {ray} meets {what} at t = {t}")
assert np.allclose(first.normal[0], [-1, 0, 0])

assert die.contains([0.7, 0.0, 0.0]) and not die.contains([0.0, 0.0, 0.0])
picture = rw.render(die, size=(160, 120))
print("a picture of", picture.shape, picture.dtype)
