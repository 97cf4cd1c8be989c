"""Solids from outlines: extrusions and solids of revolution."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rayweave._core import Solid, extrude_outline, revolve_outline
from rayweave._words import suggesting

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike


@suggesting(h="height", contours="outline", points="outline", round="fillet", bevel="chamfer")
def extrude(
    outline: ArrayLike | Sequence[ArrayLike],
    height: float,
    *,
    z: float = 0.0,
    fillet: float = 0.0,
    chamfer: float = 0.0,
    top_fillet: float = 0.0,
    top_chamfer: float = 0.0,
    bottom_fillet: float = 0.0,
    bottom_chamfer: float = 0.0,
) -> Solid:
    """The prism over an outline, from `z` to `z + height`.

    `outline` is a closed contour or a list of contours, in any orientation: points within an odd number of them are inside.
    A contour is an array of points (N, 2), or (N, 3) with a bulge: the tangent of a quarter of the angle that the edge to the
    next point turns by, as in DXF. A bulge of 1 is half a circle to the left, 0 a straight edge. Arcs are exact.

    `fillet` rounds all corners between straight edges with this radius, `chamfer` cuts off this length of both edges. The
    arguments with `top` and `bottom` treat the rims of the ends in the same way. Lengths are those of the model.

    Raises `ValueError` for contours that cross or touch, have no area, or have no room for a fillet or chamfer.

    >>> import rayweave as rw
    >>> plate = [[0, 0], [60, 0], [60, 40], [0, 40]]
    >>> hole = [[25, 20, 1], [35, 20, 1]]
    >>> part = rw.extrude([plate, hole], 5, fillet=6, top_chamfer=1)
    >>> part.contains([[1, 1, 1], [30, 20, 1], [10, 10, 1]])
    array([False, False,  True])
    """
    contours = _contours(outline)
    corner = _form("fillet", fillet, "chamfer", chamfer)
    bottom = _form("bottom_fillet", bottom_fillet, "bottom_chamfer", bottom_chamfer)
    top = _form("top_fillet", top_fillet, "top_chamfer", top_chamfer)
    if not _number("height", height) > 0:
        raise ValueError(f"height is {height}: it must be greater than 0.")
    _number("z", z)
    return extrude_outline((contours, corner), z, z + height, (bottom, top))


@suggesting(degrees="angle", sweep="angle", contours="outline", points="outline", round="fillet", bevel="chamfer")
def revolve(
    outline: ArrayLike | Sequence[ArrayLike],
    angle: float = 360.0,
    *,
    start: float = 0.0,
    fillet: float = 0.0,
    chamfer: float = 0.0,
) -> Solid:
    """The solid of revolution of an outline at x >= 0 about its axis x = 0.

    The axis becomes the z axis: y becomes z, x becomes the distance from the axis. The outline, `fillet` and `chamfer` are those
    of `extrude`. `angle` is the part of a turn in degrees, greater than 0 and at most 360; `start` is the
    angle at which it begins, counted from the x axis.

    Straight edges become cones, cylinders and planes, arcs become tori and spheres. An arc whose centre is at x < 0 is replaced
    by chords within 1e-6 of the larger side of the outline.

    Raises `ValueError` for an outline that reaches x < 0, and for the reasons of `extrude`.

    >>> import rayweave as rw
    >>> ring = rw.revolve([[[10, 0, 1], [6, 0, 1]]])  # a torus
    >>> ring.contains([[8, 0, 1.9], [0, -8, 2.1]])
    array([ True, False])
    """
    contours = _contours(outline)
    corner = _form("fillet", fillet, "chamfer", chamfer)
    if not 0 < _number("angle", angle) <= 360:
        raise ValueError(f"angle is {angle}: it must be greater than 0 and at most 360 degrees.")
    _number("start", start)
    return revolve_outline((contours, corner), start, angle)


def _number(name: str, value: float) -> float:
    """The value, if it is a finite number."""
    try:
        is_finite = math.isfinite(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}: it must be a number.") from None
    if not is_finite:
        raise ValueError(f"{name} is {value}: it must be finite.")
    return value


def _form(fillet_name: str, fillet: float, chamfer_name: str, chamfer: float) -> tuple[float, float]:
    """A fillet and a chamfer, at most one of which is not 0."""
    for name, size in ((fillet_name, fillet), (chamfer_name, chamfer)):
        if not _number(name, size) >= 0:
            raise ValueError(f"{name} is {size}: it must be at least 0.")
    if fillet and chamfer:
        raise ValueError(f"{fillet_name} and {chamfer_name} are both given: a corner has one form.")
    return float(fillet), float(chamfer)


def _contours(outline: Any) -> list[list[tuple[float, float, float]]]:
    """The contours as lists of x, y and bulge."""
    try:
        items = list(outline)
    except TypeError:
        raise TypeError(f"outline is {outline!r}: it must be an array of points, or a list of such arrays.") from None
    if not items:
        raise ValueError("outline is empty: it must have at least one contour.")
    if _depth(items[0]) < 2:
        return [_contour(items, "outline")]
    return [_contour(contour, f"outline[{number}]") for number, contour in enumerate(items)]


def _depth(item: Any) -> int:
    """0 for a number, 1 for a point, 2 for a contour, whose points may have different lengths."""
    if isinstance(item, list | tuple):
        return 1 + max((_depth(own) for own in item[:1]), default=0)
    return np.ndim(item)


def _check_lengths(points: Any, name: str) -> None:
    """Rejects points with different numbers of coordinates, which NumPy reports by its own terms."""
    lengths = [len(point) for point in points if isinstance(point, list | tuple | np.ndarray) and np.ndim(point) == 1]
    for number, length in enumerate(lengths):
        if length != lengths[0]:
            raise ValueError(f"{name}: point {number} has {length} numbers, point 0 has {lengths[0]}: all must have as many.")


def _contour(points: Any, name: str) -> list[tuple[float, float, float]]:
    if isinstance(points, list | tuple):
        _check_lengths(points, name)
    try:
        array = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is not an array of numbers: it must have shape (N, 2) or (N, 3).") from error
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ValueError(f"{name} has shape {array.shape}: it must be (N, 2), or (N, 3) with a bulge.")
    full = np.zeros((len(array), 3))
    full[:, : array.shape[1]] = array
    return [(x, y, bulge) for x, y, bulge in full.tolist()]
