"""
Path lengths in pandas
======================

200,000 rays through a model become a data frame of their path lengths, with a column for each medium.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import rayweave as rw

model = rw.Model(
    [
        rw.Region("tank", rw.box([20, 20, 10]), medium="water"),
        rw.Region("ball", rw.sphere(4), medium="glass"),
        rw.Region("rod", rw.cylinder(1, 30).rotate_x(90), medium="steel"),
    ]
)
rng = np.random.default_rng(1)
count = 200_000
origins = np.column_stack([rng.uniform(-10, 10, (count, 2)), np.full(count, 50.0)])
pieces = model.partition(origins, [0, 0, -1], t_min=0, t_max=100)
by_ray = pd.DataFrame(pieces.path_lengths(), columns=pieces.medium_names)

figure, axis = plt.subplots(figsize=(6, 3.4), layout="constrained")
for medium in ("glass", "steel"):
    lengths = by_ray[medium]
    axis.hist(lengths[lengths > 0], bins=60, histtype="step", label=medium)
axis.set(xlabel="length in the medium", ylabel="rays", yscale="log")
axis.legend()

# the volume of the rod within the tank is the mean length times the area of the beam
volume = by_ray["steel"].mean() * 400
print(f"volume of the rod within the beam {volume:.2f}, exactly {np.pi * 20:.2f}")
assert abs(volume - np.pi * 20) < 5 * 400 * by_ray["steel"].std() / np.sqrt(count)
