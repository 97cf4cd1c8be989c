"""
Batches and Parquet
===================

More rays than fit in memory: results are made batch by batch, written to Parquet, and read back one column at a time.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

import rayweave as rw
from rayweave import optics

folder = Path(tempfile.mkdtemp())

# %%
# Path lengths
# ------------
# The pieces of 200,000 rays in a model, in batches of 50,000. Each batch becomes a row group.

model = rw.Model(
    [
        rw.Region("tank", rw.box([20, 20, 10]), medium="water"),
        rw.Region("ball", rw.sphere(4), medium="glass"),
        rw.Region("core", rw.sphere(2), medium="air"),
    ]
)
rng = np.random.default_rng(1)
writer = None
for batch in range(4):
    origins = np.column_stack([rng.uniform(-10, 10, (50_000, 2)), np.full(50_000, 50.0)])
    table = model.partition(origins, [0, 0, -1], t_min=0, t_max=100).to_arrow()
    # numbers of rays go on from batch to batch
    table = table.set_column(table.schema.get_field_index("ray"), "ray", pc.add(table["ray"], 50_000 * batch))
    writer = writer or pq.ParquetWriter(folder / "pieces.parquet", table.schema)
    writer.write_table(table)
writer.close()
file = pq.ParquetFile(folder / "pieces.parquet")
print(f"{file.metadata.num_rows} rows in {file.num_row_groups} row groups")

# %%
# Only two columns are read. The mean path in the core times the area of the beam is its volume.

columns = pq.read_table(folder / "pieces.parquet", columns=["medium", "t_start", "t_end"])
length = pc.subtract(columns["t_end"], columns["t_start"])
grouped = pa.table({"medium": columns["medium"], "length": length}).group_by("medium").aggregate([("length", "sum")])
sums = dict(zip(grouped["medium"].to_pylist(), grouped["length_sum"].to_pylist(), strict=True))
volume, exact = sums["air"] / 200_000 * 400, 4 / 3 * np.pi * 2**3
print(f"volume of the core {volume:.3f}, exactly {exact:.3f}")
assert abs(volume - exact) < 0.05 * exact

# %%
# Light
# -----
# ``System.trace_to`` does this by itself: the file grows while the light is traced, and an interrupted trace leaves no file.

lens = optics.plano_convex_lens(52, 6, aperture=24)
screen = optics.detector(60, name="screen").translate([0, 0, 100])
light = optics.beam(20, 60_000, wavelength_nm=550).translate([0, 0, -20])
balance = optics.System([lens, screen]).trace_to(folder / "light.parquet", light, rows=16_384)
file = pq.ParquetFile(folder / "light.parquet")
print(f"{file.metadata.num_rows} segments, {(folder / 'light.parquet').stat().st_size / 1e6:.1f} MB, error {balance.error:.0e}")

# %%
# A histogram over the batches of the file, without the whole table in memory:

edges = np.linspace(0, 10, 101)
counts = np.zeros(100, int)
for batch in file.iter_batches(columns=["x1", "y1", "z1"], batch_size=16_384):
    x, y, z = (batch.column(k).to_numpy() for k in range(3))
    counts += np.histogram(np.hypot(x, y)[np.isclose(z, 100)], edges)[0]
figure, axis = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
axis.stairs(counts, edges)
axis.set(xlabel="distance from the axis on the screen in mm", ylabel="rays")
assert counts.sum() == 60_000

# %%
# Streams
# -------
# ``stream`` returns the same batches as objects, for programs that want to compute and forget.

powers = []
with optics.System([lens, screen]).stream(light, rows=16_384) as batches:
    for batch in batches:
        powers.append(batch["intensity"].sum())
print(f"{len(powers)} batches")
