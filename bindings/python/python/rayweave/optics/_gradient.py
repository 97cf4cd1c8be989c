"""Media whose index changes from place to place."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from rayweave._core import Glass, GradedMedium
from rayweave.optics._elements import _medium
from rayweave.optics._given import real, text

#: The law of the factor on the index; see `graded`.
Law = Literal["selfoc", "squared", "radial", "axial", "fish_eye", "luneburg"]


def graded(
    material: Glass | str | float | complex,
    law: Law,
    *numbers: float,
    world_from_local: ArrayLike | None = None,
) -> GradedMedium:
    """A medium whose index is that of a material times a function of position; light follows curves in it.

    - `graded(m, "selfoc", g)`: `sqrt(1 - g^2 r^2)`, r the distance from the axis z;
    - `graded(m, "squared", a0, a1, ..)`: `sqrt(a0 + a1 r^2 + a2 r^4 + ..)`;
    - `graded(m, "radial", r0, r1, ..)`: `r0 + r1 r^2 + r2 r^4 + ..`;
    - `graded(m, "axial", c0, c1, ..)`: `c0 + c1 z + c2 z^2 + ..`;
    - `graded(m, "fish_eye", a)`: `2 / (1 + r^2 / a^2)`, r the distance from the origin (Maxwell);
    - `graded(m, "luneburg", a)`: `sqrt(2 - r^2 / a^2)` (Luneburg).

    Lengths are in the unit of the system. `world_from_local`, a 4 x 4 matrix, moves the law; by default the law holds
    in the frame of the world, independent of the position of the element.

    >>> import rayweave.optics as ro
    >>> rod = ro.graded(1.6, "selfoc", 0.1)
    >>> round(rod.index(587.6, (0, 0, 0)), 6), round(rod.index(587.6, (1, 0, 0)), 6)
    (1.6, 1.59198)
    """
    place = np.eye(4) if world_from_local is None else world_from_local
    known = [real(number, f"a number of the law {law!r}") for number in numbers]
    return GradedMedium(_medium(material), (text(law, "law"), known), place)
