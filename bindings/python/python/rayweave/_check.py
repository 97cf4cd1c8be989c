"""Probable faults of a model."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._box import Box, corners
from rayweave._core import Section
from rayweave._model import Subject
from rayweave._progress import Progress, callback
from rayweave._table import Rows, Tabular
from rayweave._whole import whole
from rayweave._words import suggesting

_Array = NDArray[np.float64]

CheckRow: TypeAlias = tuple[
    tuple[str, list[str], str, list[str]],
    list[float],
    list[float] | None,
    list[list[float]] | None,
    bool,
    "Section | None",
]
"""Kind, regions, text, faces; size, volume with its half width, area; place; ray; whether it is proved; picture."""


@dataclass(frozen=True, eq=False)
class Finding:
    """A probable fault. Lengths are in the unit of the model; unknown numbers are NaN.

    >>> import rayweave as rw
    >>> found = rw.check({"a": rw.box(2), "b": rw.box(2).translate([1.5, 0, 0])}, cells=16)
    >>> found[0].kind, found[0].regions
    ('overlap', ('a', 'b'))
    """

    kind: str
    """overlap, outside, hidden, empty, absorbed, mesh, thin, gap, loose, cavity or touch."""
    regions: tuple[str, ...]
    """The regions involved."""
    text: str
    """The finding in words, such as ``wall is thin``."""
    size: float
    """The depth of an overlap, the thickness of a wall or the width of a gap."""
    volume: float
    """The volume of an overlap, or of the part of a daughter outside its mother."""
    volume_half_width: float
    """Half the width of the confidence interval of `volume`."""
    area: float
    """The area where regions touch."""
    at: _Array
    """(3,) a point at the fault."""
    ray: _Array
    """(2, 3) the ends of a piece of a ray that shows it."""
    faces: tuple[str, ...]
    """The faces at both ends of a wall or gap, such as ``plate.top`` and ``bore.side``."""
    is_proved: bool
    """True if it is proved without rays."""
    section: Section | None = field(repr=False)
    """A section through the fault, if pictures were requested."""

    def _repr_svg_(self) -> str | None:
        return None if self.section is None else _core.section_text([self.section], "svg", self.text)


_COLUMNS = ("kind", "regions", "text", "size", "volume", "area", "at", "faces", "is_proved")


@dataclass(frozen=True, eq=False)
class Check(Tabular):
    """The findings and the scope of a check.

    >>> import rayweave as rw
    >>> found = rw.check({"a": rw.box(2), "b": rw.box(2).translate([1.5, 0, 0])}, cells=16)
    >>> len(found), [finding.kind for finding in found]
    (1, ['overlap'])
    >>> found.to_pandas()[["kind", "regions"]]
          kind regions
    0  overlap    a, b
    """

    findings: tuple[Finding, ...]
    unit: str
    scope: dict[str, float]
    """Numbers of rays, of their chords in regions, and of pairs, and the lengths below which walls and gaps are reported.
    `cells` and `cells_in_regions` are the cells along an edge of the model and of the box of each region: fewer than
    requested where the mean number of shapes that a ray reaches, `reached`, exceeds 32."""

    def of(self, kind: str) -> tuple[Finding, ...]:
        """The findings of a kind."""
        return tuple(finding for finding in self.findings if finding.kind == kind)

    def __len__(self) -> int:
        return len(self.findings)

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.findings)

    @overload
    def __getitem__(self, key: int) -> Finding: ...
    @overload
    def __getitem__(self, key: slice) -> tuple[Finding, ...]: ...
    def __getitem__(self, key: int | slice) -> Finding | tuple[Finding, ...]:
        return self.findings[key]

    def _rows(self) -> Rows:
        rows = {name: [getattr(finding, name) for finding in self.findings] for name in _COLUMNS}
        columns = {
            "kind": np.array(rows["kind"], dtype=object),
            "regions": np.array([", ".join(names) for names in rows["regions"]], dtype=object),
            "text": np.array(rows["text"], dtype=object),
            **{name: np.array(rows[name], dtype=np.float64) for name in ("size", "volume", "area")},
            "at": np.array(rows["at"], dtype=np.float64).reshape(-1, 3),
            "faces": np.array([", ".join(names) for names in rows["faces"]], dtype=object),
            "is_proved": np.array(rows["is_proved"], dtype=np.bool_),
        }
        return Rows(columns, {})

    def __repr__(self) -> str:
        counts = Counter(finding.kind for finding in self.findings)
        found = ", ".join(f"{kind} {count}" for kind, count in counts.items()) or "nothing found"
        lines = [f"<Check: {found}: {self.scope['rays']:.0f} rays."]
        for finding in self.findings[:20]:
            size = "" if np.isnan(finding.size) else f" ({finding.size:.3g} {self.unit})"
            lines.append(f"  {finding.kind}: {finding.text}{size}")
        if len(self.findings) > 20:
            lines.append(f"  and {len(self.findings) - 20} more")
        return "\n".join(lines) + ">"


@suggesting(thickness="wall", min_wall="wall", min_gap="gap", tolerance="distance")
def check(
    subject: Subject,
    *,
    wall: float | None = None,
    gap: float | None = None,
    distance: float | None = None,
    cells: int = 128,
    confidence: float = 0.99,
    most_pairs: int = 10_000,
    within: Box | None = None,
    seed: int = 0,
    pictures: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Check:
    """Look for overlaps, daughters outside their mothers, gaps, thin walls, and parts without effect.

    Bounding boxes prove what they can; 6 `cells`^2 rays through the model examine the rest. Each finding is certain, but faults
    between the rays may be missed. Equal seeds give equal results.

    Parameters
    ----------
    wall
        Walls thinner than this length are reported. The thickness of a wall is the diameter of a ball between its faces.
    gap
        Gaps narrower than this length are reported; 1e-5 of the diagonal of the model.
    distance
        Overlaps deeper than this length are reported; 1e-9 of the diagonal of the model.
    cells
        Cells along each edge of a cross-section of the model, one ray for each cell; fewer where a ray reaches more than 32 shapes
        on average.
    confidence
        The confidence level of volumes.
    most_pairs
        The maximum number of pairs of parts, and of operands, to examine.
    within
        (2, 3) the corners of a box: only the part of the model within it is examined.
    pictures
        Whether each finding has a `section`.
    progress
        True shows the progress on standard error; a function is called with the rays of the finished searches and of all planned searches.

    Examples
    --------
    >>> import rayweave as rw
    >>> print(rw.check({"wall": rw.box([4, 4, 0.01])}, wall=0.1, cells=16)[0].text)
    wall is thin
    """
    rows, unit, scope = _core.check_rows(
        subject,
        wall,
        gap,
        distance,
        whole(cells, "cells", bits=32),
        confidence,
        whole(most_pairs, "most_pairs"),
        corners(within),
        whole(seed, "seed"),
        pictures,
        threads,
        callback(progress),
    )
    return Check(tuple(_finding(row) for row in rows), unit, scope)


def _finding(row: CheckRow) -> Finding:
    (kind, regions, text, faces), (size, volume, half_width, area), at, ray, is_proved, section = row
    place = np.full(3, np.nan) if at is None else np.array(at)
    piece = np.full((2, 3), np.nan) if ray is None else np.array(ray)
    return Finding(
        kind, tuple(regions), text, size, volume, half_width, area, place, piece, tuple(faces), is_proved, section
    )
