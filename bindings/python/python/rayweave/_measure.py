"""Volume, mass, centre, inertia and surface area of regions, with confidence intervals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._box import Box, corners
from rayweave._core import Solid
from rayweave._model import Subject
from rayweave._progress import Progress, callback
from rayweave._table import Table
from rayweave._whole import whole
from rayweave._words import suggesting

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Measurement(Table):
    """The measured values of R regions; `x_half_width` is half the width of the confidence interval of `x`.

    Lengths are in the unit of the document. Unknown values are NaN: the mass of a medium without a density, the volume
    by formula of anything but a single shape or mesh, the centre of a region that no ray has hit, the bounds in a model of more
    than 32 regions or with `within`.

    >>> import rayweave as rw
    >>> found = rw.measure({"die": rw.box(2), "ball": rw.sphere(1).translate([5, 0, 0])})
    >>> found["regions"].tolist(), found.volume_by_formula.round(4).tolist()
    (['die', 'ball'], [8.0, 4.1888])
    """

    _columns: ClassVar[tuple[str, ...]] = (
        "regions", "media", "volume", "volume_half_width", "volume_by_formula", "area", "area_half_width", "mass",
        "mass_half_width", "centre", "centre_half_width", "bounds", "rays", "is_reached",
    )  # fmt: skip

    regions: tuple[str, ...]
    """The names of the regions."""
    media: tuple[str, ...]
    """The names of their media."""
    volume: _Array
    """(R,) volumes."""
    volume_half_width: _Array
    volume_by_formula: _Array
    """(R,) exact volumes."""
    area: _Array
    """(R,) areas of the boundaries; a face between two regions counts for both."""
    area_half_width: _Array
    mass: _Array
    """(R,) masses in grams, from the density of the medium in g/cm^3."""
    mass_half_width: _Array
    centre: _Array
    """(R, 3) centres of volume."""
    centre_half_width: _Array
    inertia: _Array
    """(R, 3, 3) inertia tensors about the centre for density 1, integral of |r|^2 1 - r r^T."""
    inertia_half_width: _Array
    bounds: _Array
    """(R, 2, 3) lower and upper corners of boxes that the regions reach on all sides."""
    rays: NDArray[np.uint64]
    """(R,) numbers of rays that were traced for each region."""
    is_reached: NDArray[np.bool_]
    """(R,) whether the volume is as precise as requested."""

    def _column(self, name: str) -> NDArray[Any]:
        column = getattr(self, name)
        return np.array(column, dtype=object) if isinstance(column, tuple) else np.asarray(column)

    def __repr__(self) -> str:
        rows = zip(self.regions, self.volume, self.volume_half_width, strict=True)
        text = ", ".join(f"{name} {volume:.6g} \u00b1 {half:.2g}" for name, volume, half in rows)
        return f"<Measurement of volumes: {text}>"


@suggesting(accuracy="precision", tolerance="precision", samples="most_rays", rays="most_rays")
def measure(
    subject: Subject,
    *,
    precision: float = 1e-3,
    confidence: float = 0.99,
    most_rays: int | None = None,
    within: Box | None = None,
    seed: int = 0,
    evaluator: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Measurement:
    """Measure the regions of a model, a solid, or several solids, by stratified rays.

    A first round of rays determines how many rays each region needs, so that half the width of its volume's interval, at the level of
    `confidence`, is at most `precision` times the volume. The results come from further rays alone, at most `most_rays`. `most_rays` counts the rays of each region, in a model of more than 32
    regions those of all regions together; its default is 2^24, or fewer in models where many shapes overlap, so that all
    rays reach at most 2^23 shapes. Parts of a region that later regions cover do not count. `within` (2, 3), the corners of a box, restricts the
    measurement to the box. Equal seeds give equal results, regardless of the number of threads. `progress=True` shows the progress on
    standard error; a function is called with the number of rays so far and an estimate of the total.

    >>> import rayweave as rw
    >>> found = rw.measure({"ball": rw.sphere(1)})
    >>> bool(abs(found.volume[0] - 4.18879) < 3 * found.volume_half_width[0])
    True
    """
    regions, media, (rays, is_reached), (values, widths), boxes = _core.measure_columns(
        subject,
        precision,
        confidence,
        None if most_rays is None else whole(most_rays, "most_rays", least=1),
        corners(within),
        whole(seed, "seed"),
        evaluator,
        threads,
        callback(progress),
    )
    count = len(regions)
    return Measurement(
        tuple(regions),
        tuple(media),
        values[:, 0],
        widths[:, 0],
        values[:, 3],
        values[:, 1],
        widths[:, 1],
        values[:, 2],
        widths[:, 2],
        values[:, 4:7],
        widths[:, 4:7],
        values[:, 7:].reshape(count, 3, 3),
        widths[:, 7:].reshape(count, 3, 3),
        boxes.reshape(count, 2, 3),
        rays,
        is_reached,
    )


def value_of(solid: Solid, value: str) -> Any:
    """The volume, the area or the centre of a solid."""
    if not np.isfinite(solid.bounds).all() and solid.bounds[0, 0] < np.inf:
        word = "centroid" if value == "centre" else value
        raise _core.RayweaveError(f"the solid is unbounded: it has no {word}. Intersect it with a box.")
    exact = _core.exact_volume(solid) if value == "volume" else None
    if exact is not None:
        return exact
    found = measure(solid)
    number = getattr(found, value)[0]
    return float(number) if np.ndim(number) == 0 else number
