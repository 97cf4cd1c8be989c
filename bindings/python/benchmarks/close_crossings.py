"""Counts the rays with two crossings so close to each other that a coincidence may have been split.

    python close_crossings.py RAYS MODEL [MODEL ...]

A *torn* ray (see docs/concepts/correctness.md) passes an edge and grazes one of its faces: it has two crossings within
about 1e-12 of the model's size where exact arithmetic has one or none. For each model file the script traces rays
between random points of the ball around the model, and rays along the axes and diagonals of a grid of points in its
box, which hit many edges. It counts rays with two crossings within 1e-10 of the ball's diameter: torn rays, and a few
others that cut a corner. The count is therefore an upper bound.
"""

import sys
from pathlib import Path

import numpy as np

import rayweave as rw

CHUNK = 50_000
CLOSE = 1e-10
#: Half the size of the box for unbounded models.
FREE = 1e3


def random_rays(rng, middle, radius, count):
    ends = rng.normal(size=(2, count, 3))
    ends *= radius / np.linalg.norm(ends, axis=2, keepdims=True)
    return middle + ends[0], ends[1] - ends[0]


def aligned_rays(rng, middle, half, count):
    through = middle + half * np.round(rng.uniform(-1, 1, (count, 3)) * 32) / 32
    directions = rng.integers(-1, 2, (count, 3)).astype(float)
    directions[(directions == 0).all(axis=1)] = [0, 0, 1]
    return through - 4 * np.linalg.norm(half) * directions, directions


def close_rays(model, make, count):
    """The number of crossings of `count` rays, the number of rays with close crossings, and the smallest distance of
    two crossings."""
    rng = np.random.default_rng(5)
    low, high = np.asarray(model.bounds)
    if not np.isfinite([low, high]).all():
        low, high = np.full(3, -FREE), np.full(3, FREE)
    middle, half = (low + high) / 2, (high - low) / 2
    radius = np.linalg.norm(half)
    extent = radius if make is random_rays else half
    crossings, close, least = 0, 0, np.inf
    for begin in range(0, count, CHUNK):
        origins, directions = make(rng, middle, extent, min(CHUNK, count - begin))
        found = model.crossings(origins, directions)
        rays, speeds = found.ray, np.linalg.norm(directions, axis=1)
        gaps = np.diff(found.t) * speeds[rays[1:]] / (2 * radius)
        inner = rays[1:] == rays[:-1]
        crossings += len(rays)
        close += len(np.unique(rays[1:][inner & (gaps < CLOSE)]))
        least = min(least, gaps[inner].min(initial=np.inf))
    return crossings, close, least


def main():
    count = int(sys.argv[1])
    print("| model | rays | crossings | rays with close ones | least distance / size |")
    print("| --- | --- | ---: | ---: | ---: |")
    for path in map(Path, sys.argv[2:]):
        model = rw.load(path)
        for make, name in ((random_rays, "random"), (aligned_rays, "aligned")):
            crossings, close, least = close_rays(model, make, count)
            print(f"| {path.stem} | {name} | {crossings} | {close} | {least:.0e} |", flush=True)


if __name__ == "__main__":
    main()
