"""
A map of thickness
==================

The length of each medium along the ray of each pixel, for a ball of glass in a block of water. The largest chord of the
ball is its diameter.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

model = rw.Model(
    [
        rw.Region("block", rw.box([60, 40, 40]), medium="water"),
        rw.Region("ball", rw.sphere(15), medium="glass"),
        rw.Region("bubble", rw.sphere(6).translate([5, 0, 3]), medium="air"),
    ]
)
found = rw.thickness(model, view="front", size=(241, 161))

figure, axes = plt.subplots(1, 3, figsize=(11, 2.8), layout="constrained")
for axis, medium in zip(axes, ("water", "glass", "air"), strict=True):
    shown = axis.imshow(found[medium])
    figure.colorbar(shown, ax=axis, label=f"mm of {medium}")

print(f"largest length in air {found['air'].max():.4f}, the diameter of the bubble is 12")
total = found["water"] + found["glass"] + found["air"]
assert np.allclose(total[np.isfinite(total) & (total > 0)], 40)
assert 11.9 < found["air"].max() <= 12
