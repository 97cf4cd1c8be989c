"""Sources of photons."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rayweave import _core
from rayweave import optics
from rayweave._recipe import record_all, reduced
from rayweave.optics._given import array, numbers, real, text, unknown, vector, whole
from rayweave.optics._sources import _SPECTRA, Spectrum, _spectrum

if TYPE_CHECKING:
    from rayweave.photons._detector import Detector, Material

    #: Wavelengths: a spectrum of `rayweave.optics`, or the scintillation light of a material.
    _Wavelengths: TypeAlias = Spectrum | tuple[Literal["scintillation"], Material]

#: A time, or the ends of an interval.
Time = float | tuple[float, float]


class Source:
    """A source of numbered photons. Each photon depends only on the seed, the event and its number. `point`, `disc`, `line`,
    `surface`, `volume`, `gensteps`, `photons`, `from_opticks` and `from_optics` make sources.

    >>> import rayweave.photons as rp
    >>> rp.point([0, 0, 0], 550)
    <Source: point, 550 nm>
    """

    def __init__(self, compiled: _core.PhotonSource, description: str) -> None:
        self.compiled = compiled
        self._description = description

    @property
    def count(self) -> int | None:
        """The number of photons; None for sources of any number."""
        return self.compiled.count

    @property
    def notes(self) -> list[str]:
        """Numbers of Cerenkov photons in gensteps that the RINDEX of their material does not explain, one sentence each."""
        return self.compiled.notes

    def __repr__(self) -> str:
        return f"<Source: {self._description}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return reduced(self)


def _compiled(detector: Detector) -> _core.CompiledDetector:
    """The compiled detector."""
    compiled = getattr(detector, "compiled", None)
    if not isinstance(compiled, _core.CompiledDetector):
        raise TypeError(f"detector is of type {type(detector).__name__}: it must be a Detector. Read one with load(path).")
    return compiled


def _distribution(wavelength_nm: _Wavelengths) -> tuple[str, list[float], str]:
    """The kind of a spectrum, its numbers, and the name of its material."""
    given: Any = wavelength_nm
    if not (isinstance(given, tuple) and given[:1] == ("scintillation",)):
        if isinstance(given, (tuple, list)) and given and isinstance(given[0], str) and given[0] not in _SPECTRA:
            unknown("spectrum", given[0], [*_SPECTRA, "scintillation"])
        return *_spectrum(given), ""
    material: Any = given[1] if len(given) == 2 else None
    components = getattr(material, "scintillation", None)
    if components is None:
        needed = '("scintillation", detector.material(name))'
        raise TypeError(f"wavelength_nm is {wavelength_nm!r}: scintillation needs a material, as in {needed}.")
    values: list[float] = []
    for number, own in enumerate(components, 1):
        points, time = own.spectrum._points(), float("nan") if own.time_ns is None else own.time_ns
        values += [number, time, own.rise_time_ns, own.share, len(points) // 2, *points]
    return "scintillation", values, material.name


def _light(
    wavelength_nm: _Wavelengths,
    towards: ArrayLike | None,
    cone_degrees: float,
    polarisation: ArrayLike | None,
    time: Time,
    time_deviation: float,
    time_decay: float,
) -> dict[str, Any]:
    """The light of a torch, wherever it starts."""
    if towards is None and cone_degrees != 0.0:
        raise _core.RayweaveError("cone_degrees is given without towards: a cone needs the direction of its axis.")
    if isinstance(time, (tuple, list, np.ndarray)):
        interval = tuple(numbers(time, "time"))
        if len(interval) != 2:
            raise _core.RayweaveError(f"time has {len(interval)} numbers: it must be a time, or the two ends of an interval.")
    else:
        interval = (real(time, "time", "a time, or the two ends of an interval"),) * 2
    return {
        "spectrum": _distribution(wavelength_nm),
        "towards": None if towards is None else vector(towards, "towards"),
        "cone_degrees": real(cone_degrees, "cone_degrees"),
        "polarisation": None if polarisation is None else vector(polarisation, "polarisation"),
        "time": interval,
        "time_deviation": real(time_deviation, "time_deviation"),
        "time_decay": real(time_decay, "time_decay"),
    }


def _named(light: Mapping[str, Any]) -> str:
    kind, values, material = light["spectrum"]
    if kind == "scintillation":
        return f"scintillation of {material}"
    if kind == "line":
        return f"{values[0]:g} nm"
    if kind == "table":
        return f"{min(values[::2]):g} to {max(values[::2]):g} nm"
    return f"{kind}, {values[-2]:g} to {values[-1]:g} nm"


def point(
    position: ArrayLike,
    wavelength_nm: _Wavelengths,
    *,
    towards: ArrayLike | None = None,
    cone_degrees: float = 0.0,
    polarisation: ArrayLike | None = None,
    time: Time = 0.0,
    time_deviation: float = 0.0,
    time_decay: float = 0.0,
) -> Source:
    """A point that emits photons. `disc`, `line`, `surface` and `volume` have the same keyword arguments.

    Parameters
    ----------
    position
        (3,), in mm.
    wavelength_nm
        The wavelength in vacuum, in nm; or a spectrum, as in `rayweave.optics`: ("uniform", lo, hi), the same density between two
        wavelengths; ("black body", kelvin, lo, hi), the photons of a black body between them; ("table", w1, p1, w2, p2, ..), densities
        p per nm at wavelengths w, with straight lines between. ("scintillation", detector.material(name)) is the scintillation light of
        a material: its spectra, which are constant between their points, as in Geant4, and its times, which are added to `time`.
    towards
        (3,), the direction of all photons; by default all directions with equal probability.
    cone_degrees
        The largest angle between a photon and `towards`, from 0 to 180; all directions within have equal probability.
    polarisation
        (3,): photons are polarised along the part of this vector that is perpendicular to their direction; by default at random.
    time
        The time of emission in ns, or the ends of an interval, in which all times have equal probability.
    time_deviation
        The standard deviation in ns of a normal time that is added.
    time_decay
        The mean in ns of an exponential time that is added.

    Examples
    --------
    >>> import rayweave.photons
    >>> rayweave.photons.point([0, 0, 0], 420, towards=[0, 0, 1])
    <Source: point, 420 nm>
    >>> rayweave.photons.point([0, 0, 0], ("black body", 3000, 400, 700), time_decay=6)
    <Source: point, black body, 400 to 700 nm>
    """
    light = _light(wavelength_nm, towards, cone_degrees, polarisation, time, time_deviation, time_decay)
    return Source(_core.PhotonSource.point(position, light), f"point, {_named(light)}")


def disc(
    centre: ArrayLike,
    radius: float,
    wavelength_nm: _Wavelengths,
    *,
    normal: ArrayLike | None = None,
    towards: ArrayLike | None = None,
    cone_degrees: float = 0.0,
    polarisation: ArrayLike | None = None,
    time: Time = 0.0,
    time_deviation: float = 0.0,
    time_decay: float = 0.0,
) -> Source:
    """A flat disc: photons start with equal probability per area.

    `centre` (3,) and `radius` are in mm. `normal` (3,) is by default `towards`. The other arguments are those of `point`.

    Examples
    --------
    >>> import rayweave.photons
    >>> rayweave.photons.disc([0, 0, -20], 5, ("uniform", 400, 500), towards=[0, 0, 1])
    <Source: disc, uniform, 400 to 500 nm>
    """
    axis = towards if normal is None else normal
    if axis is None:
        raise _core.RayweaveError("normal is missing: a disc needs a normal, or a direction towards.")
    light = _light(wavelength_nm, towards, cone_degrees, polarisation, time, time_deviation, time_decay)
    compiled = _core.PhotonSource.disc(centre, axis, real(radius, "radius"), light)
    return Source(compiled, f"disc, {_named(light)}")


def line(
    start: ArrayLike,
    end: ArrayLike,
    wavelength_nm: _Wavelengths,
    *,
    towards: ArrayLike | None = None,
    cone_degrees: float = 0.0,
    polarisation: ArrayLike | None = None,
    time: Time = 0.0,
    time_deviation: float = 0.0,
    time_decay: float = 0.0,
) -> Source:
    """A straight line: photons start with equal probability per length between two points (3,) in mm. The other arguments are
    those of `point`.

    Examples
    --------
    >>> import rayweave.photons
    >>> rayweave.photons.line([0, 0, -20], [0, 0, 20], 420)
    <Source: line, 420 nm>
    """
    light = _light(wavelength_nm, towards, cone_degrees, polarisation, time, time_deviation, time_decay)
    return Source(_core.PhotonSource.line(start, end, light), f"line, {_named(light)}")


def volume(
    detector: Detector,
    name: str,
    wavelength_nm: _Wavelengths,
    *,
    towards: ArrayLike | None = None,
    cone_degrees: float = 0.0,
    polarisation: ArrayLike | None = None,
    time: Time = 0.0,
    time_deviation: float = 0.0,
    time_decay: float = 0.0,
) -> Source:
    """A volume of a detector: photons start with equal probability per volume in all copies of the volume `name`, without its
    daughters. The other arguments are those of `point`.

    `name` may also be the end of a path as in `hits.sensor_paths`, and selects all copies whose paths end with it: "Crystal[3]" is the
    crystal with the copy number 3, in every module if there are several; "Module[1]/Crystal" are all crystals of one module.

    Examples
    --------
    >>> import rayweave.photons
    >>> detector = rayweave.photons.load("bar.gdml")
    >>> rayweave.photons.volume(detector, "Bar", 420, time_decay=6)
    <Source: volume Bar, 420 nm>
    """
    light = _light(wavelength_nm, towards, cone_degrees, polarisation, time, time_deviation, time_decay)
    compiled = _compiled(detector).volume_source(text(name, "name"), False, light)
    return Source(compiled, f"volume {name}, {_named(light)}")


def surface(
    detector: Detector,
    name: str,
    wavelength_nm: _Wavelengths,
    *,
    towards: ArrayLike | None = None,
    cone_degrees: float = 0.0,
    polarisation: ArrayLike | None = None,
    time: Time = 0.0,
    time_deviation: float = 0.0,
    time_decay: float = 0.0,
) -> Source:
    """The boundary of a volume of a detector: photons start with equal probability per area, 1 nm inside the volume `name`, on its
    faces towards its mother and its daughters. The other arguments are those of `point`, and `name` may be a path as that of
    `volume`.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> source = rp.surface(detector, "Bar", 550)
    >>> source
    <Source: surface Bar, 550 nm>
    """
    light = _light(wavelength_nm, towards, cone_degrees, polarisation, time, time_deviation, time_decay)
    compiled = _compiled(detector).volume_source(text(name, "name"), True, light)
    return Source(compiled, f"surface {name}, {_named(light)}")


def gensteps(detector: Detector, steps: ArrayLike, *, materials: Mapping[int, str] | None = None) -> Source:
    """Cerenkov and scintillation photons along the steps of charged particles that another program has simulated.

    The photons are numbered through the gensteps in their order, and hits have the column `genstep`.

    Parameters
    ----------
    detector
        The detector, whose materials emit the photons.
    steps
        (N, 6, 4), float32: the layout of Opticks, in which the bits of some numbers are integers; or (N, 16): the fields of Geant4
        11.4. The page "Photons: files" lists them.
    materials
        The names of materials by their numbers in the gensteps. A number without a name stands for the material that the middle of
        all its steps is in.

    Examples
    --------
    >>> import numpy as np
    >>> import rayweave.photons
    >>> steps = np.load("gensteps.npy")  # doctest: +SKIP
    >>> source = rayweave.photons.gensteps(detector, steps, materials={3: "Water"})  # doctest: +SKIP
    """
    given = {} if materials is None else dict(materials)
    names = {whole(number, "a number in materials", bits=32): text(name, f"materials[{number}]") for number, name in given.items()}
    compiled = _compiled(detector).gensteps(steps, names)
    return Source(compiled, f"{compiled.count} photons of gensteps")


def from_opticks(photons: ArrayLike) -> Source:
    """Photons in the layout of Opticks (`sphoton.h`), (N, 4, 4): position in mm and time in ns; direction and weight; polarisation
    and wavelength in nm; flags. Weights and flags are not used, and a polarisation of 0, 0, 0 means a random one.

    >>> import rayweave.photons as rp
    >>> import numpy as np
    >>> photons = np.zeros((1, 4, 4), np.float32)
    >>> photons[0, 1, 2], photons[0, 2, 0], photons[0, 2, 3] = 1, 1, 550
    >>> rp.from_opticks(photons).count
    1
    """
    compiled = _core.PhotonSource.from_opticks(photons)
    return Source(compiled, f"{compiled.count} photons")


def from_optics(light: optics.Source, n: int) -> Source:
    """`n` unpolarised photons of a source of `rayweave.optics`, whose lengths are taken as mm, at time 0.

    The number of photons of a ray is proportional to its power times its wavelength, to within one. The photons are in the order of
    the rays; all photons of a ray have the same start, direction and wavelength.

    Examples
    --------
    >>> import rayweave.photons
    >>> from rayweave import optics
    >>> lamp = optics.point_source(20, 500, wavelength_nm=420).translate([0, 0, -20])
    >>> rayweave.photons.from_optics(lamp, 10_000)
    <Source: 10000 photons>
    """
    if not isinstance(light, optics.Source):
        raise TypeError(f"light is {light!r}: it must be a source of rayweave.optics.")
    if light.is_polarised:
        raise _core.RayweaveError("the light is polarised: only sources of unpolarised light can be converted. Give photons instead.")
    origins, directions, wavelengths, powers = light.rays()
    upto = np.cumsum(powers * wavelengths)
    if not (upto.size and np.isfinite(upto[-1]) and upto[-1] > 0.0):
        raise _core.RayweaveError("the light has no power: no photon would start.")
    count = whole(n, "n", least=1, bits=32)
    # photon k stands for the share from k / n to (k + 1) / n of all photons
    rays = np.searchsorted(upto, (np.arange(count) + 0.5) / count * upto[-1])
    return photons(origins[rays], directions[rays], wavelengths_nm=wavelengths[rays])


def photons(
    positions: ArrayLike,
    directions: ArrayLike,
    *,
    wavelengths_nm: ArrayLike,
    polarisations: ArrayLike | None = None,
    times: ArrayLike = 0.0,
) -> Source:
    """Given photons, one for each row; arguments of one row hold for all photons.

    Parameters
    ----------
    positions
        (N, 3) or (3,), in mm.
    directions
        (N, 3) or (3,), of any length but 0.
    wavelengths_nm
        (N,) or a number: the wavelengths in vacuum, in nm.
    polarisations
        (N, 3) or (3,); only the part across the direction counts. By default a random one for each photon.
    times
        (N,) or a number, in ns.

    Examples
    --------
    >>> import numpy as np
    >>> import rayweave.photons
    >>> x = np.linspace(-1, 1, 5)
    >>> rayweave.photons.photons(np.stack([x, 0 * x, 0 * x], axis=1), [0, 0, 1], wavelengths_nm=420)
    <Source: 5 photons>
    """
    vectors: dict[str, Any] = {"positions": array(positions, "positions"), "directions": array(directions, "directions")}
    if polarisations is not None:
        vectors["polarisations"] = array(polarisations, "polarisations")
    scalars = {"wavelengths_nm": array(wavelengths_nm, "wavelengths_nm"), "times": array(times, "times")}
    for name, given in vectors.items():
        if given.ndim not in (1, 2) or given.shape[-1] != 3:
            raise _core.RayweaveError(f"{name} has shape {given.shape}: (N, 3) or (3,) is needed.")
    for name, given in scalars.items():
        if given.ndim > 1:
            raise _core.RayweaveError(f"{name} has shape {given.shape}: (N,) or a number is needed.")
    rows = [given.shape[0] for given in vectors.values() if given.ndim == 2]
    rows += [given.shape[0] for given in scalars.values() if given.ndim == 1]
    count = rows[0] if rows else 1
    full = {name: np.broadcast_to(given, (count, 3)) if given.ndim == 1 else given for name, given in vectors.items()}
    flat = {name: np.broadcast_to(given, (count,)) if given.ndim == 0 else given for name, given in scalars.items()}
    compiled = _core.PhotonSource.photons(
        full["positions"], full["directions"], flat["wavelengths_nm"], flat["times"], full.get("polarisations")
    )
    return Source(compiled, f"{count} photons")


record_all(globals(), "Source")
