"""Path lengths through media, and radiographs."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from dataclasses import dataclass, field
from html import escape
from typing import Any, Literal
from warnings import warn

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._core import Model
from rayweave._model import Region, Subject
from rayweave._package import package
from rayweave._picture import Camera, Picture
from rayweave._table import Rows
from rayweave._whole import whole
from rayweave._words import did_you_mean, suggesting

_Array = NDArray[np.float64]

#: The axes to the right and upwards, with their signs, in the views along an axis.
_VIEW_AXES = {
    "front": ((0, 1), (2, 1)),
    "back": ((0, -1), (2, 1)),
    "left": ((1, -1), (2, 1)),
    "right": ((1, 1), (2, 1)),
    "top": ((0, 1), (1, 1)),
    "bottom": ((0, 1), (1, -1)),
}


@dataclass(frozen=True, eq=False)
class Thickness:
    """The path length of the ray of each pixel in each of M media, or in each of M regions with `by="region"`.

    >>> import rayweave as rw
    >>> found = rw.thickness({"die": rw.box(2)}, view="front", size=(5, 3))
    >>> float(found["die"].max().round(6))
    2.0
    >>> found.lengths.shape, found.media
    ((3, 5, 2), ('world', 'die'))
    """

    media: tuple[str, ...]
    """The names of the media or regions; the first is that of the world."""
    lengths: _Array
    """(H, W, M) path lengths; in the world only between the first and the last crossing; inf where a medium is
    unbounded."""
    radiograph: _Array
    """(H, W) the transmitted fraction of X-rays, 0 to 1."""
    line_integral: _Array
    """(H, W) the line integral of the attenuation, which is -ln of the radiograph."""
    attenuation: _Array
    """(M,) the attenuation per length of each medium that the radiograph uses."""
    unit: str
    pixel_size: float | None
    """The distance between the rays of neighbouring pixels in `unit`; None if the rays are not parallel."""
    _seen: tuple[str, Subject] | None = field(default=None, repr=False)
    """The view along an axis, and the model."""

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of the map about its centre in `unit`, as `matplotlib.pyplot.imshow` takes them.

        Raises `ValueError` if the rays are not parallel."""
        if self.pixel_size is None:
            raise ValueError("the rays are those of a perspective camera: the map has no extent in lengths.")
        height, width = self.radiograph.shape
        half = 0.5 * self.pixel_size * width, 0.5 * self.pixel_size * height
        return -half[0], half[0], -half[1], half[1]

    def __len__(self) -> int:
        """The number of media."""
        return len(self.media)

    def __iter__(self) -> Iterator[str]:
        """The names of the media."""
        return iter(self.media)

    def __getitem__(self, medium: str) -> _Array:
        """(H, W) the path lengths in a medium."""
        if medium not in self.media:
            hint = did_you_mean(medium, list(self.media), {})
            raise KeyError(f"there is no medium '{medium}': the media are {', '.join(self.media)}.{hint}")
        return self.lengths[..., self.media.index(medium)]

    def to_pandas(self) -> Any:
        """The path lengths as a pandas DataFrame, a row for each pixel and a column for each medium, with the column `radiograph`."""
        return self._rows().to_pandas().set_index(["y", "x"])

    def to_arrow(self) -> Any:
        """The path lengths as an Arrow table, a row for each pixel: `y`, `x`, a column for each medium, `radiograph`."""
        return self._rows().to_arrow()

    def to_xarray(self) -> Any:
        """The maps as an xarray Dataset: `lengths` (.., .., medium), `radiograph`, `line_integral`, and `attenuation` (medium).

        In a view along an axis, such as "front", the dimensions are the axes of the model upwards and to the right, ("z", "x"), and the
        coordinates are those of the model at the centres of the pixels, in `unit`. Otherwise they are ("y", "x"), and with parallel rays
        `x` and `y` are the centres of the pixels about that of the map, y upwards.

        >>> import rayweave as rw
        >>> found = rw.thickness({"bar": rw.box([8, 1, 2]).translate(10, 0, 0)}, view="front", size=(9, 3))
        >>> maps = found.to_xarray()
        >>> maps.lengths.dims, float(maps.x.mean())
        (('z', 'x', 'medium'), 10.0)
        """
        xarray = package("xarray", "its datasets")
        right, up, centre = self._axes()
        variables = {
            "lengths": ((up[0], right[0], "medium"), self.lengths.copy(), {"units": self.unit}),
            "radiograph": ((up[0], right[0]), self.radiograph.copy()),
            "line_integral": ((up[0], right[0]), self.line_integral.copy()),
            "attenuation": (("medium",), self.attenuation.copy(), {"units": f"1/{self.unit}"}),
        }
        coordinates: dict[str, Any] = {"medium": list(self.media)}
        if self.pixel_size is not None:
            height, width = self.radiograph.shape
            across = centre[0] + right[1] * self.pixel_size * (np.arange(width) - 0.5 * (width - 1))
            upwards = centre[1] + up[1] * self.pixel_size * (0.5 * (height - 1) - np.arange(height))
            units = {"units": self.unit}
            coordinates |= {right[0]: (right[0], across, units), up[0]: (up[0], upwards, units)}
        return xarray.Dataset(variables, coordinates)

    def _axes(self) -> tuple[tuple[str, int], tuple[str, int], tuple[float, float]]:
        """The names and signs of the axes to the right and upwards, and the coordinates of the centre along them."""
        if self._seen is not None:
            view, subject = self._seen
            (right, right_sign), (up, up_sign) = _VIEW_AXES[view]
            solid = subject.solid if isinstance(subject, Region) else subject
            bounds = solid.bounds if hasattr(solid, "bounds") else Model(solid).bounds  # type: ignore[arg-type]
            centre = 0.5 * (bounds[0] + bounds[1])
            # the centre of an unbounded model is not that of its box
            if np.isfinite(centre).all():
                return ("xyz"[right], right_sign), ("xyz"[up], up_sign), (float(centre[right]), float(centre[up]))
        return ("x", 1), ("y", 1), (0.0, 0.0)

    def _rows(self) -> Rows:
        y, x = np.indices(self.radiograph.shape)
        media = {name: self.lengths[..., k].ravel() for k, name in enumerate(self.media)}
        return Rows({"y": y.ravel(), "x": x.ravel(), **media, "radiograph": self.radiograph.ravel()}, {})

    def _repr_html_(self) -> str:
        """The radiograph as a picture."""
        grey = np.nan_to_num(255 * np.clip(self.radiograph, 0, 1)).astype(np.uint8)
        pixels = np.stack([grey, grey, grey, np.full_like(grey, 255)], axis=-1)
        data = b64encode(pixels.view(Picture)._repr_png_()).decode()
        return f'<p>{escape(repr(self)[1:-1])}</p><img alt="radiograph" src="data:image/png;base64,{data}">'

    def __repr__(self) -> str:
        height, width, _ = self.lengths.shape
        longest = [np.max(self.lengths[..., k], initial=0.0) for k in range(len(self.media))]
        media = ", ".join(f"{name} {most:.4g}" for name, most in zip(self.media, longest, strict=True))
        return f"<Thickness {width} x {height}, longest in {self.unit}: {media}>"


