"""Answers that are more than one array."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Crossings:
    """Where rays cross the surface of a solid: M rows, sorted by ray, then t.

    The rows of ray i are ``offsets[i]:offsets[i + 1]``. What `nearest` answers has one row for every ray.
    """

    ray: NDArray[np.int64]
    """(M,) the number of the ray."""
    t: NDArray[np.float64]
    """(M,) when, in units of the ray's direction; inf for a miss."""
    point: NDArray[np.float64]
    """(M, 3) where; NaN for a miss."""
    normal: NDArray[np.float64]
    """(M, 3) the unit normal, outward of the result: against the ray where it enters. NaN for a miss."""
    enters: NDArray[np.bool_]
    """(M,) whether the ray enters the solid, or leaves it."""
    surface: NDArray[np.int32]
    """(M,) the face that is crossed, as an index of `surface_names`; -1 for a miss."""
    leaf: NDArray[np.int32]
    """(M,) the shape that the face belongs to, in the order of declaration; -1 for a miss."""
    placement: NDArray[np.int32]
    """(M,) which placement of that shape it is: 0 for what is not placed; -1 for a miss."""
    offsets: NDArray[np.int64]
    """(N + 1,) where the rows of each ray begin, and their total at the end."""
    start_inside: NDArray[np.bool_]
    """(N,) whether the ray is inside just after t_min."""
    surface_names: tuple[str, ...]
    """The names of all faces."""

    def __len__(self) -> int:
        """The number of rows, M."""
        return len(self.t)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self)} rows of {len(self.start_inside)} rays>"
