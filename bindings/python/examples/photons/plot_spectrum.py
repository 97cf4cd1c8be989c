"""
The decay of a beam
===================

Photons in a long bar of absorbing water: the distances at which they end fall exponentially with the absorption length.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rayweave.photons as photons

MODEL = """
rayweave = 1
unit = "mm"
[solid.tank]
box = { size = [100, 100, 1000] }
[[region]]
solid = "tank"
medium = "water"
[medium.water]
[photons.medium.water]
RINDEX = 1.33
ABSLENGTH = 150
"""

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "tank.toml"
    path.write_text(MODEL, encoding="utf-8")
    detector = photons.load(path)
source = photons.point([0, 0, -499], 450, towards=[0, 0, 1])
steps = detector.simulate(source, n=20_000, seed=1, record="steps").histories
ended = np.array(steps.process_names)[steps["process"]] == "absorbed"
depth = steps["z"][ended] + 499

figure, axis = plt.subplots(figsize=(6, 3.4), layout="constrained")
counts, edges, _ = axis.hist(depth, bins=60, range=(0, 900), histtype="step", label="photons")
middle = (edges[1:] + edges[:-1]) / 2
axis.plot(middle, 20_000 * 15 / 150 * np.exp(-middle / 150), label="exp(-z / 150 mm)")
axis.set(yscale="log", xlabel="depth in mm", ylabel="photons absorbed in 15 mm")
axis.legend()

# the mean of an exponential that ends at L = 999
exact = 150 - 999 / (np.exp(999 / 150) - 1)
print(f"mean depth {depth.mean():.2f} mm, exactly {exact:.2f} +- {depth.std() / np.sqrt(len(depth)):.2f}")
assert abs(depth.mean() - exact) < 4 * depth.std() / np.sqrt(len(depth))
