"""Time lines: drawings of the times at which rays are inside solids."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._core import RootRay
from rayweave._drawing import Drawing
from rayweave._model import Subject

Row: TypeAlias = RootRay | tuple[int, Sequence[float]] | NDArray[Any] | Sequence[float]
"""A root-ray, the pair of one, or the hits of one ray."""


class Timeline(Drawing):
    """A drawing over time.

    >>> import rayweave as rw
    >>> chart = rw.ray_timeline(rw.box(2) - rw.sphere(1), [-3, 0.5, 0], [1, 0, 0])
    >>> type(chart).__name__
    'Timeline'
    >>> chart.save("timeline.svg")
    """


def timeline(
    operands: Mapping[str, Row],
    results: Mapping[str, Row] | None = None,
    *,
    title: str = "",
    window: tuple[float, float] | None = None,
    count: bool = True,
) -> Timeline:
    """Draws root-rays or hits over time: a row for each operand, their count, a row for each result.

    Parameters
    ----------
    operands, results
        Names and root-rays, pairs ``(+1 | -1, list)``, or hits of one ray: (H,) or (H, 1).
    title
        The text above the drawing.
    window
        The interval of time to draw; by default all crossings, with a margin.
    count
        Whether a row shows the number of operands that are inside.

    Examples
    --------
    >>> from rayweave import Operation, array_csg, timeline
    >>> a, b = (1, 4, 5, 10), (0, 2, 3, 5, 6, 7)
    >>> drawing = timeline({"A": a, "B": b}, {"A & B": array_csg(a, b, Operation.INTERSECT)})
    >>> drawing.save("intersection.svg")
    """
    rows = _rows(operands, "operands"), _rows(results or {}, "results")
    return Timeline(_core.timeline_svg(*rows, title, window, count))


def ray_timeline(
    subject: Subject,
    origin: ArrayLike,
    direction: ArrayLike,
    *,
    title: str = "",
    window: tuple[float, float] | None = None,
) -> Timeline:
    """Draws what happens along one ray: a row for each shape, their count, the result or the regions, the media.

    >>> import rayweave as rw
    >>> rw.ray_timeline(rw.box(2) - rw.sphere(1), [-3, 0.5, 0], [1, 0, 0]).save("timeline.svg")
    """
    return Timeline(_core.ray_timeline_svg(subject, origin, direction, title, window))


def _rows(rows: Mapping[str, Row], name: str) -> list[tuple[str, RootRay]]:
    return [(label, _root_ray(row, f"{name}['{label}']")) for label, row in rows.items()]


def _root_ray(row: Row, name: str) -> RootRay:
    if isinstance(row, RootRay):
        return row
    if isinstance(row, tuple) and len(row) == 2 and not isinstance(row[1], (int, float)):
        return RootRay(*row)
    hits = np.asarray(row)
    if hits.ndim == 2 and hits.shape[1] == 1:
        hits = hits[:, 0]
    try:
        return RootRay.from_hits(hits)
    except _core.RayweaveError as error:
        raise _core.RayweaveError(f"{name}: {error}") from None