@suggesting(width="size=(width, height)", height="size=(width, height)", axis="view")
def thickness(
    subject: Subject,
    *,
    view: str | None = None,
    camera: Camera | None = None,
    size: tuple[int, int] | None = None,
    by: Literal["medium", "region"] = "medium",
    evaluator: str | None = None,
    threads: int | None = None,
) -> Thickness:
    """Measure path lengths in each medium, along one ray through the centre of each pixel, through the whole model.

    `view` selects parallel rays that cover the whole model ("front", "top", ...) with a margin; `camera` is a
    `rayweave.Camera`; without either, the camera of the model is used. A point source at the distance s from a flat detector of
    height h is a perspective camera: `Camera(position=source, target=..., field_of_view=2 * degrees(arctan(h / 2 / s)))`. `size` is width
    and height in pixels. In the world, only the length between the first and the last crossing counts, so that air or water
    around the model does not attenuate. With `by="region"` each region has its own lengths, also beside others of its medium; the
    radiograph is the same.

    The radiograph uses the numbers `attenuation` (per length) of the media. A medium without one beside others that have
    one is transparent, with a warning. If no medium has one, attenuation is proportional to `density` or, without densities,
    equal for all media, scaled so that 5 % pass where most is absorbed.

    >>> import rayweave as rw
    >>> found = rw.thickness({"ball": rw.sphere(1)}, view="top", size=(64, 64))
    >>> float(found["ball"].max().round(2))
    2.0
    >>> cone = rw.Camera(position=[0, -9, 0], target=[0, 0, 0], field_of_view=20)
    >>> float(rw.thickness(rw.sphere(1), camera=cone, size=(65, 65)).lengths[32, 32, 1].round(6))
    2.0
    >>> tray = {"left": rw.box(1), "right": rw.box(2).translate([3, 0, 0])}
    >>> parts = rw.thickness(tray, view="right", size=(9, 9), by="region")
    >>> parts.media, float(parts["left"].max())
    (('world', 'left', 'right'), 1.0)
    """
    if camera is not None and view is not None:
        raise TypeError("camera and view are both given: the rays are those of one of them.")
    if camera is not None and not isinstance(camera, Camera):
        raise TypeError(f"camera is of type {type(camera).__name__}: it must be a Camera.")
    pixels = None
    if size is not None:
        try:
            width, height = size
        except (TypeError, ValueError):
            needed = "it must be two whole numbers, the width and the height in pixels."
            raise TypeError(f"size is {size!r}: {needed}") from None
        pixels = whole(width, "the width", bits=32), whole(height, "the height", bits=32)
    media, attenuation, lengths, (radiograph, integral), unit, pixel_size, remarks = _core.thickness_maps(
        subject, view, camera, pixels, by, evaluator, threads
    )
    for remark in remarks:
        warn(remark, stacklevel=3)
    seen = (view, subject) if view in _VIEW_AXES else None
    return Thickness(tuple(media), lengths, radiograph, integral, np.array(attenuation), unit, pixel_size, seen)
