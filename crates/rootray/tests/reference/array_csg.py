"""Writes array_csg.txt: hit arrays combined by numpy, the reference table of tests/hit_array_numpy.rs.

The function below states the algorithm of R. Frazier, "Efficient CSG" (2021): merge the hits of both solids, count the
solids entered, keep the hits at which the count says that the result is entered or left. The sort is stable, so that
the table does not depend on numpy's choice of algorithm.

Run: python array_csg.py > array_csg.txt
"""

import platform
import sys

import numpy as np

SEED = 20210315
CASES = 300


def array_csg(array1, array2, operation, sort_output):
    """Hits of the combined solid; invalid entries are inf."""
    stacked = np.concatenate((array1, array2), axis=0)
    order = np.argsort(stacked, axis=0, kind="stable")
    merged = np.take_along_axis(stacked, order, axis=0)
    leaves = (order & 1).astype(bool)
    if operation == "difference":
        count = 1 + np.cumsum(np.where(leaves ^ (order >= array1.shape[0]), -1, 1), axis=0)
    else:
        count = np.cumsum(np.where(leaves, -1, 1), axis=0)
    if operation == "union":
        changes = np.logical_xor(count, np.roll(count, 1, axis=0))
    else:
        both = count == 2
        changes = both | np.roll(both, 1, axis=0)
    hits = np.where(changes, merged, np.inf)
    return np.sort(hits, axis=0, kind="stable") if sort_output else hits


def random_hits(rng, rows, columns, dtype):
    """Sorted columns with ties between and within arrays, padding, and unbounded starts."""
    hits = rng.integers(0, 12, (rows, columns)).astype(dtype)
    if rng.random() < 0.3:
        hits = rng.normal(0, 5, (rows, columns)).astype(dtype)
    kind = rng.random((rows, columns))
    hits[kind < 0.15] = np.inf
    hits[kind > 0.93] = -np.inf
    return np.sort(hits, axis=0, kind="stable")


def write(name, array):
    rows, columns = array.shape
    # repr of a Python float reads back to the same number; a float32 is written as the float64 equal to it
    numbers = " ".join(repr(float(t)) for t in array.ravel())
    print(f"{name} {rows} {columns} {numbers}".rstrip())


def main():
    rng = np.random.default_rng(SEED)
    print("# array_csg of random hit arrays, by array_csg.py")
    print(f"# numpy {np.__version__}, Python {platform.python_version()}, seed {SEED}")
    print("# case: dtype operation sort_output; arrays: name rows columns, then all numbers row by row")
    for _ in range(CASES):
        dtype = rng.choice(["f32", "f64"])
        operation = rng.choice(["union", "intersect", "difference"])
        sort_output = bool(rng.random() < 0.7)
        columns = int(rng.integers(1, 4))
        arrays = [
            random_hits(rng, 2 * int(rng.integers(0, 5)), columns, {"f32": np.float32, "f64": np.float64}[dtype])
            for _ in range(2)
        ]
        if arrays[0].shape[0] + arrays[1].shape[0] == 0:
            continue
        print(f"case {dtype} {operation} {'sorted' if sort_output else 'masked'}")
        write("array1", arrays[0])
        write("array2", arrays[1])
        write("hits", array_csg(arrays[0], arrays[1], operation, sort_output))


if __name__ == "__main__":
    sys.exit(main())
