"""Solids in spaces of 2, 3 and 4 dimensions, and curves: the same boolean algebra along any trajectory.

Solids: the functions below create a `Solid` of this module; their last parameter `d` is the dimension of its space.
Axes are counted from 0; the last axis can be time. Lengths must be 0 or of a magnitude between 1e-60 and 1e60. The
operators are ``| & - ^ ~``, as for the ordinary solids of `rayweave`.

Curves: `Line`, `Parabola`, `Arc`, `Helix`, `Spline`, or any object of your own with the three methods of `Trajectory`.
The solids of this module and the ordinary solids and models of `rayweave` have a method ``crossings_along``. Crossings
are isolated by bounds, not by sampling, so that none is missed. Angles are in degrees.

>>> import rayweave.space as rs
>>> ring = rs.ball(2, d=2) - rs.ball(1, d=2)
>>> rs.trace([-4, 0], [-3, 0], ring)
RootRay(+1, [2.0, 3.0, 5.0, 6.0])
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._core import Arc, Curve, Helix, Line, Parabola, RayweaveError, RootRay, Spline
from rayweave._core import SpaceSolid as Solid
from rayweave._table import Table

__all__ = [
    "Arc",
    "Curve",
    "Helix",
    "Line",
    "Parabola",
    "PointCrossings",
    "Solid",
    "Spline",
    "Trajectory",
    "ball",
    "box",
    "cone",
    "cylinder",
    "half_space",
    "half_space_below",
    "intersection",
    "universe",
    "prism",
    "quadric",
    "slab",
    "trace",
    "trace_along",
    "union",
    "empty",
]


class Trajectory(Protocol):
    """The methods of a user-defined curve; the third one returns a bound of its acceleration.

    The answers are correct if the curve is continuously differentiable and the bound holds. A violation that is
    detected raises a `RayweaveError` with the times; exceptions raised by these methods propagate unchanged. The
    optional attribute `domain`, a pair of times, states where the curve is defined; by default everywhere.

    >>> import rayweave.space as rs
    >>> class Fall:
    ...     def position(self, t):
    ...         return [0.0, 3.0 - t * t]
    ...     def velocity(self, t):
    ...         return [0.0, -2.0 * t]
    ...     def acceleration_bound(self, t0, t1):
    ...         return 2.0
    ...
    >>> rs.ball(1, d=2).crossings_along(Fall(), 0, 3).t.round(6)
    array([1.414214, 2.      ])
    """

    def position(self, t: float, /) -> ArrayLike:
        """r(t): (d,), finite, exact to rounding."""

    def velocity(self, t: float, /) -> ArrayLike:
        """r'(t): (d,), finite, exact to rounding."""

    def acceleration_bound(self, t0: float, t1: float, /) -> float:
        """An upper bound of the Euclidean length of r'' between two times, t0 < t1: finite, at least 0.

        A tighter bound needs fewer evaluations; the bound may be the same for all times.
        """


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class PointCrossings(Table):
    """Crossings of lines or curves with the surface of a solid in R^d: M rows, sorted by ray, then t.

    A ray is a line or a curve. The rows of ray i are ``offsets[i]:offsets[i + 1]``.

    >>> import rayweave.space as rs
    >>> found = rs.ball(1, d=2).crossings([-2, 0], [2, 0])
    >>> found.t, found.enters
    (array([0.25, 0.75]), array([ True, False]))
    >>> found.to_pandas()[["t", "point_x"]]
          t  point_x
    0  0.25     -1.0
    1  0.75      1.0
    """

    _columns: ClassVar[tuple[str, ...]] = ("ray", "t", "point", "normal", "enters", "surface", "leaf")
    _names: ClassVar[Mapping[str, str]] = {"surface": "surface_names"}

    ray: NDArray[np.int64]
    """(M,) the number of the line or curve."""
    t: NDArray[np.float64]
    """(M,) the time t: for a line through p and q, 0 at p and 1 at q; for a curve its parameter."""
    point: NDArray[np.float64]
    """(M, d) the point."""
    normal: NDArray[np.float64]
    """(M, d) the unit normal, pointing out of the solid: against the ray where it enters."""
    enters: NDArray[np.bool_]
    """(M,) True where the ray enters the solid, False where it leaves."""
    surface: NDArray[np.int32]
    """(M,) the face that is crossed, as an index of `surface_names`."""
    leaf: NDArray[np.int32]
    """(M,) the shape that the face belongs to, in the order of declaration."""
    offsets: NDArray[np.int64]
    """(N + 1,) the first row of each ray, followed by the total number of rows."""
    start_inside: NDArray[np.bool_]
    """(N,) whether a line comes from infinity inside, or a curve is inside just after t_min."""
    surface_names: tuple[str, ...]
    """The names of all faces: that of the shape; for a slab with ``.lo`` or ``.hi``, for a box as in ``.lo0``."""

    def __len__(self) -> int:
        """The number of rows, M."""
        return len(self.t)

    def _heading(self) -> str:
        return f"PointCrossings: {len(self)} rows of {len(self.start_inside)} rays"


