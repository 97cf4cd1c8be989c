"""Sources of light."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave.optics._elements import Aperture, _outline
from rayweave.optics._place import Placed

#: A wavelength in nanometres; wavelengths with weights; or a kind with its numbers: ("uniform", lo, hi),
#: ("black body", kelvin, lo, hi).
Spectrum = float | dict[float, float] | tuple[str, *tuple[float, ...]]


@dataclass(frozen=True, eq=False)
class Source(Placed):
    """A source of light, which shines along +z about the origin until it is moved. It never changes: ray k is always the same, a
    lamp with another seed is another lamp."""

    compiled: _core.LightSource

    def transform(self, matrix: ArrayLike) -> Self:
        """The image under an affine map: a 4 x 4 matrix world_from_local that acts on columns."""
        return replace(self, compiled=self.compiled.apply(matrix))

    def __len__(self) -> int:
        return self.compiled.count

    def rays(self) -> tuple[NDArray[np.float64], ...]:
        """Origins (N, 3), unit directions (N, 3), wavelengths in nanometres (N,) and powers (N,)."""
        return self.compiled.rays()


def _gathered(sources: list[Source]) -> tuple[NDArray[Any], ...]:
    if not sources:
        raise _core.RayweaveError("sources is empty (light has to come from somewhere)")
    parts = [source.rays() for source in sources]
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    numbers = np.repeat(np.arange(len(sources)), [len(source) for source in sources])
    return (*columns, numbers)


def _source(
    kind: str,
    numbers: tuple[float, ...],
    count: int,
    wavelength_nm: Spectrum,
    power: float | tuple[Literal["total"], float],
    seed: int = 0,
    outline: Aperture | None = None,
    sampling: str = "fibonacci",
) -> Source:
    match wavelength_nm:
        case dict() as lines:
            spectrum = ("lines", [float(x) for line in lines.items() for x in line])
        case (str() as name, *rest):
            spectrum = (name, [float(x) for x in rest])
        case single:
            spectrum = ("line", [float(single)])
    total, amount = (True, power[1]) if isinstance(power, tuple) else (False, power)
    compiled = _core.LightSource(
        kind,
        [float(number) for number in numbers],
        count,
        spectrum,
        float(amount),
        total,
        seed,
        None if outline is None else _outline(outline),
        sampling,
    )
    return Source(compiled)


_Power = float | tuple[Literal["total"], float]


def line_of_rays(
    spacing: float, count: int, *, wavelength_nm: Spectrum = 633.0, power: _Power = 100.0
) -> Source:
    """Parallel rays along +z, evenly spaced along y over a length."""
    return _source("line", (spacing,), count, wavelength_nm, power)


def circle_of_rays(
    diameter: float, count: int, *, wavelength_nm: Spectrum = 633.0, power: _Power = 100.0
) -> Source:
    """Parallel rays along +z, evenly spaced on a circle."""
    return _source("circle", (diameter,), count, wavelength_nm, power)


def cone_of_rays(
    cone_degrees: float, count: int, *, wavelength_nm: Spectrum = 633.0, power: _Power = 100.0
) -> Source:
    """Rays from the origin, all at one angle from +z."""
    return _source("cone", (cone_degrees,), count, wavelength_nm, power)


def wedge_of_rays(
    degrees: float, count: int, *, wavelength_nm: Spectrum = 633.0, power: _Power = 100.0
) -> Source:
    """Rays from the origin in the plane x = 0, evenly spread over an angle about +z."""
    return _source("wedge", (degrees,), count, wavelength_nm, power)


def lamp(
    width: float,
    length: float,
    count: int,
    *,
    max_degrees: float = 90.0,
    wavelength_nm: Spectrum = 633.0,
    power: _Power = 100.0,
    seed: int = 0,
) -> Source:
    """A rectangle that shines by Lambert's law, as PyRayT's lamp: directions are uniform in the cone, powers go as the cosine."""
    return _source("lamp", (width, length, max_degrees), count, wavelength_nm, power, seed)


def beam(
    aperture: Aperture,
    count: int,
    *,
    waist: float | None = None,
    sampling: Literal["grid", "hexapolar", "fibonacci", "random"] = "fibonacci",
    wavelength_nm: Spectrum = 633.0,
    power: _Power = ("total", 1.0),
    seed: int = 0,
) -> Source:
    """A collimated beam along +z over an aperture: uniform, or Gaussian with the 1/e^2 radius `waist`. `count` is about the
    number of rays (grid and hexapolar samplings have their own)."""
    numbers = () if waist is None else (waist,)
    return _source("beam", numbers, count, wavelength_nm, power, seed, aperture, sampling)


def point_source(
    half_angle_degrees: float,
    count: int,
    *,
    wavelength_nm: Spectrum = 633.0,
    power: _Power = ("total", 1.0),
    seed: int = 0,
) -> Source:
    """Rays from the origin, uniform in solid angle in a cone about +z."""
    return _source("point", (half_angle_degrees,), count, wavelength_nm, power, seed)
