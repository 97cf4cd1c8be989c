"""Boxes as arguments."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rayweave import _core

Box: TypeAlias = ArrayLike
"""(2, 3): the lower and the upper corner of a box."""


def corners(within: Box | None) -> list[list[float]] | None:
    """The corners of a box as lists."""
    if within is None:
        return None
    try:
        box = np.asarray(within, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"within is {within!r}: it must be (2, 3): the corners of a box.") from None
    if box.shape != (2, 3):
        raise _core.RayweaveError(f"within has shape {box.shape}: it must be (2, 3): the corners of a box.")
    rows: list[list[float]] = box.tolist()
    return rows
