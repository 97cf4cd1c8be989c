"""Pictures of solids and models."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._core import Model, Solid

View: TypeAlias = Literal["front", "back", "left", "right", "top", "bottom", "iso"]
"""The directions from which all of a model can be looked at; z is up."""
Shading: TypeAlias = Literal["gooch", "headlight", "flat"]
"""How surfaces are shaded."""


@dataclass(frozen=True, kw_only=True)
class Camera:
    """From where a picture is taken: in perspective, or without foreshortening if `height` is given."""

    position: ArrayLike
    """Where the camera is."""
    target: ArrayLike = (0.0, 0.0, 0.0)
    """The point in the middle of the picture; not the position."""
    up: ArrayLike = (0.0, 0.0, 1.0)
    """The direction that is up in the picture."""
    field_of_view: float | None = None
    """The vertical field of view in degrees, between 0 and 180; 30 if neither it nor `height` is given."""
    height: float | None = None
    """The height of the picture in lengths of the model, for a picture without foreshortening."""


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
    evaluator: str | None = None,
    threads: int | None = None,
) -> NDArray[Any]:
    """A picture of a solid or a model as an array, row by row from the top.

    What is None is as the model file says, or else as told below.

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
        The direction from which all of the model is looked at, without foreshortening.
    field_of_view
        The vertical field of view in degrees of a picture of all of the model, in perspective.
    camera
        Where the picture is taken from; without it and `view`, from the upper right, so that all of the model is seen.
    shading
        "gooch" (from cool to warm), "headlight" (a lamp on the camera) or "flat".
    edges
        Whether lines are drawn where something begins or ends; True.
    shadows
        Whether lights cast shadows; False.
    samples
        Samples along each side of a pixel, 1 to 16; 3.
    evaluator, threads
        As in the questions of `Solid`.
    """
    if camera is not None and (view is not None or field_of_view is not None):
        raise _core.RayweaveError(
            "camera is given together with view or field_of_view (both say where to look from) leave one of them out?"
        )
    picture: NDArray[Any] = _core.render(
        subject,
        kind=kind,
        size=size,
        view=view,
        field_of_view=field_of_view,
        camera=camera,
        shading=shading,
        edges=edges,
        shadows=shadows,
        samples=samples,
        evaluator=evaluator,
        threads=threads,
    )
    return picture
