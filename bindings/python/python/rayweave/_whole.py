"""Checks of whole numbers: errors name the argument."""

from __future__ import annotations

import operator
from typing import Any

from rayweave import _core


def whole(value: Any, name: str, least: int = 0, bits: int = 64) -> int:
    """A whole number of at most `bits` bits, also as a float such as 1e5."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}: it must be a whole number.") from None
    if number < least:
        raise _core.RayweaveError(f"{name} is {number}: it must be at least {least}.")
    if number >= 2**bits:
        raise _core.RayweaveError(f"{name} is {number}: it must be below 2^{bits}.")
    return number
