"""Pictures of solids and models."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypeVar, overload
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._drawing import Drawing, show
from rayweave._files import write_file
from rayweave._model import Subject
from rayweave._package import package
from rayweave._whole import whole
from rayweave._words import suggesting

View: TypeAlias = Literal["front", "back", "left", "right", "top", "bottom", "iso"]
"""Directions of view that show the whole model; z is up."""
Shading: TypeAlias = Literal["gooch", "headlight", "flat"]
"""How surfaces are shaded."""
Device: TypeAlias = Literal["cpu", "gpu", "auto"]
"""Devices that answer ray queries, with the same answers: see `Solid`."""
Opacity: TypeAlias = float | Mapping[str, float]
"""From 0 (clear) to 1 (opaque): of all regions, or by the names of regions or media."""


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A camera: perspective, or orthographic if `height` is given.

    >>> import rayweave as rw
    >>> camera = rw.Camera(position=[8, -6, 4], field_of_view=20)
    >>> rw.render(rw.box(2), size=(64, 48), camera=camera).shape
    (48, 64, 4)
    """

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


class Picture(np.ndarray[Any, np.dtype[np.uint8]]):
    """A picture as an array of pixels, uint8 (h, w, 4): red, green, blue, opacity. A notebook shows it.

    >>> import rayweave as rw
    >>> picture = rw.render(rw.sphere(1), size=(64, 48))
    >>> picture.shape
    (48, 64, 4)
    >>> picture.save("sphere.png")
    """

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the picture to a file: .png, or by Pillow any format that it has, such as .jpg."""
        target = Path(path)
        if target.suffix.lower() == ".png":
            write_file(target, self._repr_png_())
            return
        pillow = package("PIL.Image", "pictures in formats other than PNG")
        kind = pillow.registered_extensions().get(target.suffix.lower())
        if kind is None:
            raise _core.RayweaveError(f"cannot write {path}: Pillow has no format for '{target.suffix}'. Save it as .png or .jpg.")
        image = pillow.fromarray(np.asarray(self)).convert("RGB" if kind == "JPEG" else "RGBA")
        data = io.BytesIO()
        image.save(data, format=kind)
        write_file(target, data.getvalue())

    def show(self) -> None:
        """Shows the picture: in a notebook below the cell, otherwise in the browser."""
        show(self, self._repr_png_(), ".png")

    def _repr_png_(self) -> bytes:
        """The picture as a PNG file (ISO/IEC 15948), with 8 bits for each channel and no row filter."""
        pixels = np.ascontiguousarray(np.asarray(self))
        if pixels.ndim != 3 or pixels.shape[2] != 4:
            raise _core.RayweaveError(f"the picture has shape {pixels.shape}: a file needs (h, w, 4).")
        height, width, _ = pixels.shape
        rows = np.zeros((height, 1 + 4 * width), np.uint8)
        rows[:, 1:] = pixels.reshape(height, 4 * width)

        def chunk(kind: bytes, data: bytes) -> bytes:
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
        body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b"")
        return b"\x89PNG\r\n\x1a\n" + body


@overload
def render(
    subject: Subject,
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
    device: Device = "cpu",
) -> Picture: ...
@overload
def render(
    subject: Subject,
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
    device: Device = "cpu",
) -> NDArray[np.float64]: ...
@overload
def render(
    subject: Subject,
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
    device: Device = "cpu",
) -> NDArray[np.int32]: ...
@suggesting(width="size=(width, height)", height="size=(width, height)", resolution="size=(width, height)", color="a Region with colour")
def render(
    subject: Subject,
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
    device: Device = "cpu",
) -> NDArray[Any]:
    """A picture of a solid, a model, or a list or dict of solids, as an array, row by row from the top.

    Arguments that are None have the values of the model file or else the defaults below.

    Parameters
    ----------
    kind
        - "colour": a `Picture`, uint8 (h, w, 4), red, green, blue, opacity;
        - "depth": float64 (h, w), the distance to the first surface along the ray of each pixel, inf for a miss;
        - "normal": float64 (h, w, 3), the unit normal there, NaN for a miss;
        - "id": int32 (h, w), the number of the region, 0 for a miss.
    size
        Width and height in pixels; 1280 x 720.
    view
        The name of the direction of an orthographic view of the whole model: "front", "back", "left", "right", "top", "bottom" or
        "iso". A `Camera` looks in any other direction.
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
    evaluator, threads, device
        As in the queries of `Solid`.

    Examples
    --------
    >>> picture = render({"ball": sphere(1), "plate": box([3, 3, 0.2])}, size=(320, 240))
    >>> picture.save("ball.png")
    """
    if camera is not None and not isinstance(camera, Camera):
        raise TypeError(f"camera is of type {type(camera).__name__}: it must be a Camera. Write Camera(position=[x, y, z]).")
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
        device=device,
    )
    picture: NDArray[Any] = _named(lambda: _core.render(subject, kind, arguments), arguments)
    return picture.view(Picture) if kind == "colour" else picture


@suggesting(width="size=(width, height)", height="size=(width, height)")
def sheet(
    subject: Subject,
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
    dimensions: bool = False,
    projection: Literal["third", "first"] = "third",
    evaluator: str | None = None,
    threads: int | None = None,
    device: Device = "cpu",
) -> Drawing:
    """A sheet of paper with a model from several sides and a legend of its media; a notebook shows it.

    The views from the front, from above and from the right are to one scale and in line with one another, each on the
    side from which it is taken (third-angle projection, ISO 5456-2); the fourth is from the upper right. With `cut`, the
    views that look onto a cut face are cut, and the others show the whole model.

    Parameters
    ----------
    title
        What the drawing is called.
    view
        Only this view, with the legend.
    size
        Width and height of the sheet in pixels; 1280 x 960, 1280 x 720 of one view, or A4 with dimensions.
    dimensions
        A technical drawing to a standard scale: visible edges, centre lines, overall sizes, distances of steps, diameters and depths
        of round holes, sizes of polygonal ones along the axes, circles of holes. It takes `title`, `size`, `projection`, `evaluator` and `threads`.
    projection
        The method of projection of a drawing with dimensions: "third" or "first" angle.
    shading, edges, shadows, samples, cut, explode, opacity, evaluator, threads, device
        As in `render`.

    Examples
    --------
    >>> drawing = sheet(box(2) - sphere(1.3), cut="x>50%")
    >>> drawing.save("hollow.svg")
    >>> import rayweave as rw
    >>> plate = rw.box([60, 40, 8]) - rw.cylinder(3)
    >>> "\u23006 through" in sheet(plate, dimensions=True).svg
    True
    """
    if dimensions:
        others = dict(
            view=view, shading=shading, edges=edges, shadows=shadows, samples=samples, cut=cut, explode=explode, opacity=opacity
        )
        given = [name for name, value in others.items() if value is not None]
        if given:
            hint = ' Use section(subject, "x=0") for a section, or leave out dimensions for views that are cut.' if "cut" in given else ""
            raise TypeError(f"{given[0]} is given with dimensions: a technical drawing shows the edges of the whole model.{hint}")
        pixels = None if size is None else (whole(size[0], "the width", bits=32), whole(size[1], "the height", bits=32))
        svg, notes = _core.technical_svg(subject, title, pixels, projection, evaluator, threads)
        for note in notes:
            warn(note, stacklevel=2)
        return Drawing(svg)
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
        device=device,
    )
    return Drawing(_named(lambda: _core.sheet_svg(subject, title, view is not None, arguments), arguments))


#: The kinds of arguments, for messages.
_WANTED = {
    "size": "two whole numbers, the width and the height in pixels",
    "view": "'front', 'back', 'left', 'right', 'top', 'bottom' or 'iso'; a Camera looks in any other direction",
    "field_of_view": "an angle in degrees",
    "shading": "the name of a style",
    "edges": "True or False",
    "shadows": "True or False",
    "samples": "a whole number",
    "cut": "a text such as 'x>0'",
    "explode": "a text such as 'z'",
    "opacity": "a number, or a dict of numbers",
    "evaluator": "the name of an evaluator",
    "device": "the name of a device",
}

T = TypeVar("T")


def _named(call: Callable[[], T], arguments: Mapping[str, Any]) -> T:
    """The result of a call; an error about the type of an argument states what is needed."""
    try:
        return call()
    except (TypeError, OverflowError, ValueError) as error:
        name = str(error).rpartition("RenderArguments.")[2]
        if "RenderArguments." not in str(error) or name not in _WANTED:
            raise
        raise TypeError(f"{name} is {arguments[name]!r}: it must be {_WANTED[name]}.") from None


def _opacities(opacity: Opacity | None) -> list[tuple[str | None, float]]:
    if opacity is None:
        return []
    if isinstance(opacity, Mapping):
        return list(opacity.items())
    return [(None, opacity)]
