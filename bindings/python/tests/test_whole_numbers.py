"""Numbers that are too large, negative or not whole: the error names the argument."""

from collections.abc import Callable
from typing import Any

import pytest

import rayweave as rw
from rayweave import cluster

BALL = rw.Model({"a": rw.sphere(1)})


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: rw.check(BALL, cells=-1), rw.RayweaveError, "cells is -1: it must be at least 0"),
        (lambda: rw.check(BALL, most_pairs=2**80), rw.RayweaveError, "most_pairs is 1208925819614629174706176"),
        (lambda: rw.diff(BALL, BALL, cells=1.5), TypeError, "cells is 1.5: it must be a whole number"),
        (lambda: rw.measure(BALL, most_rays=0), rw.RayweaveError, "most_rays is 0: it must be at least 1"),
        (lambda: rw.measure(BALL, seed=-1), rw.RayweaveError, "seed is -1"),
        (lambda: rw.section(BALL, columns=2**32), rw.RayweaveError, "columns is 4294967296"),
        (lambda: rw.section(BALL, columns=1), rw.RayweaveError, "columns is 1: it must be from 2 to 65536"),
        (lambda: rw.thickness(BALL, size=(-1, 4)), rw.RayweaveError, "the width is -1"),
        (lambda: rw.thickness(BALL, size=(1, 2, 3)), TypeError, "it must be two whole numbers"),
        (lambda: rw.measure(BALL, threads=2**70), rw.RayweaveError, "threads is 1180591620717411303424: it must be below"),
        (lambda: cluster.ranges(10, 2, step=0), rw.RayweaveError, "step is 0: it must be at least 1"),
    ],
)
def test_the_argument_is_named(call: Callable[[], Any], kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        call()


def test_floats_that_are_whole_are_accepted() -> None:
    assert rw.measure(BALL, seed=3.0, most_rays=1e4).rays == rw.measure(BALL, seed=3, most_rays=10_000).rays
