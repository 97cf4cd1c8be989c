"""Sources of light."""

from __future__ import annotations

from dataclasses import dataclass, replace
from os import PathLike
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave.optics._elements import Aperture, _outline
from rayweave._recipe import record_all, recorded, reduced
from rayweave.optics._given import array, real, text, unknown, whole
from rayweave.optics._place import Placed

#: A wavelength in nanometres; a dict of wavelengths with weights, which are lines; or a kind with its numbers: ("uniform", lo, hi), the
#: same from lo to hi; ("black body", kelvin, lo, hi), Planck's law between them; ("table", w1, p1, w2, p2, ..), densities p at
#: wavelengths w in rising order, and straight lines between; ("lines", w1, p1, w2, p2, ..), as a dict.
Spectrum = float | dict[float, float] | tuple[str, *tuple[float, ...]]


@dataclass(frozen=True, eq=False)
class Source(Placed):
    """A source of light at the origin that emits along +z. Immutable: ray k is always the same. Transforms return a new
    source; for other random rays create a source with a different seed."""

    compiled: _core.LightSource
    #: Whether its light is polarised; one from a model file does not tell.
    is_polarised: bool = False

    def __reduce__(self) -> tuple[Any, ...]:
        return reduced(self)

    @recorded
    def transform(self, matrix: ArrayLike) -> Self:
        """The image under an affine map: a 4 x 4 matrix world_from_local that acts on columns."""
        return replace(self, compiled=self.compiled.apply(matrix))

    def __len__(self) -> int:
        return self.compiled.count

    @recorded
    def polarised(self, i: float, q: float, u: float, v: float) -> Self:
        """The same source with polarised light, given by Stokes parameters, of which only the proportions count. Light
        with q > 0 is polarised along the x axis of the source, projected across each ray; u > 0 is inclined from x
        towards y. Light with q = u = v = 0 is unpolarised. `System.trace` computes the polarisation unless `polarised`
        is False."""
        parameters = tuple(real(value, name) for name, value in (("i", i), ("q", q), ("u", u), ("v", v)))
        compiled = self.compiled.with_stokes((parameters[0], parameters[1], parameters[2], parameters[3]))
        return replace(self, compiled=compiled, is_polarised=any(parameters[1:]))

    def rays(self) -> tuple[NDArray[np.float64], ...]:
        """Origins (N, 3), unit directions (N, 3), wavelengths in nanometres (N,) and powers (N,)."""
        return self.compiled.rays()


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
    amount, is_total = _amount(power)
    compiled = _core.LightSource(
        kind,
        [real(number, "a size or angle of the source") for number in numbers],
        whole(count, "the number of rays", least=1),
        _spectrum(wavelength_nm),
        amount,
        is_total,
        whole(seed, "seed"),
        None if outline is None else _outline(outline),
        text(sampling, "sampling"),
    )
    return Source(compiled)


#: Kinds of spectra with their numbers; none for pairs of a wavelength and a weight.
_SPECTRA: dict[str, tuple[str, ...]] = {
    "line": ("wavelength",),
    "lines": (),
    "table": (),
    "uniform": ("lowest wavelength", "highest wavelength"),
    "black body": ("kelvin", "lowest wavelength", "highest wavelength"),
}


def _spectrum(wavelength_nm: Spectrum) -> tuple[str, list[float]]:
    match wavelength_nm:
        case dict() as lines:
            return "lines", [real(x, "a wavelength or weight") for line in lines.items() for x in line]
        case (str() as name, *rest):
            if name not in _SPECTRA:
                unknown("spectrum", name, _SPECTRA)
            wanted = _SPECTRA[name]
            if wanted and len(rest) != len(wanted):
                raise _core.RayweaveError(f"the spectrum {name!r} is given {len(rest)} numbers: it has {len(wanted)}: {', '.join(wanted)}.")
            if not wanted and len(rest) % 2:
                raise _core.RayweaveError(f"the spectrum {name!r} is given {len(rest)} numbers: they are pairs of wavelength and weight.")
            return name, [real(x, f"a number of the spectrum {name!r}") for x in rest]
        case single:
            needed = "a number of nanometres, a dict of them with weights, or a kind of spectrum with its numbers"
            return "line", [real(single, "wavelength_nm", needed)]


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
    """A rectangle that emits by Lambert's law, like PyRayT's lamp: directions are uniform in the cone, powers are
    proportional to the cosine."""
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
    """A collimated beam along +z over an aperture: uniform, or Gaussian with the 1/e^2 radius `waist`. `count` is the
    approximate number of rays (grid and hexapolar samplings determine the exact one).

    `wavelength_nm`, of this and other sources, is one wavelength, a dict of wavelengths with weights, or a kind of
    spectrum with its numbers: ("uniform", lo, hi), ("black body", kelvin, lo, hi), ("table", w1, p1, w2, p2, ..) of
    densities p, interpolated linearly, ("lines", w1, p1, w2, p2, ..). `power` is that of each ray, or ("total", power)
    that of all rays together.
    """
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


def source_of_rays(
    origins: ArrayLike,
    directions: ArrayLike,
    *,
    wavelength_nm: ArrayLike | Spectrum = 633.0,
    power: ArrayLike | tuple[Literal["total"], float] = 1.0,
) -> Source:
    """Rays given one by one: origins (N, 3), and directions (N, 3) of any length but 0. Wavelengths are an array (N,),
    or a spectrum from which they are drawn; powers an array (N,), one number for all rays, or ("total", power)."""
    lengths = _column(wavelength_nm, "wavelength_nm")
    powers = _column(power, "power")
    compiled = _core.LightSource.listed(origins, directions, lengths, powers)
    if lengths is None:
        compiled = compiled.with_spectrum(_spectrum(wavelength_nm))  # type: ignore[arg-type]
    return Source(compiled if powers is not None else _powered(compiled, power))


def source_from_file(
    path: str | PathLike[str],
    *,
    wavelength_nm: Spectrum | None = None,
    power: float | tuple[Literal["total"], float] | None = None,
) -> Source:
    """The rays of a file: `.csv` with the columns ox, oy, oz, dx, dy, dz and optionally wavelength_nm and power; or
    `.npy` of the shape (N, 6), (N, 7) with wavelengths or (N, 8) with both. `wavelength_nm` applies to files without
    wavelengths (default 633 nm). `power` is the power of each ray or, for files with powers, a factor on them (default
    1)."""
    compiled = _core.LightSource.from_file(path)
    if wavelength_nm is not None:
        compiled = compiled.with_spectrum(_spectrum(wavelength_nm))
    return Source(_powered(compiled, 1.0 if power is None else power))


def _column(given: Any, name: str) -> list[float] | None:
    """A column with a number for each ray; None for a single number, a spectrum or a total."""
    if isinstance(given, dict) or (isinstance(given, tuple) and any(isinstance(part, str) for part in given)):
        return None
    column = array(given, name)
    return column.tolist() if column.ndim > 0 else None


def _powered(compiled: _core.LightSource, power: Any) -> _core.LightSource:
    return compiled.with_power(*_amount(power))


def _amount(power: Any) -> tuple[float, bool]:
    """A power, and whether it is the power of all rays together."""
    needed = 'a number, or a pair of "total" and a number'
    match power:
        case ("total", amount):
            return real(amount, "power", needed), True
        case tuple() | list():
            raise TypeError(f"power is {power!r}: it must be {needed}.")
    return real(power, "power", needed), False


record_all(globals(), "Source")
