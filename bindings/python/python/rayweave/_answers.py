"""Results that consist of several arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from rayweave._core import RayweaveError
from rayweave._table import Table


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Crossings(Table):
    """Crossings of rays with the surface of a solid: M rows, sorted by ray, then t.

    The rows of ray i are ``offsets[i]:offsets[i + 1]``. The result of `nearest` has one row for every ray. The rays of a grid
    (..., 3) are numbered in row-major order, so that ``t.reshape(grid)`` has the shape of the grid.

    Columns are attributes, and entries of a table:

    >>> import rayweave as rw
    >>> found = rw.box(2).named("die").crossings([-3, 0, 0], [1, 0, 0])
    >>> found.t
    array([2., 4.])
    >>> found[0]["surface"], found["enters"].tolist()
    ('die.x-', [True, False])
    >>> found.to_pandas()[["t", "point_x"]]
         t  point_x
    0  2.0     -1.0
    1  4.0      1.0
    """

    _columns: ClassVar[tuple[str, ...]] = (
        "ray", "t", "point", "normal", "enters", "surface", "leaf", "placement", "occurrence",
    )  # fmt: skip
    _names: ClassVar[Mapping[str, str]] = {"surface": "surface_names"}

    ray: NDArray[np.int64]
    """(M,) the number of the ray."""
    t: NDArray[np.float64]
    """(M,) the time t, in units of the ray's direction; inf for a miss."""
    point: NDArray[np.float64]
    """(M, 3) the point; NaN for a miss."""
    normal: NDArray[np.float64]
    """(M, 3) the unit normal, pointing out of the solid: against the ray where it enters. NaN for a miss."""
    enters: NDArray[np.bool_]
    """(M,) True where the ray enters the solid, False where it leaves."""
    surface: NDArray[np.int32]
    """(M,) the face that is crossed, as an index of `surface_names`; -1 for a miss."""
    leaf: NDArray[np.int32]
    """(M,) the shape that the face belongs to, in the order of declaration; -1 for a miss."""
    placement: NDArray[np.int32]
    """(M,) the number of the placement of that shape; 0 for shapes that are not placed, -1 for a miss."""
    occurrence: NDArray[np.int64]
    """(M,) `leaf` and `placement` in one number, which `occurrence_paths` turns into a path of names; -1 for a miss."""
    offsets: NDArray[np.int64]
    """(N + 1,) the first row of each ray, followed by the total number of rows."""
    start_inside: NDArray[np.bool_]
    """(N,) whether the ray is inside just after t_min."""
    surface_names: tuple[str, ...]
    """The names of all faces: the name of the solid, the shape, and its face. Two shapes of one kind without names of their own,
    such as a sphere with a spherical cavity, have the same names of faces: name the shapes with `Solid.named`, or distinguish them
    by `leaf`."""

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Computes derived arrays on first access, because most are never used."""
            make = _MADE.get(name)
            if make is None or "_leaves" not in self.__dict__:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            return self.__dict__.setdefault(name, make(self))

        def __dir__(self) -> list[str]:
            """All fields, also those that are not computed yet."""
            return sorted({*super().__dir__(), *_MADE})

    def __len__(self) -> int:
        """The number of rows, M."""
        return len(self.t)

    def _heading(self) -> str:
        rows, rays = len(self), len(self.start_inside)
        return f"{type(self).__name__}: {rows} row{'s' * (rows != 1)} of {rays} ray{'s' * (rays != 1)}"

    def _texts(self, most: int) -> tuple[list[str], list[list[str]]]:
        names, rows = super()._texts(most)
        shown = [k for k, name in enumerate(names) if name not in ("leaf", "placement", "occurrence")]
        return [names[k] for k in shown], [[row[k] for k in shown] for row in rows]


def _ray(rows: Crossings) -> NDArray[np.int64]:
    rays = np.arange(len(rows.start_inside), dtype=np.int64)
    return np.repeat(rays, np.diff(rows.offsets)) if "offsets" in rows.__dict__ else rays


def _occurrence(rows: Crossings) -> NDArray[np.int64]:
    occurrence = rows.placement.astype(np.int64) << 32 | rows.leaf
    return np.where(rows.surface < 0, np.int64(-1), occurrence)


# `_leaves` has the leaf of each face, and -1 at the end for face -1
_MADE: dict[str, Callable[[Any], NDArray[Any]]] = {
    "ray": _ray,
    "offsets": lambda rows: np.arange(len(rows.start_inside) + 1, dtype=np.int64),
    "leaf": lambda rows: rows.__dict__["_leaves"][rows.surface],
    "placement": lambda rows: np.minimum(rows.surface, np.int32(0)),
    "occurrence": _occurrence,
}


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class ModelCrossings(Crossings):
    """Crossings at which the medium changes: like `Crossings`, with media and regions.

    ``enters`` is True if the medium after the crossing is not that of the world. Where neither medium is that of the world, the
    normal points against the ray. Where two regions of one medium touch or overlap, there is no crossing, so that the region after a
    row may differ from the region before the next one; with ``by="region"`` there is one.

    >>> import rayweave as rw
    >>> model = rw.Model({"shell": rw.sphere(2), "core": rw.sphere(1)})
    >>> [row["region_after"] for row in model.crossings([-3, 0, 0], [1, 0, 0])]
    ['shell', 'core', 'shell', 'world']
    """

    _columns: ClassVar[tuple[str, ...]] = (
        "ray", "t", "point", "medium_before", "medium_after", "region_before", "region_after", "surface",
        "normal", "enters", "leaf", "placement", "occurrence",
    )  # fmt: skip
    _names: ClassVar[Mapping[str, str]] = {
        "surface": "surface_names",
        "medium_before": "medium_names",
        "medium_after": "medium_names",
        "region_before": "region_names",
        "region_after": "region_names",
    }

    medium_before: NDArray[np.int32]
    """(M,) the medium before the crossing, as an index of `medium_names`; 0 is that of the world."""
    medium_after: NDArray[np.int32]
    """(M,) the medium after it."""
    region_before: NDArray[np.int32]
    """(M,) the region before the crossing, as an index of `region_names`; 0 is the world."""
    region_after: NDArray[np.int32]
    """(M,) the region after it."""
    medium_names: tuple[str, ...]
    """The names of the media."""
    region_names: tuple[str, ...]
    """The names of the regions, beginning with the world."""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Partition(Table):
    """The partition of rays by medium: S pieces, each in one medium, sorted by ray, then t.

    The pieces of ray i are ``offsets[i]:offsets[i + 1]``. They cover the requested window without gaps: the first
    begins at t_min, the last ends at t_max, which may be infinite. A piece in several regions of one medium has the first of
    them as its region; with ``by="region"`` each piece is in one region.

    >>> import rayweave as rw
    >>> pieces = rw.Model({"shell": rw.sphere(2), "core": rw.sphere(1)}).partition([-3, 0, 0], [1, 0, 0], 0)
    >>> [(piece["medium"], piece["t_end"] - piece["t_start"]) for piece in pieces][1:3]
    [('shell', 1.0), ('core', 2.0)]
    """

    _columns: ClassVar[tuple[str, ...]] = ("ray", "t_start", "t_end", "medium", "region")
    _names: ClassVar[Mapping[str, str]] = {"medium": "medium_names", "region": "region_names"}

    ray: NDArray[np.int64]
    """(S,) the number of the ray."""
    t_start: NDArray[np.float64]
    """(S,) where the piece begins, in units of the ray's direction."""
    t_end: NDArray[np.float64]
    """(S,) where it ends."""
    medium: NDArray[np.int32]
    """(S,) the medium, as an index of `medium_names`; 0 is that of the world."""
    region: NDArray[np.int32]
    """(S,) the region, as an index of `region_names`; 0 is the world."""
    offsets: NDArray[np.int64]
    """(N + 1,) the first piece of each ray, followed by the total number of pieces."""
    medium_names: tuple[str, ...]
    """The names of the media."""
    region_names: tuple[str, ...]
    """The names of the regions, beginning with the world."""
    by: Literal["medium", "region"]
    """Whether each piece is in one medium or in one region."""

    def __len__(self) -> int:
        """The number of pieces, S."""
        return len(self.t_start)

    def path_lengths(self, by: Literal["medium", "region"] = "medium") -> NDArray[np.float64]:
        """The total length of each ray in each medium, in units of the ray's direction: float64 (N, M), in the order of
        `medium_names`; inf in an unbounded one, usually the world, which is column 0. With directions `end - origin` and t
        from 0 to 1, multiply the rows by the lengths of the directions. With `by="region"` the columns are those of
        `region_names`; this needs a partition by region.

        >>> import rayweave as rw
        >>> pieces = rw.Model({"shell": rw.sphere(2), "core": rw.sphere(1)}).partition([-3, 0, 0], [1, 0, 0], 0, 6)
        >>> pieces.medium_names, pieces.path_lengths()
        (('world', 'shell', 'core'), array([[2., 2., 2.]]))
        """
        columns = {"medium": (self.medium, self.medium_names), "region": (self.region, self.region_names)}
        if by not in columns:
            raise RayweaveError(f"by is {by!r}: it must be 'medium' or 'region'.")
        if by == "region" and self.by == "medium":
            raise RayweaveError(
                "this partition has no lengths by region: regions of one medium that touch or overlap share a piece. Call "
                "partition(..., by='region')."
            )
        number, names = columns[by]
        rays, width = len(self.offsets) - 1, len(names)
        sums = np.bincount(self.ray * width + number, self.t_end - self.t_start, rays * width)
        return np.asarray(sums, dtype=np.float64).reshape(rays, width)

    def _heading(self) -> str:
        return f"Partition: {len(self)} pieces of {len(self.offsets) - 1} rays"
