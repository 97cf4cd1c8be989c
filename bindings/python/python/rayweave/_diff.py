"""Comparison of two models."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._box import Box, corners
from rayweave._core import Section
from rayweave._model import Subject
from rayweave._progress import Progress, callback
from rayweave._table import Table
from rayweave._whole import whole
from rayweave._words import suggesting

_Array = NDArray[np.float64]
_Truths = NDArray[np.bool_]


@dataclass(frozen=True, eq=False, repr=False)
class DiffPlaces(Table):
    """The M connected places where two models differ by more than `distance`, part by part, the largest volume first.

    A part with so many places that rays cannot tell which are connected has none here.

    >>> import rayweave as rw
    >>> plate = rw.box([10, 10, 1])
    >>> places = rw.diff(plate, plate - rw.cylinder(1, 2).translate([3, 0, 0]) - rw.box([2, 1, 4]), cells=32).places
    >>> places.is_a.tolist(), places.volume.round().tolist()
    ([True, True], [3.0, 2.0])
    >>> places.extent.round(2).tolist()
    [[2.0, 2.0, 1.0], [2.0, 1.0, 1.0]]
    """

    _columns: ClassVar[tuple[str, ...]] = ("part", "is_a", "volume", "centre", "extent")

    part: NDArray[Any]
    """(M,) the name of the part: one of `Diff.names`."""
    is_a: _Truths
    """(M,) whether the place belongs to the first model, otherwise to the second."""
    volume: _Array
    """(M,) estimates of the volumes from a grid of rays."""
    centre: _Array
    """(M, 3) estimates of the centres of volume."""
    bounds: _Array
    """(M, 2, 3) the corners of boxes around the parts of rays in the places."""

    @property
    def extent(self) -> _Array:
        """(M, 3) the sizes of these boxes."""
        size: _Array = self.bounds[:, 1] - self.bounds[:, 0]
        return size


@dataclass(frozen=True, eq=False, repr=False)
class Diff(Table):
    """The common and the different parts of two models; a notebook shows the thickest difference in section.

    P regions, media or whole models are compared. Lengths are in the unit of the first model. `x_half_width` is half
    the width of the confidence interval of `x`.

    >>> import rayweave as rw
    >>> found = rw.diff(rw.box(2), rw.box([2, 2, 2.5]), cells=16)
    >>> found.is_same, found.thickness.round(3).tolist()
    (False, [0.25])
    """

    _columns: ClassVar[tuple[str, ...]] = (
        "names", "same", "proved", "in_a", "in_b", "both", "both_half_width", "a_only", "a_only_half_width", "b_only",
        "b_only_half_width", "thickness", "is_a",
    )  # fmt: skip

    is_same: bool
    """True if no difference thicker than `distance` was found."""
    names: tuple[str, ...]
    """The names of the regions or media that were compared; "model" for everything."""
    same: _Truths
    """(P,) whether no difference thicker than `distance` was found in the part."""
    proved: _Truths
    """(P,) whether `same` is proved without rays."""
    in_a: _Truths
    """(P,) whether the first model has a part of this name."""
    in_b: _Truths
    """(P,) whether the second model has a part of this name."""
    both: _Array
    """(P,) volumes common to both models."""
    both_half_width: _Array
    a_only: _Array
    """(P,) volumes that belong to the first model only."""
    a_only_half_width: _Array
    b_only: _Array
    """(P,) volumes that belong to the second model only."""
    b_only_half_width: _Array
    thickness: _Array
    """(P,) the thickness of the thickest difference found, 0 if there is none."""
    is_a: _Truths
    """(P,) whether the thickest difference belongs to the first model."""
    ray: _Array
    """(P, 2, 3) the ends of the piece of a ray in the thickest difference; NaN if there is none."""
    place: _Array
    """(P, 2, 3) the corners of a box around all differences thicker than `distance`; NaN if there are none."""
    distance: float
    """Differences up to this thickness are ignored."""
    unit: str
    rays: int
    """The number of rays that were traced."""
    section: Section
    """A section through the part with the thickest difference: "both", "A only", "B only"."""
    places: DiffPlaces
    """The connected places of the differences."""

    def _column(self, name: str) -> NDArray[Any]:
        column = getattr(self, name)
        return np.array(column, dtype=object) if isinstance(column, tuple) else np.asarray(column)

    def __repr__(self) -> str:
        if self.is_same:
            return f"<Diff: the same, no difference thicker than {self.distance:.3g} {self.unit} ({self.rays} rays)>"
        rows = zip(self.names, self.same, self.a_only, self.b_only, self.thickness, strict=True)
        parts = [
            f"{name}: A only {a:.4g}, B only {b:.4g}, up to {thick:.3g} {self.unit} thick"
            for name, same, a, b, thick in rows
            if not same
        ]
        return f"<Diff: different in {len(parts)} of {len(self.names)} parts; {'; '.join(parts[:8])}>"

    def _repr_svg_(self) -> str:
        return _core.section_text([self.section], "svg", "A only, B only, both")


@suggesting(tolerance="distance")
def diff(
    a: Subject,
    b: Subject,
    *,
    by: Literal["region", "medium", "whole"] | None = None,
    distance: float | None = None,
    cells: int = 128,
    precision: float = 1e-2,
    confidence: float = 0.99,
    most_rays: int | None = None,
    within: Box | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress = None,
) -> Diff:
    """Compare two models: whether they are the same solid and, if not, where and by how much they differ.

    Lengths of the second model are converted to the unit of the first. `by` compares regions by name, media by name, or
    the whole models; by default whole models if one of them has a single region, otherwise regions. Differences up to
    `distance` (default: 1e-9 of the diagonal) are ignored. Each part is tested with 6 `cells`^2 rays; volumes are
    measured until half the width of their interval is `precision` times the volume, with at most `most_rays` rays
    (default: 2^20, or fewer if all would reach more than 2^23 shapes). Equal seeds give equal results. `progress=True` shows
    the progress on standard error; a function is called with the finished thousandths and 1000.

    >>> import rayweave as rw
    >>> rw.diff(rw.box(2), rw.box([2, 2, 2]), cells=16).is_same
    True
    >>> rw.diff(rw.box(2), rw.sphere(1), cells=16).is_same
    False
    """
    names, truths, numbers, (is_same, unit, limit, rays), section, (owner, in_first, sizes) = _core.diff_columns(
        a,
        b,
        by,
        distance,
        whole(cells, "cells", bits=32),
        precision,
        confidence,
        None if most_rays is None else whole(most_rays, "most_rays", least=1),
        corners(within),
        whole(seed, "seed"),
        threads,
        callback(progress),
    )
    same, proved, in_a, in_b, is_a = truths
    count = len(names)
    volumes = [np.ascontiguousarray(numbers[:, k]) for k in range(6)]
    return Diff(
        is_same,
        tuple(names),
        same,
        proved,
        in_a,
        in_b,
        volumes[0],
        volumes[3],
        volumes[1],
        volumes[4],
        volumes[2],
        volumes[5],
        np.ascontiguousarray(numbers[:, 6]),
        is_a,
        numbers[:, 7:13].reshape(count, 2, 3),
        numbers[:, 13:19].reshape(count, 2, 3),
        limit,
        unit,
        rays,
        section,
        DiffPlaces(
            np.array(names, dtype=object)[owner],
            in_first,
            np.ascontiguousarray(sizes[:, 0]),
            np.ascontiguousarray(sizes[:, 1:4]),
            np.ascontiguousarray(sizes[:, 4:]).reshape(len(sizes), 2, 3),
        ),
    )
