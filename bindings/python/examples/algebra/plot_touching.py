"""
Faces that touch
================

Ten tiles, turned by an angle that no floating-point number represents, share their faces without a gap: rays find no
sliver of vacuum between them, at any angle. Tiles that are 1e-12 apart have gaps.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

rng = np.random.default_rng(3)


def gaps(distance: float) -> int:
    """The number of pieces of vacuum between tiles, over 20,000 rays."""
    tiles = [rw.box([1, 4, 4]).translate([(1 + distance) * k, 0, 0]).rotate_z(37.3).rotate_x(11.7) for k in range(10)]
    model = rw.Model([rw.Region(f"tile{k}", tile, medium=f"tile{k}") for k, tile in enumerate(tiles)])
    axis = np.array(rw.box(1).translate([1, 0, 0]).rotate_z(37.3).rotate_x(11.7).bounds).mean(axis=0)
    origins = rng.normal(scale=0.3, size=(20_000, 3)) - 5 * axis
    pieces = model.partition(origins, axis, t_min=0, t_max=20)
    world = pieces.medium == pieces.medium_names.index("world")
    first, last = pieces.offsets[:-1], pieces.offsets[1:] - 1
    outer = np.zeros(len(world), bool)
    outer[first] = outer[last] = True
    return int((world & ~outer).sum())


distances = [0, 1e-12, 1e-6, 1e-3]
counts = [gaps(distance) for distance in distances]
print(dict(zip(distances, counts, strict=True)))
assert counts[0] == 0 and counts[-1] == 9 * 20_000

figure, axis = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
axis.bar([f"{distance:g}" for distance in distances], counts)
axis.set(xlabel="distance of the tiles", ylabel="gaps that 20,000 rays found")
