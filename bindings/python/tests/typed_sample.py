"""Every part of the interface as a type checker sees it: read by mypy --strict, run by test_typed_sample."""

from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import rayweave
from rayweave import Operation, RootRay, rootray


def hit_arrays() -> None:
    hits = rayweave.array_csg([1, 4], np.array([2, 3], np.float32), Operation.UNION, False, out=np.zeros(4))
    assert hits.shape == (4,)
    times, counts = rayweave.count_array([1, 4], [2, 3], Operation.INTERSECT)
    assert_type(counts, NDArray[np.int64])
    assert times.shape == counts.shape


def root_rays() -> None:
    ray = RootRay("outside", [1, 2]) | ~RootRay(-1, np.array([3.0]))
    assert_type(ray.roots, list[float])
    assert_type(ray.clip(t_min=0).weld(), RootRay)
    assert_type(rootray.union(ray, (1, [2.0])), RootRay)
    assert_type(rootray.union((1, [1.0]), (1, (2.0, 3.0))), tuple[int, list[float]])
    assert_type(rootray.validate(ray), list[str])
    start, roots = rootray.complement((1, [1.0]))
    assert (start, roots) == (-1, [1.0])


def main() -> None:
    hit_arrays()
    root_rays()
