"""
Pickled and saved models
========================

Solids and models can be pickled, for example for `multiprocessing`, and saved as text, without loss: both copies give the
same bits.
"""

import pickle

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

solid = (rw.torus(3, 1) | rw.cylinder(1.2, 6)) - rw.sphere(1.5).translate([0, 0, 1.5])
model = rw.Model([rw.Region("part", solid, medium="steel", colour="steelblue")], {"steel": {"density": 7.85}})

copies = {"pickle": pickle.loads(pickle.dumps(model)), "TOML": rw.loads(model.to_toml())}
rng = np.random.default_rng(2)
origins, directions = rng.normal(scale=3, size=(10_000, 3)), rng.normal(size=(10_000, 3))
expected = model.crossings(origins, directions)
for name, copy in copies.items():
    found = copy.crossings(origins, directions)
    assert np.array_equal(found.t, expected.t) and np.array_equal(found.normal, expected.normal)
    print(f"{name}: {len(found)} crossings, the same bits")

figure, axes = plt.subplots(1, 3, figsize=(9, 3), layout="constrained")
for axis, (name, shown) in zip(axes, {"original": model, **copies}.items(), strict=True):
    axis.imshow(rw.render(shown, size=(260, 220)))
    axis.set_title(name)
    axis.axis("off")
