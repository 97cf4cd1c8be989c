"""
Mean chord lengths
==================

Cauchy's formula: the mean length of isotropic random chords of a convex body is 4 V / S. The means of random exact chords agree with it within their statistical
errors.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

rng = np.random.default_rng(1)


def isotropic(count: int, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Random lines with equal density in all places and directions that hit a ball of this radius."""
    direction = rng.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    across = np.cross(direction, rng.normal(size=(count, 3)))
    across /= np.linalg.norm(across, axis=1)[:, None]
    return across * radius * np.sqrt(rng.random(count))[:, None] - 10 * direction, direction


solids = {
    "sphere": (rw.sphere(1), 4 / 3),
    "cube": (rw.box(2), 4 * 8 / 24),
    "cylinder": (rw.cylinder(1, 2), 4 * 2 * np.pi / (6 * np.pi)),
}
figure, axis = plt.subplots(figsize=(6, 3.6), layout="constrained")
for name, (solid, exact) in solids.items():
    hits = solid.hits(*isotropic(300_000, 1.8))[:2]
    chords = np.diff(hits[:, np.isfinite(hits[0])], axis=0)[0]
    print(f"{name}: mean chord {chords.mean():.4f}, 4 V / S = {exact:.4f}")
    assert abs(chords.mean() - exact) < 5 * chords.std() / np.sqrt(len(chords))
    axis.hist(chords, bins=120, density=True, histtype="step", label=f"{name}: {chords.mean():.4f}")
axis.set(xlabel="length of the chord", ylabel="density")
axis.legend()
