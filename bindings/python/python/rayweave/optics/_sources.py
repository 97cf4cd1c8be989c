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
from rayweave._words import suggesting
from rayweave.optics._given import array, real, text, unknown, whole
from rayweave.optics._place import Placed

#: A wavelength in nanometres; a dict of wavelengths with weights, which are lines; or a kind with its numbers: ("uniform", lo, hi), the
#: same from lo to hi; ("black body", kelvin, lo, hi), Planck's law between them; ("table", w1, p1, w2, p2, ..), densities p at
#: wavelengths w in rising order, and straight lines between; ("lines", w1, p1, w2, p2, ..), as a dict.
Spectrum = float | dict[float, float] | tuple[str, *tuple[float, ...]]


@dataclass(frozen=True, eq=False, repr=False)
class Source(Placed):
    """A source of light at the origin that emits along +z. Immutable: ray k is always the same. Transforms return a new
    source; for other random rays create a source with a different seed.

    >>> import rayweave.optics as ro
    >>> light = ro.point_source(10, 50).translate([0, 0, -20])
    >>> len(light)
    50
    >>> origins, directions, wavelength_nm, power = light.rays()
    >>> origins.shape, float(power.sum().round(6))
    ((50, 3), 1.0)
    """

    compiled: _core.LightSource
    #: Whether its light is polarised; one from a model file does not tell.
    is_polarised: bool = False

    def __reduce__(self) -> tuple[Any, ...]:
        return reduced(self)

    def __repr__(self) -> str:
        return f"<Source of {len(self)} rays{', polarised' if self.is_polarised else ''}>"

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
    """Parallel rays along +z, evenly spaced along y over a length.

    >>> import rayweave.optics as ro
    >>> origins = ro.line_of_rays(10, 3).rays()[0]
    >>> origins[:, 1].tolist()
    [-5.0, 0.0, 5.0]
    """
    return _source("line", (spacing,), count, wavelength_nm, power)


def circle_of_rays(
    diameter: float, count: int, *, wavelength_nm: Spectrum = 633.0, power: _Power = 100.0
) -> Source:
    """Parallel rays along +z, evenly spaced on a circle.

    >>> import rayweave.optics as ro
    >>> len(ro.circle_of_rays(10, 6))
    6
    """
    return _source("circle", (diameter,), count, wavelength_nm, power)


def cone_of_rays(
    cone_degrees: float, count: int, *, wavelength_nm: Spectrum = 633.0, power: _Power = 100.0
) -> Source:
    """Rays from the origin, all at one angle from +z.

    >>> import rayweave.optics as ro
    >>> len(ro.cone_of_rays(5, 8))
    8
    """
    return _source("cone", (cone_degrees,), count, wavelength_nm, power)


def wedge_of_rays(
    degrees: float, count: int, *, wavelength_nm: Spectrum = 633.0, power: _Power = 100.0
) -> Source:
    """Rays from the origin in the plane x = 0, evenly spread over an angle about +z.

    >>> import rayweave.optics as ro
    >>> directions = ro.wedge_of_rays(60, 3).rays()[1]
    >>> directions[:, 1].round(3)
    array([-0.5,  0. ,  0.5])
    """
    return _source("wedge", (degrees,), count, wavelength_nm, power)


@suggesting(wavelength="wavelength_nm", wavelengths="wavelength_nm", diameter="aperture", rays="count", n="count")
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
    proportional to the cosine.

    >>> import rayweave.optics as ro
    >>> len(ro.lamp(1, 2, 100, seed=1))
    100
    """
    return _source("lamp", (width, length, max_degrees), count, wavelength_nm, power, seed)


@suggesting(wavelength="wavelength_nm", wavelengths="wavelength_nm", diameter="aperture", rays="count", n="count")
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

    >>> import rayweave.optics as ro
    >>> light = ro.beam(10.0, 100, wavelength_nm={486.1: 1, 656.3: 1})
    >>> sorted(set(light.rays()[2].tolist()))
    [486.1, 656.3]
    """
    numbers = () if waist is None else (waist,)
    return _source("beam", numbers, count, wavelength_nm, power, seed, aperture, sampling)


