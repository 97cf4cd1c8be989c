"""Signed distances and nearest points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from rayweave._table import Table

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Distances(Table):
    """Signed distances of N points from a surface, negative inside, with the nearest points and bounds.

    The distance lies between `lower` and `upper` in magnitude. Both agree where `is_exact`; elsewhere `distance` is only that
    of the nearest point that was found. The points of a grid (..., 3) are numbered in row-major order, so that
    ``distance.reshape(grid)`` has the shape of the grid.

    >>> import rayweave as rw
    >>> found = rw.box(2).distance([[2, 0, 0], [2, 2, 2], [0, 0, 0.5]])
    >>> found.distance.round(6)
    array([ 1.      ,  1.732051, -0.5     ])
    >>> found[1]["nearest"].round(6)
    array([1., 1., 1.])
    >>> bool(found.is_exact.all())
    True
    """

    _columns: ClassVar[tuple[str, ...]] = ("point", "distance", "nearest", "lower", "upper", "is_exact")

    distance: _Array
    """(N,) the distance of `nearest`, negative inside; its magnitude lies between the bounds. Infinite if there is no surface or none
    was found."""
    lower: _Array
    """(N,) a lower bound of the magnitude of the distance."""
    upper: _Array
    """(N,) an upper bound of it, rounded up; infinite if no surface was found."""
    is_exact: NDArray[np.bool_]
    """(N,) whether both bounds agree within the requested precision, or there is no surface."""
    nearest: _Array
    """(N, 3) the nearest point of the surface that was found; NaN if none was found. It may be off the exact nearest point, along the
    surface, by about the square root of the precision, times the distance."""
    point: _Array
    """(N, 3) the points."""
