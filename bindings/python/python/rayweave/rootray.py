"""The boolean algebra of solids along one ray: the functions of J. Stolfi's module *rootray* (2021), under its names.

A root-ray is the side of a solid on which a trajectory starts and the times at which it crosses the boundary. These functions
take `RootRay` objects or that module's pairs ``(s, T)``: ``s`` is +1 if the trajectory starts in the exterior and -1 if
it starts in the interior, ``T`` is a list of strictly increasing finite times. The result is a pair if all operands are
pairs, and a `RootRay` otherwise.

As in that module, the functions that combine or cut root-rays drop pieces shorter than `min_sep`. The operators
``| & - ^ ~`` of `RootRay` are exact.

>>> union((+1, [1.0, 2.0]), (+1, [2.0, 3.0]))
(1, [1.0, 3.0])
>>> RootRay(+1, [1.0, 3.0]) - RootRay("inside", [2.0])
RootRay(+1, [2.0, 3.0])
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeAlias, overload

from rayweave import _core
from rayweave._core import RootRay

__all__ = [
    "RootRay",
    "clip_time",
    "complement",
    "difference",
    "intersection",
    "min_sep",
    "plenum",
    "surface_count",
    "symmetric_difference",
    "union",
    "vacuum",
    "validate",
]

Pair: TypeAlias = tuple[int, Sequence[float]]
"""A root-ray as the module *rootray* writes it."""
NewPair: TypeAlias = tuple[int, list[float]]
"""A pair as these functions return it."""


def vacuum() -> RootRay:
    """The trajectory that is always outside, ``(+1, [])``: neutral for `union`, absorbing for `intersection`.

    >>> from rayweave import rootray
    >>> rootray.vacuum()
    RootRay(+1, [])
    """
    return RootRay(+1, [])


def plenum() -> RootRay:
    """The trajectory that is always inside, ``(-1, [])``: neutral for `intersection`, absorbing for `union`.

    >>> from rayweave import rootray
    >>> rootray.plenum()
    RootRay(-1, [])
    """
    return RootRay(-1, [])


@overload
def complement(f: RootRay) -> RootRay: ...
@overload
def complement(f: Pair) -> NewPair: ...
def complement(f: RootRay | Pair) -> RootRay | NewPair:
    """The root-ray of the complement: the same times, the opposite start side. Exact.

    >>> from rayweave import rootray
    >>> rootray.complement(rootray.RootRay("outside", [1, 3]))
    RootRay(-1, [1.0, 3.0])
    """
    return _like(~_root_ray(f, "f"), f)


@overload
def union(f1: RootRay, f2: RootRay | Pair) -> RootRay: ...
@overload
def union(f1: Pair, f2: RootRay) -> RootRay: ...
@overload
def union(f1: Pair, f2: Pair) -> NewPair: ...
def union(f1: RootRay | Pair, f2: RootRay | Pair) -> RootRay | NewPair:
    """The root-ray of the union; a very thin gap between the two disappears.

    >>> from rayweave import rootray
    >>> a, b = rootray.RootRay("outside", [1, 3]), rootray.RootRay("outside", [2, 4])
    >>> rootray.union(a, b)
    RootRay(+1, [1.0, 4.0])
    """
    return _combine(RootRay.__or__, f1, f2)


@overload
def intersection(f1: RootRay, f2: RootRay | Pair) -> RootRay: ...
@overload
def intersection(f1: Pair, f2: RootRay) -> RootRay: ...
@overload
def intersection(f1: Pair, f2: Pair) -> NewPair: ...
def intersection(f1: RootRay | Pair, f2: RootRay | Pair) -> RootRay | NewPair:
    """The root-ray of the intersection; a very thin layer where the two barely overlap disappears.

    >>> from rayweave import rootray
    >>> a, b = rootray.RootRay("outside", [1, 3]), rootray.RootRay("outside", [2, 4])
    >>> rootray.intersection(a, b)
    RootRay(+1, [2.0, 3.0])
    """
    return _combine(RootRay.__and__, f1, f2)


@overload
def difference(f1: RootRay, f2: RootRay | Pair) -> RootRay: ...
@overload
def difference(f1: Pair, f2: RootRay) -> RootRay: ...
@overload
def difference(f1: Pair, f2: Pair) -> NewPair: ...
def difference(f1: RootRay | Pair, f2: RootRay | Pair) -> RootRay | NewPair:
    """The root-ray of `f1` without `f2`; a very thin layer that is left over disappears.

    >>> from rayweave import rootray
    >>> a, b = rootray.RootRay("outside", [1, 4]), rootray.RootRay("outside", [2, 3])
    >>> rootray.difference(a, b)
    RootRay(+1, [1.0, 2.0, 3.0, 4.0])
    """
    return _combine(RootRay.__sub__, f1, f2)


@overload
def symmetric_difference(f1: RootRay, f2: RootRay | Pair) -> RootRay: ...
@overload
def symmetric_difference(f1: Pair, f2: RootRay) -> RootRay: ...
@overload
def symmetric_difference(f1: Pair, f2: Pair) -> NewPair: ...
def symmetric_difference(f1: RootRay | Pair, f2: RootRay | Pair) -> RootRay | NewPair:
    """The root-ray of the points in exactly one of the two, without very thin pieces.

    >>> from rayweave import rootray
    >>> a, b = rootray.RootRay("outside", [1, 3]), rootray.RootRay("outside", [2, 4])
    >>> rootray.symmetric_difference(a, b)
    RootRay(+1, [1.0, 2.0, 3.0, 4.0])
    """
    return _combine(RootRay.__xor__, f1, f2)


def min_sep(t1: float, t2: float) -> float:
    """The minimum separation of two distinct finite root times: symmetric, monotonic in ``abs(t1)`` and ``abs(t2)``.

    >>> from rayweave import rootray
    >>> 0 < rootray.min_sep(1.0, 2.0) < 1e-12
    True
    """
    return _core.min_sep(t1, t2)


@overload
def clip_time(f: RootRay, tmin: float, tmax: float) -> RootRay: ...
@overload
def clip_time(f: Pair, tmin: float, tmax: float) -> NewPair: ...
def clip_time(f: RootRay | Pair, tmin: float, tmax: float) -> RootRay | NewPair:
    """The part of `f` with ``tmin < t < tmax``; the side just after `tmin` becomes the start. Either end may be
    infinite.

    >>> from rayweave import rootray
    >>> ray = rootray.RootRay("outside", [1, 3])
    >>> rootray.clip_time(ray, 2, 5)
    RootRay(-1, [3.0])
    """
    return _like(_root_ray(f, "f").clip(tmin, tmax).weld(), f)


def validate(f: RootRay | Pair) -> list[str]:
    """The problems of `f`: times that are NaN, infinite, not increasing, or closer than `min_sep`.

    One message for each; an empty list if there are none. A pair may contain anything; in a `RootRay`, roots can only
    be too close.

    >>> from rayweave import rootray
    >>> rootray.validate((1, [1, 2]))
    []
    >>> rootray.validate((1, [2, 1]))
    ['root 1 is 1, not greater than 2 before it']
    """
    if isinstance(f, RootRay):
        return _core.root_problems(f.roots)
    start, roots = _unpacked(f, "f")
    signs = [] if start in (1, -1) else [f"the sign {start!r} is neither +1 nor -1"]
    return signs + _core.root_problems(roots)


def surface_count(rays: Iterable[RootRay | Pair]) -> tuple[int, list[tuple[float, int]]]:
    """The number of solids around a trajectory: as t goes to -inf, and as pairs (time, number just after it) for every
    distinct time at which some solid is entered or left.

    >>> from rayweave import rootray
    >>> a, b = rootray.RootRay("outside", [1, 3]), rootray.RootRay("outside", [2, 4])
    >>> rootray.surface_count([a, b])
    (0, [(1.0, 1), (2.0, 2), (3.0, 1), (4.0, 0)])
    """
    return _core.surface_count([_root_ray(f, f"rays[{k}]") for k, f in enumerate(rays)])


def _combine(
    operator: Callable[[RootRay, RootRay], RootRay], f1: RootRay | Pair, f2: RootRay | Pair
) -> RootRay | NewPair:
    exact = operator(_root_ray(f1, "f1"), _root_ray(f2, "f2"))
    return _like(exact.weld(), f1, f2)


def _root_ray(f: RootRay | Pair, name: str) -> RootRay:
    if isinstance(f, RootRay):
        return f
    return RootRay(*_unpacked(f, name))


def _unpacked(f: RootRay | Pair, name: str) -> Pair:
    try:
        start, roots = f
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {f!r}: it must be a RootRay or a pair (+1 | -1, list of times).") from None
    return start, roots


def _like(result: RootRay, *given: RootRay | Pair) -> RootRay | NewPair:
    """The result as a pair if all arguments are pairs."""
    if any(isinstance(f, RootRay) for f in given):
        return result
    return result.start, result.roots
