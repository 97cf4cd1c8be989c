"""
Balls of two to four dimensions
===============================

The distribution of chord lengths of a ball in the plane, in space and in four dimensions, for parallel random lines. The mean
chord is the ratio of the volumes of the balls of d and d - 1 dimensions.
"""

import matplotlib.pyplot as plt
import numpy as np
from math import gamma, pi

import rayweave.space as rs

rng = np.random.default_rng(5)
figure, axis = plt.subplots(figsize=(5.5, 3.4), layout="constrained")
for d in (2, 3, 4):
    # points of the unit ball of d - 1 dimensions, from a cube around it
    across = rng.uniform(-1, 1, (100_000, d - 1))
    across = across[(across**2).sum(axis=1) < 1]
    start = np.column_stack([across, np.full(len(across), -2.0)])
    end = start + [*[0] * (d - 1), 1]
    found = rs.ball(1.0, d).crossings(start, end)
    chords = np.diff(found.t.reshape(-1, 2), axis=1)[:, 0]
    exact = (pi ** (d / 2) / gamma(d / 2 + 1)) / (pi ** ((d - 1) / 2) / gamma((d - 1) / 2 + 1))
    print(f"d = {d}: mean chord {chords.mean():.4f}, exactly {exact:.4f}")
    assert abs(chords.mean() - exact) < 5 * chords.std() / np.sqrt(len(chords))
    axis.hist(chords, bins=80, density=True, histtype="step", label=f"d = {d}")
axis.set(xlabel="length of the chord", ylabel="density")
axis.legend()
