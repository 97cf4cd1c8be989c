"""
Many processes
==============

A run of photons is divided among processes. The hits are those of one process, bit for bit, however the run is divided.
"""

import tempfile
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rayweave.photons as photons
from rayweave import cluster

MODEL = """
rayweave = 1
unit = "mm"
[solid.hall]
box = { size = [100, 100, 100] }
[solid.tile]
box = { size = [40, 40, 10] }
[solid.sensor]
box = { size = [10, 10, 1] }
transform = [{ translate = [10, 5, 5.5] }]
[[region]]
solid = "hall"
medium = "opaque"
[[region]]
solid = "tile"
medium = "plastic"
[[region]]
solid = "sensor"
medium = "opaque"
[medium.opaque]
[medium.plastic]
[photons.medium.plastic]
RINDEX = 1.58
ABSLENGTH = 300
[[photons.surface]]
name = "wrapping"
model = "unified"
finish = "groundfrontpainted"
type = "dielectric_dielectric"
value = 0
skin = ["tile"]
REFLECTIVITY = 0.97
[[photons.surface]]
name = "cathode"
model = "unified"
finish = "polished"
type = "dielectric_metal"
border = [["tile", "sensor"]]
REFLECTIVITY = 0
EFFICIENCY = 0.4
"""


if __name__ == "__main__":
    # new processes import this file, so that its work is done in the first process only
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "tile.toml"
        path.write_text(MODEL, encoding="utf-8")
        detector = photons.load(path)
        source = photons.point([-10, -8, 0], 425)
        job = cluster.Photons(detector, source, n=20_000, seed=1)
        with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as executor:
            found = cluster.futures.run(job, executor, folder=Path(folder))
    alone = detector.simulate(source, n=20_000, seed=1)
    print(found.ends)
    assert np.array_equal(found.hits["time"], alone.hits["time"])

    figure, axis = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
    axis.hist(found.hits["time"], bins=80)
    axis.set(xlabel="time in ns", ylabel="hits")