@suggesting(wavelength="wavelength_nm", wavelengths="wavelength_nm", diameter="aperture", rays="count", n="count")
def point_source(
    half_angle_degrees: float,
    count: int,
    *,
    wavelength_nm: Spectrum = 633.0,
    power: _Power = ("total", 1.0),
    seed: int = 0,
) -> Source:
    """Rays from the origin, uniform in solid angle in a cone about +z.

    >>> import rayweave.optics as ro
    >>> len(ro.point_source(20, 100))
    100
    """
    return _source("point", (half_angle_degrees,), count, wavelength_nm, power, seed)


def source_of_rays(
    origins: ArrayLike,
    directions: ArrayLike,
    *,
    wavelength_nm: ArrayLike | Spectrum = 633.0,
    power: ArrayLike | tuple[Literal["total"], float] = 1.0,
) -> Source:
    """Rays given one by one: origins (N, 3), and directions (N, 3) of any length but 0; grids (..., 3) of rays are numbered in
    row-major order. One direction (3,) belongs to all origins, and one origin to all directions. Wavelengths are an array (N,), or a spectrum from which they are drawn; powers an array (N,), one number for all rays, or ("total", power).

    >>> import rayweave.optics as ro
    >>> light = ro.source_of_rays([[0, 0, 0], [0, 1, 0]], [[0, 0, 1], [0, 0, 1]], power=[1, 2])
    >>> light.rays()[3]
    array([1., 2.])
    >>> len(ro.source_of_rays([[0, 0, 0], [0, 1, 0], [0, 2, 0]], [0, 0, 1]))
    3
    """
    lengths = _column(wavelength_nm, "wavelength_nm")
    powers = _column(power, "power")
    starts, ways = (_flat(given, name) for given, name in ((origins, "origins"), (directions, "directions")))
    # one vector is repeated without copies
    if starts.shape == (3,) and ways.ndim == 2:
        starts = np.broadcast_to(starts, (len(ways), 3))
    if ways.shape == (3,):
        ways = np.broadcast_to(ways, (len(starts), 3)) if starts.ndim == 2 else ways
    compiled = _core.LightSource.listed(starts, ways, lengths, powers)
    if lengths is None:
        compiled = compiled.with_spectrum(_spectrum(wavelength_nm))  # type: ignore[arg-type]
    return Source(compiled if powers is not None else _powered(compiled, power))


def source_from_file(
    path: str | PathLike[str],
    *,
    wavelength_nm: Spectrum | None = None,
    power: float | tuple[Literal["total"], float] | None = None,
) -> Source:
    r"""The rays of a file: `.csv` with the columns ox, oy, oz, dx, dy, dz and optionally wavelength_nm and power; or
    `.npy` of the shape (N, 6), (N, 7) with wavelengths or (N, 8) with both. `wavelength_nm` applies to files without
    wavelengths (default 633 nm). `power` is the power of each ray or, for files with powers, a factor on them (default
    1).

    >>> from pathlib import Path
    >>> import rayweave.optics as ro
    >>> _ = Path("rays.csv").write_text("ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n")
    >>> len(ro.source_from_file("rays.csv"))
    1
    """
    compiled = _core.LightSource.from_file(path)
    if wavelength_nm is not None:
        compiled = compiled.with_spectrum(_spectrum(wavelength_nm))
    return Source(_powered(compiled, 1.0 if power is None else power))


def _flat(given: ArrayLike, name: str) -> NDArray[np.float64]:
    """The rows of a grid of vectors; other shapes are checked where they are used."""
    rows = array(given, name)
    return rows.reshape(-1, 3) if rows.ndim > 2 and rows.shape[-1] == 3 else rows


def _column(given: Any, name: str) -> list[float] | None:
    """A column with a number for each ray; None for a single number, a spectrum or a total."""
    if isinstance(given, dict) or (isinstance(given, tuple) and any(isinstance(part, str) for part in given)):
        return None
    column = array(given, name)
    return column.ravel().tolist() if column.ndim > 0 else None


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
