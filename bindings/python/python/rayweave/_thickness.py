"""Path lengths through media, and radiographs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._model import Subject
from rayweave._whole import whole

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Thickness:
    """The path length of the ray of each pixel in each of M media."""

    media: tuple[str, ...]
    """The names of the media; the first is that of the world."""
    lengths: _Array
    """(H, W, M) path lengths; in the world only between the first and the last crossing; inf where a medium is
    unbounded."""
    radiograph: _Array
    """(H, W) the transmitted fraction of X-rays, 0 to 1."""
    attenuation: _Array
    """(M,) the attenuation per length of each medium that the radiograph uses."""
    unit: str

    def __len__(self) -> int:
        """The number of media."""
        return len(self.media)

    def __iter__(self) -> Iterator[str]:
        """The names of the media."""
        return iter(self.media)

    def __getitem__(self, medium: str) -> _Array:
        """(H, W) the path lengths in a medium."""
        if medium not in self.media:
            raise KeyError(f"there is no medium '{medium}': the media are {', '.join(self.media)}.")
        return self.lengths[..., self.media.index(medium)]

    def __repr__(self) -> str:
        height, width, _ = self.lengths.shape
        longest = [np.max(self.lengths[..., k], initial=0.0) for k in range(len(self.media))]
        media = ", ".join(f"{name} {most:.4g}" for name, most in zip(self.media, longest, strict=True))
        return f"<Thickness {width} x {height}, longest in {self.unit}: {media}>"


def thickness(
    subject: Subject,
    *,
    view: str | None = None,
    size: tuple[int, int] | None = None,
    evaluator: str | None = None,
    threads: int | None = None,
) -> Thickness:
    """Measure path lengths in each medium, along one ray through the centre of each pixel, through the whole model.

    `view` selects parallel rays that cover the whole model ("front", "top", ...); without it the camera of the model is
    used. `size` is width and height in pixels. The radiograph uses the numbers `attenuation` (per length) of the media.
    Without these, attenuation is proportional to `density` or, without densities, equal for all media, scaled so that 5
    % pass where most is absorbed.
    """
    pixels = None
    if size is not None:
        try:
            width, height = size
        except (TypeError, ValueError):
            needed = "it must be two whole numbers, the width and the height in pixels."
            raise TypeError(f"size is {size!r}: {needed}") from None
        pixels = whole(width, "the width", bits=32), whole(height, "the height", bits=32)
    media, attenuation, lengths, radiograph, unit = _core.thickness_maps(subject, view, pixels, evaluator, threads)
    return Thickness(tuple(media), lengths, radiograph, np.array(attenuation), unit)
