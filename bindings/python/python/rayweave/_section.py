"""True cross-sections of solids and models."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from rayweave import _core
from rayweave._box import Box, corners
from rayweave._core import Section
from rayweave._files import write_file
from rayweave._model import Subject
from rayweave._table import Rows
from rayweave._whole import whole
from rayweave._words import suggesting


@overload
def section(
    subject: Subject,
    plane: str = ...,
    *,
    point: ArrayLike | None = ...,
    normal: ArrayLike | None = ...,
    at: None = ...,
    by: Literal["medium", "region"] = ...,
    tolerance: float | None = ...,
    columns: int = ...,
    within: Box | None = ...,
    evaluator: str | None = ...,
    threads: int | None = ...,
) -> Section: ...
@overload
def section(
    subject: Subject,
    plane: str = ...,
    *,
    point: ArrayLike | None = ...,
    normal: ArrayLike | None = ...,
    at: ArrayLike,
    by: Literal["medium", "region"] = ...,
    tolerance: float | None = ...,
    columns: int = ...,
    within: Box | None = ...,
    evaluator: str | None = ...,
    threads: int | None = ...,
) -> list[Section]: ...
@suggesting(z='plane="z=0"', x='plane="x=0"', y='plane="y=0"', origin="point")
def section(
    subject: Subject,
    plane: str = "xy",
    *,
    point: ArrayLike | None = None,
    normal: ArrayLike | None = None,
    at: ArrayLike | None = None,
    by: Literal["medium", "region"] = "medium",
    tolerance: float | None = None,
    columns: int = 512,
    within: Box | None = None,
    evaluator: str | None = None,
    threads: int | None = None,
) -> Section | list[Section]:
    """Cut a solid or a model by a plane, or by a stack of planes: areas and contours.

    Parameters
    ----------
    plane
        "xy", "xz", "yz", or a position along an axis, such as "z=0.5". In a plane that lies in a face, the section shows the
        material on the side of larger coordinates (`Section.in_face`).
    point, normal
        Instead of `plane`: a point of the plane (the origin), and its normal, of any length.
    at
        (K,) positions of a stack of planes: coordinates along the axis of the plane, or distances from the point along
        the normal. The result is then a list with one section for each.
    by
        Whether regions of one medium are one part, or each region is a part of its own.
    tolerance
        The maximum distance of contours from the true section; 1/10000 of the larger side of the model in the plane.
    columns
        The minimum number of rays that sweep the plane, 2 to 65536: parts thinner than their spacing may be missed.
    within
        (2, 3) corners of a box: only the part of the model within it is cut.

    Examples
    --------
    >>> import rayweave as rw
    >>> cut = rw.section({"tank": rw.box(4), "ball": rw.sphere(1)}, "z=0")
    >>> cut.names, cut.areas.round(2).tolist()
    (['tank', 'ball'], [12.86, 3.14])
    >>> stack = rw.section(rw.sphere(1), "xy", at=[-0.5, 0, 0.5])
    >>> [part.areas.round(2).tolist() for part in stack]
    [[2.36], [3.14], [2.36]]
    """
    if point is not None and normal is None:
        raise _core.RayweaveError("point is given without normal: a plane needs both. Pass normal, too.")
    origin = [0.0, 0.0, 0.0] if point is None else _vector(point, "point")
    if not isinstance(plane, str):
        raise TypeError(
            f'plane is {plane!r}: it must be a text, such as "xy" or "z=0.5". For a plane through a point, pass point and normal.'
        )
    found = _core.section_list(
        subject,
        plane,
        origin,
        None if normal is None else _vector(normal, "normal"),
        None if at is None else np.asarray(at, dtype=np.float64).ravel().tolist(),
        by,
        tolerance,
        whole(columns, "columns", bits=32),
        corners(within),
        evaluator,
        threads,
    )
    return found if at is not None else found[0]


def save_section(
    sections: Section | Sequence[Section], path: str | PathLike[str], *, title: str = ""
) -> None:
    """Writes a section, or a stack of them, as a picture (.svg) or as closed polylines with arcs, and circles, with one layer per part (.dxf).

    A picture shows at most 100 planes, evenly chosen. Coordinates of a DXF file are those of the planes, in the unit of
    the model; the height is the offset of the plane.

    >>> import rayweave as rw
    >>> stack = rw.section(rw.sphere(1), "xy", at=[-0.5, 0, 0.5])
    >>> rw.save_section(stack, "slices.dxf")
    """
    ending = Path(path).suffix.lower().lstrip(".")
    if ending not in ("svg", "dxf"):
        raise _core.RayweaveError(f"{path}: unknown format: sections are written as .svg or .dxf.")
    every = [sections] if isinstance(sections, Section) else list(sections)
    write_file(path, _core.section_text(every, ending, title))


def _vector(values: ArrayLike, name: str) -> list[float]:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (3,):
        raise _core.RayweaveError(f"{name} has shape {array.shape}: it must be (3,).")
    numbers: list[float] = array.tolist()
    return numbers


def rows_of(found: Section) -> Rows:
    """The parts of a section as rows."""
    names = np.array(found.names, dtype=object)
    columns = {"name": names, "area": found.areas, "area_error": found.area_errors, "perimeter": found.perimeters}
    return Rows(columns, {})
