"""
Light to Parquet
================

A trace of light is written to a Parquet file batch by batch, so that memory does not grow with the number of rays. The file
is then read one column at a time.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pyarrow.parquet as pq

from rayweave import optics

lens = optics.biconvex_lens(60, 60, 5, aperture=24)
screen = optics.detector(40, name="screen").translate([0, 0, 55])
light = optics.beam(20, 50_000, wavelength_nm={486.1: 1, 587.6: 1, 656.3: 1}).translate([0, 0, -20])

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "segments.parquet"
    balance = optics.System([lens, screen]).trace_to(path, light, rows=32_768)
    print(f"{path.stat().st_size / 1e6:.1f} MB, balance of power: {balance.error:.1e}")
    columns = ["event", "surface", "x1", "y1", "z1", "wavelength_nm"]
    table = pq.read_table(path, columns=columns).to_pandas()

hits = table[np.isclose(table["z1"], 55)]
figure, axis = plt.subplots(figsize=(4.5, 4), layout="constrained")
for wavelength, points in hits.groupby("wavelength_nm"):
    radius = np.hypot(points["x1"], points["y1"])
    axis.hist(radius, bins=np.linspace(0, 1, 80), histtype="step", label=f"{wavelength} nm", color={486.1: "b", 587.6: "orange"}.get(wavelength, "r"))
axis.set(xlabel="distance from the axis in mm", ylabel="rays")
axis.legend()
assert len(hits) >= 45_000 and abs(balance.error) < 1e-9
