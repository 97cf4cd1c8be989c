"""Path lengths through media, and radiographs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._core import Model, Solid

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Thickness:
    """How far the ray of each pixel goes through each of M media."""

    media: tuple[str, ...]
    """The names of the media; the first is that of the world."""
    lengths: _Array
    """(H, W, M) path lengths; that through the world is the way between the first and the last crossing; inf where a medium has no
    end."""
    radiograph: _Array
    """(H, W) the part of an X-ray that comes through, 0 to 1."""
    attenuation: _Array
    """(M,) the attenuation per length of each medium by which that is reckoned."""
    unit: str

    def __repr__(self) -> str:
        height, width, _ = self.lengths.shape
        longest = [np.max(self.lengths[..., k], initial=0.0) for k in range(len(self.media))]
        media = ", ".join(f"{name} {most:.4g}" for name, most in zip(self.media, longest, strict=True))
        return f"<Thickness {width} x {height}, longest in {self.unit}: {media}>"


def thickness(
    subject: Solid | Model,
    *,
    view: str | None = None,
    size: tuple[int, int] | None = None,
    evaluator: str | None = None,
    threads: int | None = None,
) -> Thickness:
    """Measure how far rays go through each medium: one ray through the centre of each pixel, and all the way through.

    `view` looks at all of the model along parallel rays ("front", "top", ...); without it the camera of the model is taken. `size`
    is width and height in pixels. The radiograph is by the numbers `attenuation` (per length) of the media; if there are none,
    by their `density`, or all media alike, so that 5 % come through the place that weakens most.
    """
    media, attenuation, lengths, radiograph, unit = _core.thickness_maps(subject, view, size, evaluator, threads)
    return Thickness(tuple(media), lengths, radiograph, np.array(attenuation), unit)
