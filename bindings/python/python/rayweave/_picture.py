"""Pictures of solids and models."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._core import Model, Solid
from rayweave._drawing import Drawing

View: TypeAlias = Literal["front", "back", "left", "right", "top", "bottom", "iso"]
"""Directions of view that show the whole model; z is up."""
Shading: TypeAlias = Literal["gooch", "headlight", "flat"]
"""How surfaces are shaded."""
Opacity: TypeAlias = float | Mapping[str, float]
"""From 0 (clear) to 1 (opaque): of all regions, or by the names of regions or media."""


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A camera: perspective, or orthographic if `height` is given."""

    position: ArrayLike
    """The position of the camera."""
    target: ArrayLike = (0.0, 0.0, 0.0)
    """The point in the middle of the picture; it must differ from the position."""
    up: ArrayLike = (0.0, 0.0, 1.0)
    """The direction that is up in the picture."""
    field_of_view: float | None = None
    """The vertical field of view in degrees, between 0 and 180; 30 if neither it nor `height` is given."""
    height: float | None = None
    """The height of the picture in the unit of the model, for an orthographic picture."""


@overload
def render(
    subject: Solid | Model,
    *,
    kind: Literal["colour"] = "colour",
    size: tuple[int, int] | None = None,
    view: View | None = None,
    field_of_view: float | None = None,
    camera: Camera | None = None,
    shading: Shading | None = None,
    edges: bool | None = None,
    shadows: bool | None = None,
    samples: int | None = None,
    cut: str | None = None,
    explode: str | None = None,
    opacity: Opacity | None = None,
    evaluator: str | None = None,
    threads: int | None = None,
) -> NDArray[np.uint8]: ...
@overload
def render(
    subject: Solid | Model,
    *,
    kind: Literal["depth", "normal"],
    size: tuple[int, int] | None = None,
    view: View | None = None,
    field_of_view: float | None = None,
    camera: Camera | None = None,
    shading: Shading | None = None,
    edges: bool | None = None,
    shadows: bool | None = None,
    samples: int | None = None,
    cut: str | None = None,
    explode: str | None = None,
    opacity: Opacity | None = None,
    evaluator: str | None = None,
    threads: int | None = None,
) -> NDArray[np.float64]: ...
@overload
def render(
    subject: Solid | Model,
    *,
    kind: Literal["id"],
    size: tuple[int, int] | None = None,
    view: View | None = None,
    field_of_view: float | None = None,
    camera: Camera | None = None,
    shading: Shading | None = None,
    edges: bool | None = None,
    shadows: bool | None = None,
    samples: int | None = None,
    cut: str | None = None,
    explode: str | None = None,
    opacity: Opacity | None = None,
    evaluator: str | None = None,
    threads: int | None = None,
) -> NDArray[np.int32]: ...
def render(
    subject: Solid | Model,
    *,
    kind: Literal["colour", "depth", "normal", "id"] = "colour",
    size: tuple[int, int] | None = None,
    view: View | None = None,
    field_of_view: float | None = None,
    camera: Camera | None = None,
    shading: Shading | None = None,
    edges: bool | None = None,
    shadows: bool | None = None,
    samples: int | None = None,
    cut: str | None = None,
    explode: str | None = None,
    opacity: Opacity | None = None,
    evaluator: str | None = None,
    threads: int | None = None,
) -> NDArray[Any]:
    """A picture of a solid or a model as an array, row by row from the top.

    Arguments that are None have the values of the model file or else the defaults below.

    Parameters
    ----------
    kind
        - "colour": uint8 (h, w, 4), red, green, blue, opacity;
        - "depth": float64 (h, w), the distance to the first surface along the ray of each pixel, inf for a miss;
        - "normal": float64 (h, w, 3), the unit normal there, NaN for a miss;
        - "id": int32 (h, w), the number of the region, 0 for a miss.
    size
        Width and height in pixels; 1280 x 720.
    view
        The direction of an orthographic view of the whole model.
    field_of_view
        The vertical field of view in degrees, for a perspective view of the whole model.
    camera
        The camera; without it and `view`, one at the upper right that shows the whole model.
    shading
        "gooch" (from cool to warm), "headlight" (a lamp on the camera) or "flat".
    edges
        Whether edges are drawn as lines; True.
    shadows
        Whether lights cast shadows; False.
    samples
        Samples along each side of a pixel, 1 to 16; 3.
    cut
        Removes the parts on these sides of planes to show the inside: "x>0" removes one half of space, "x>50%,y<50%" a
        quarter of the model's box.
    explode
        Moves the regions apart along this axis, with a gap as a fraction of the model's largest side: "z", "x:0.3".
    opacity
        Makes regions transparent.
    evaluator, threads
        As in the queries of `Solid`.
    """
    if camera is not None and (view is not None or field_of_view is not None):
        raise _core.RayweaveError(
            "camera is given together with view or field_of_view: both define the view. Leave one of them out."
        )
    arguments = dict(
        size=size,
        view=view,
        field_of_view=field_of_view,
        camera=camera,
        shading=shading,
        edges=edges,
        shadows=shadows,
        samples=samples,
        cut=cut,
        explode=explode,
        opacity=_opacities(opacity),
        evaluator=evaluator,
        threads=threads,
    )
    picture: NDArray[Any] = _core.render(subject, kind, arguments)
    return picture


def sheet(
    subject: Solid | Model,
    *,
    title: str = "",
    view: View | None = None,
    size: tuple[int, int] | None = None,
    shading: Shading | None = None,
    edges: bool | None = None,
    shadows: bool | None = None,
    samples: int | None = None,
    cut: str | None = None,
    explode: str | None = None,
    opacity: Opacity | None = None,
    evaluator: str | None = None,
    threads: int | None = None,
) -> Drawing:
    """A sheet of paper with a model from several sides and a legend of its media; a notebook shows it.

    The views from the front, from above and from the right are to one scale and in line with one another, each on the
    side from which it is taken (third-angle projection, ISO 5456-2); the fourth is from the upper right.

    Parameters
    ----------
    title
        What the drawing is called.
    view
        Only this view, with the legend.
    size
        Width and height of the sheet in pixels; 1280 x 960, or 1280 x 720 of one view.
    shading, edges, shadows, samples, cut, explode, opacity, evaluator, threads
        As in `render`.

    Examples
    --------
    >>> drawing = sheet(box(2) - sphere(1.3), cut="x>50%")
    >>> drawing.save("hollow.svg")
    """
    arguments = dict(
        size=size,
        view=view,
        field_of_view=None,
        camera=None,
        shading=shading,
        edges=edges,
        shadows=shadows,
        samples=samples,
        cut=cut,
        explode=explode,
        opacity=_opacities(opacity),
        evaluator=evaluator,
        threads=threads,
    )
    return Drawing(_core.sheet_svg(subject, title, view is not None, arguments))


def _opacities(opacity: Opacity | None) -> list[tuple[str | None, float]]:
    if opacity is None:
        return []
    if isinstance(opacity, Mapping):
        return list(opacity.items())
    return [(None, opacity)]
