"""
Many processes
==============

A long run is divided into ranges of photons. The parts can be computed anywhere, in any order, and continued after a failure;
the joined result has the bits of one run.
"""

import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rayweave.photons as photons
from rayweave import cluster

# %%
# A detector and a job
# --------------------

MODEL = """
rayweave = 1
unit = "mm"
[solid.hall]
box = { size = [200, 200, 200] }
[solid.bar]
box = { size = [20, 20, 100] }
[solid.diode]
box = { size = [20, 20, 1] }
transform = [{ translate = [0, 0, 50.5] }]
[[region]]
solid = "hall"
medium = "opaque"
[[region]]
solid = "bar"
medium = "crystal"
[[region]]
solid = "diode"
medium = "opaque"
[medium.opaque]
[medium.crystal]
[photons.medium.crystal]
RINDEX = 1.79
ABSLENGTH = 400
[[photons.surface]]
name = "wrapping"
model = "unified"
finish = "groundfrontpainted"
type = "dielectric_dielectric"
value = 0
skin = ["bar"]
REFLECTIVITY = 0.95
[[photons.surface]]
name = "cathode"
model = "unified"
finish = "polished"
type = "dielectric_metal"
border = [["bar", "diode"]]
REFLECTIVITY = 0
EFFICIENCY = 0.3
"""
folder = Path(tempfile.mkdtemp())
(folder / "bar.toml").write_text(MODEL, encoding="utf-8")
detector = photons.load(folder / "bar.toml")
source = photons.point([0, 0, 0], ("uniform", 450, 600))
job = cluster.Photons(detector, source, n=40_000, seed=1)

# %%
# Parts by hand
# -------------
# ``ranges`` divides the numbers of the photons, ``part`` computes one range, ``join`` puts parts together.

spans = cluster.ranges(40_000, 5)
parts = [job.part(first, last) for first, last in spans]
joined = job.join(parts)
whole = detector.simulate(source, n=40_000, seed=1)
assert np.array_equal(joined.hits["time"], whole.hits["time"])
print(spans, "->", joined.hits["time"].size, "hits, the same bits as one run")

# %%
# An executor
# -----------
# ``futures.run`` does the same with an executor of the standard library: here threads. For processes it is
# ``ProcessPoolExecutor()``, for machines Dask, Ray or MPI by modules of the same form.

with ThreadPoolExecutor(2) as executor:
    found = cluster.futures.run(job, executor, pieces=8)
assert np.array_equal(found.hits["time"], whole.hits["time"])
print(found.ends)

# %%
# After a failure
# ---------------
# If parts are lost, the error carries the others. ``missing`` lists what has to be done again.

done = {span: part for span, part in zip(spans, parts, strict=True) if span != spans[2]}
print("missing:", cluster.missing(40_000, done))
with ThreadPoolExecutor(2) as executor:
    resumed = cluster.futures.run(job, executor, done=done)
assert np.array_equal(resumed.hits["time"], whole.hits["time"])

# %%
# The scatter of independent runs
# -------------------------------
# Different seeds are independent runs: the numbers of hits scatter like binomial ones.

numbers = [detector.simulate(source, n=5_000, seed=seed).hits.rows for seed in range(40)]
mean = np.mean(numbers)
expected = np.sqrt(mean * (1 - mean / 5_000))
print(f"{mean:.1f} hits on average, standard deviation {np.std(numbers, ddof=1):.1f}, binomial {expected:.1f}")
figure, axis = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
axis.hist(numbers, bins=12)
axis.set(xlabel="hits of 5,000 photons", ylabel="runs")