def empty(d: int) -> Solid:
    """The empty solid in a space of d dimensions: the neutral element of union.

    >>> import rayweave.space as rs
    >>> rs.empty(2).contains([0, 0])
    array([False])
    """
    return _shape("empty", d)


def universe(d: int) -> Solid:
    """All of a space of d dimensions: the neutral element of intersection.

    >>> import rayweave.space as rs
    >>> rs.universe(4).contains([0, 0, 0, 0])
    array([ True])
    """
    return _shape("universe", d)


def half_space(axis: int, d: int, *, offset: float = 0.0) -> Solid:
    """The points whose coordinate along an axis, from 0 to d - 1, is less than `offset`.

    >>> import rayweave.space as rs
    >>> rs.half_space(0, 2, offset=1).contains([[0, 0], [2, 0]])
    array([ True, False])
    """
    normal = np.zeros(_whole(d, "d"))
    if not 0 <= _whole(axis, "axis") < d:
        raise RayweaveError(
            f"axis {axis} is out of range: R^{d} has the axes 0 to {d - 1}. Did you count from 1?"
        )
    normal[axis] = 1.0
    return half_space_below(normal, offset)


def half_space_below(normal: ArrayLike, offset: float) -> Solid:
    """The points p with normal . p < offset. The normal (d,) may have any length but 0.

    >>> import rayweave.space as rs
    >>> rs.half_space_below([1, 1], 1).contains([[0, 0], [1, 1]])
    array([ True, False])
    """
    normal = _vector(normal, "normal")
    return _shape("half_space", len(normal), (), [*normal, offset])


def slab(axis: int, lo: float, hi: float, d: int) -> Solid:
    """The points with lo < x < hi, x the coordinate along an axis; lo < hi.

    >>> import rayweave.space as rs
    >>> rs.slab(1, -1, 1, d=3).contains([[5, 0, 5], [0, 2, 0]])
    array([ True, False])
    """
    return _shape("slab", d, [("axis", axis)], [lo, hi])


def box(lo: ArrayLike, hi: ArrayLike) -> Solid:
    """The box between two opposite corners (d,), the first less than the second in every coordinate.

    >>> import rayweave.space as rs
    >>> rs.box([0, 0], [2, 1]).contains([[1, 0.5], [1, 2]])
    array([ True, False])
    """
    lo, hi = _vector(lo, "lo"), _vector(hi, "hi")
    if len(lo) != len(hi):
        raise RayweaveError(f"lo has {len(lo)} numbers and hi has {len(hi)}: they must have the same length.")
    return _shape("box", len(lo), (), [*lo, *hi])


def quadric(n: int, m: int, bias: float, d: int | None = None) -> Solid:
    """The points where the sum of the first m squared coordinates minus that of the next n - m, plus bias, is less than
    0.

    0 <= m <= n <= d; the other d - n coordinates are free; d is n unless it is given. n = m = d is a ball of radius
    sqrt(-bias), n = m < d a cylinder, m < n with bias 0 a cone, with bias < 0 a hyperboloid of one sheet if m > 1, with
    bias > 0 of two.

    >>> import rayweave.space as rs
    >>> rs.quadric(3, 2, -1).contains([[0.5, 0.5, 0], [2, 0, 0]])
    array([ True, False])
    """
    return _shape("quadric", n if d is None else d, [("n", n), ("m", m)], [bias])


def cylinder(m: int, radius: float, d: int) -> Solid:
    """The points whose first m coordinates (1 <= m <= d) are in a ball of this radius (> 0), unbounded in the others.

    m = 2, d = 3 is the ordinary cylinder along z; m = 3, d = 4 is a ball at rest in space-time.

    >>> import rayweave.space as rs
    >>> rs.cylinder(2, 1, d=3).contains([[0.5, 0.5, 9], [1, 1, 0]])
    array([ True, False])
    """
    return _shape("cylinder", d, [("m", m)], [radius])


def cone(m: int, slope: float, d: int) -> Solid:
    """The double cone with its apex at the origin: the length of the first m coordinates is less than slope times that
    of the others.

    1 <= m < d, slope > 0. m = d - 1 is a cone about the last axis; with time last and slope c it is the light cone of
    the origin.

    >>> import rayweave.space as rs
    >>> rs.cone(2, 1, d=3).contains([[0.5, 0, 1], [0.5, 0, 0.2]])
    array([ True, False])
    """
    return _shape("cone", d, [("m", m)], [slope])


def ball(radius: float, d: int) -> Solid:
    """The points nearer to the origin than radius (> 0).

    >>> import rayweave.space as rs
    >>> rs.ball(2, d=4).contains([[1, 1, 1, 0.5], [1, 1, 1, 2]])
    array([ True, False])
    """
    return _shape("ball", d, (), [radius])


def prism(points: ArrayLike, d: int) -> Solid:
    """The points whose first two coordinates lie in a simple polygon, convex or not, unbounded in the others.

    The order of `points` (N, 2) may be clockwise or counter-clockwise. The face of the edge from point k to the next is
    named ``edge`` k. For holes and several contours see `rayweave.from_polygons`.

    >>> import rayweave.space as rs
    >>> rs.prism([[0, 0], [2, 0], [0, 2]], d=3).contains([[0.5, 0.5, 7], [2, 2, 0]])
    array([ True, False])
    """
    array = np.asarray(points)
    if array.ndim != 2 or array.shape[1] != 2:
        raise RayweaveError(f"points has shape {array.shape}: it must be (N, 2).")
    return _shape("prism", d, (), _vector(array.ravel(), "points"))


def union(solids: Iterable[Solid]) -> Solid:
    """The union of solids: at least one, all of the same dimension.

    >>> import rayweave.space as rs
    >>> rs.union([rs.ball(1, d=2), rs.box([0, 0], [2, 2])]).contains([[1.5, 1.5], [-1.5, 0]])
    array([ True, False])
    """
    return _core.space_join("union", solids)


def intersection(solids: Iterable[Solid]) -> Solid:
    """The intersection of solids: at least one, all of the same dimension.

    >>> import rayweave.space as rs
    >>> rs.intersection([rs.ball(1, d=2), rs.box([0, 0], [2, 2])]).contains([[0.5, 0.5], [-0.5, 0]])
    array([ True, False])
    """
    return _core.space_join("intersection", solids)


def trace(p: ArrayLike, q: ArrayLike, solid: Solid) -> RootRay:
    """The root-ray of the line through two points (d,), over all t: 0 at p, 1 at q.

    Raises `RayweaveError` if p and q are the same point, or for a coordinate that is not finite. For faces, points and
    normals, and for many lines at once, see `Solid.crossings`.

    >>> import rayweave.space as rs
    >>> rs.trace([-2, 0], [-1, 0], rs.ball(1, d=2))
    RootRay(+1, [1.0, 3.0])
    """
    return _core.space_trace(p, q, solid)


def trace_along(curve: Trajectory, solid: Solid, t_min: float, t_max: float) -> RootRay:
    """The root-ray of a curve strictly between two finite times; its start is the side just after t_min.

    Raises `RayweaveError` for a window that is not finite, empty or beyond the curve's domain, for a curve of a
    different dimension, and for one that violates its bound (see `Trajectory`). For faces, points and normals, and for
    many curves at once, see `Solid.crossings_along`.

    >>> import rayweave.space as rs
    >>> arc = rs.Arc([0, 0], [[2, 0], [0, 2]])
    >>> ray = rs.trace_along(arc, rs.half_space(0, 2), 0, 360)
    >>> [round(t, 6) for t in ray.roots]
    [90.0, 270.0]
    """
    return _core.space_trace_along(curve, solid, t_min, t_max)


def _shape(call: str, d: int, counts: Iterable[tuple[str, int]] = (), numbers: Iterable[float] = ()) -> Solid:
    return _core.space_shape(call, d, list(counts), list(numbers))


def _whole(number: int, name: str) -> int:
    if isinstance(number, bool) or not isinstance(number, (int, np.integer)):
        raise TypeError(f"{name} is {type(number)}: it must be a whole number.")
    if name == "d" and number not in (2, 3, 4):
        raise RayweaveError(f"the dimension is {number}: spaces of 2, 3 and 4 dimensions are supported.")
    return int(number)


def _vector(values: ArrayLike, name: str) -> list[float]:
    return _core.number_list(values, name)


def _restore(name: str, maker: str | None, arguments: tuple[Any, ...]) -> Curve:
    """A curve from its pickled form."""
    if name not in ("Arc", "Helix", "Line", "Parabola", "Spline") or maker not in (
        None,
        "about",
        "with_frequency",
    ):
        raise RayweaveError("the pickled object is not a curve: it comes from a different version.")
    made = globals()[name]
    curve: Curve = (made if maker is None else getattr(made, maker))(*arguments)
    return curve
