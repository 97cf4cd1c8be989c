"""Detectors: materials, surfaces, sensors, and simulation."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._drawing import Drawing
from rayweave._progress import Progress, callback, reporter
from rayweave._table import counted
from rayweave.optics._columns import Columns
from rayweave.optics._given import real, unknown, whole
from rayweave.photons._run import Hits, Run
from rayweave.photons._sources import Source
from rayweave.photons._tables import SurfaceTables

#: Planck's constant times the speed of light, in eV nm (CODATA 2018, exact).
_HC = 1239.841984332002

#: The limit of steps by default.
_MAX_STEPS = 10_000

Numbers: TypeAlias = NDArray[np.float64]
_Thing = TypeVar("_Thing", bound="_Described")
Record: TypeAlias = Literal["counts", "sequences", "steps"]

#: Whether steps and sequences are recorded, by the name of the record.
_RECORDS: dict[str, tuple[bool, bool]] = {
    "counts": (False, False),
    "sequences": (False, True),
    "steps": (True, True),
}


@dataclass(frozen=True, eq=False)
class Property:
    """A function of the photon energy: linear between its points, constant beyond them.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> index = detector.material("Crystal").refractive_index
    >>> index.name, index.at([450, 550]).round(3)
    ('RINDEX', array([1.79, 1.79]))
    """

    name: str
    """The name in GDML files, such as RINDEX."""
    energy_ev: Numbers
    """(N,) the energies in eV, ascending."""
    values: Numbers
    """(N,) the values."""
    unit: str
    """The unit of the values; "" for pure numbers."""
    _energy_mev: Numbers | None = field(default=None, repr=False)
    """The energies as the engine has them: those in eV are rounded once more."""

    @property
    def wavelength_nm(self) -> Numbers:
        """(N,) the wavelengths of the points in nm, descending."""
        return _HC / self.energy_ev

    def at(self, wavelength_nm: ArrayLike) -> Numbers:
        """The values at wavelengths in nm."""
        wavelengths = np.asarray(wavelength_nm, float)
        if not np.all(wavelengths > 0.0):
            raise _core.RayweaveError("wavelength_nm has entries that are not positive: wavelengths are greater than 0.")
        return np.asarray(np.interp(_HC / wavelengths, self.energy_ev, self.values))

    def plot(self) -> Drawing:
        """The values by wavelength."""
        return _plot(self.name, [self])

    def _points(self) -> list[float]:
        """Energies in MeV and values in turn."""
        energies = self.energy_ev * 1e-6 if self._energy_mev is None else self._energy_mev
        points: list[float] = np.stack([energies, self.values], axis=1).ravel().tolist()
        return points

    def _curve(self) -> tuple[str, list[tuple[float, float]]]:
        """The name with the unit, and points of the curve: it is not straight in the wavelength."""
        nodes = self.wavelength_nm
        grid = np.union1d(np.linspace(nodes.min(), nodes.max(), 201), nodes)
        name = f"{self.name} / {self.unit}" if self.unit else self.name
        return name, np.stack([grid, self.at(grid)], axis=1).tolist()


@dataclass(frozen=True, eq=False)
class _Described:
    name: str
    """The name."""
    properties: Mapping[str, Property] = field(repr=False)
    """The properties that depend on the energy, by their names in GDML files."""
    constants: Mapping[str, float] = field(repr=False)
    """The constant properties, by their names in GDML files."""

    def __str__(self) -> str:
        """The properties with their ranges, and the constants."""
        lines = [f"{type(self).__name__} {self.name}"]
        for name, own in self.properties.items():
            low, high = (f"{end:.6g}" for end in (own.values.min(), own.values.max()))
            values = (low if low == high else f"{low} to {high}") + (f" {own.unit}" if own.unit else "")
            nm = own.wavelength_nm
            lines.append(f"  {name}: {values}, {nm.min():.6g} to {nm.max():.6g} nm, {counted(nm.size, 'point')}")
        lines += [f"  {name}: {value:.6g}" for name, value in self.constants.items()]
        return "\n".join(lines)

    def plot(self) -> Drawing:
        """The properties by wavelength, each in a panel of its own; positive values of more than three decades on a logarithmic axis."""
        return _plot(self.name, self.properties.values())


@dataclass(frozen=True, eq=False)
class Material(_Described):
    """A material with its optical properties.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> crystal = detector.material("Crystal")
    >>> crystal.absorption_length.unit, float(crystal.absorption_length.values[0])
    ('mm', 400.0)
    >>> print(crystal)
    Material Crystal
      RINDEX: 1.79, 309.96 to 826.561 nm, 2 points
      GROUPVEL: 167.482 mm/ns, 309.96 to 826.561 nm, 2 points
      ABSLENGTH: 400 mm, 309.96 to 826.561 nm, 2 points
    """

    @property
    def refractive_index(self) -> Property | None:
        """RINDEX; photons end in materials without it."""
        return self.properties.get("RINDEX")

    @property
    def group_velocity(self) -> Property | None:
        """GROUPVEL in mm/ns; derived from RINDEX where the file does not state it."""
        return self.properties.get("GROUPVEL")

    @property
    def absorption_length(self) -> Property | None:
        """ABSLENGTH in mm."""
        return self.properties.get("ABSLENGTH")

    @property
    def rayleigh_length(self) -> Property | None:
        """RAYLEIGH in mm, stated or derived from the compressibility."""
        return self.properties.get("RAYLEIGH")


    @property
    def scintillation(self) -> tuple[ScintillationComponent, ...]:
        """The components of scintillation; the spectrum `("scintillation", material)` of a source emits their light."""
        numbers = [k for k in (1, 2, 3) if f"SCINTILLATIONCOMPONENT{k}" in self.properties]
        return tuple(
            ScintillationComponent(
                self.properties[f"SCINTILLATIONCOMPONENT{k}"],
                self.constants.get(f"SCINTILLATIONTIMECONSTANT{k}"),
                self.constants[f"SCINTILLATIONRISETIME{k}"],
                self.constants[f"SCINTILLATIONYIELD{k}"],
            )
            for k in numbers
        )


@dataclass(frozen=True, eq=False)
class ScintillationComponent:
    """A component of the scintillation of a material.

    >>> import numpy as np
    >>> import rayweave.photons as rp
    >>> spectrum = rp.Property("SCINTILLATIONCOMPONENT1", np.array([2.7, 2.95, 3.2]), np.array([0.0, 1.0, 0.0]), "")
    >>> rp.ScintillationComponent(spectrum, time_ns=40.0, rise_time_ns=0.0, share=1.0).time_ns
    40.0
    """

    spectrum: Property
    """SCINTILLATIONCOMPONENT: the density per energy is constant between two points, the mean of their values, as in Geant4."""
    time_ns: float | None
    """SCINTILLATIONTIMECONSTANT in ns; None if the file has none."""
    rise_time_ns: float
    """SCINTILLATIONRISETIME in ns."""
    share: float
    """SCINTILLATIONYIELD: the relative number of photons."""


@dataclass(frozen=True, eq=False)
class Surface(_Described):
    """An optical surface.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> cathode = detector.surface("Cathode")
    >>> cathode.type, float(cathode.efficiency.at(550))
    ('dielectric_metal', 0.3)
    """

    model: str
    """The model of the microfacets, such as unified."""
    finish: str
    """The finish, such as groundfrontpainted."""
    type: str
    """dielectric_dielectric, dielectric_metal or another type of GDML files."""
    value: float
    """The standard deviation of the facet angles in radians of the unified model, the polish of the glisur model."""

    @property
    def reflectivity(self) -> Property | None:
        """REFLECTIVITY: 1 minus the fraction that is lost at the surface."""
        return self.properties.get("REFLECTIVITY")

    @property
    def efficiency(self) -> Property | None:
        """EFFICIENCY: the probability that an absorbed photon is detected."""
        return self.properties.get("EFFICIENCY")


class Findings(Columns):
    """Probable mistakes in the optical part of a detector: `kind`, "optical" for a probable mistake and "unused" for input without
    effect; `place`, as file:line:column (line:column for a text), None if it is not known; `text`, the problem with its reason and a suggestion.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> findings = detector.check()
    >>> findings.rows, findings["kind"].tolist()
    (1, ['optical'])
    """

    def __init__(self, rows: Sequence[tuple[str, str | None, str]]) -> None:
        names = ("kind", "place", "text")
        super().__init__({name: np.array([row[k] for row in rows], object) for k, name in enumerate(names)})

    def __str__(self) -> str:
        return "no findings" if not self.rows else "\n".join(f"{kind}: {'' if place is None else f'{place}: '}{text}" for kind, place, text in self._rows())

    def _rows(self) -> Iterator[tuple[str, str | None, str]]:
        return zip(*(self[name].tolist() for name in ("kind", "place", "text")), strict=True)


class Detector:
    """A detector: exact geometry with optical materials, surfaces and sensors. `load` and `loads` make detectors.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> run = detector.simulate(rp.point([0, 0, 0], 550), n=1000)
    >>> run.photons, sum(run.ends.values())
    (1000, 1000)
    """

    def __init__(
        self,
        compiled: _core.CompiledDetector,
        name: str,
        text: str = "",
        tables: SurfaceTables | None = None,
        *,
        parameters: dict[str, float | str] | None = None,
        is_native: bool = False,
    ) -> None:
        self.compiled = compiled
        self._made_of = text, tables, name, parameters, is_native
        self.name = name
        self.materials = tuple(Material(*_described(row)) for row in compiled.materials())
        """The materials; the first one is that of the world outside of all volumes."""
        self.surfaces = tuple(
            Surface(*_described(row), *words, value) for words, value, row in compiled.surfaces()
        )
        """The optical surfaces, in the order of the file."""

    def __repr__(self) -> str:
        return (
            f"<Detector {self.name}: {len(self.materials)} materials, {len(self.surfaces)} surfaces, "
            f"{len(self.sensors)} sensitive volumes>"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        # the text of the file: a model converted from it would have other names of volumes
        return _again, self._made_of

    @property
    def sensors(self) -> dict[str, str]:
        """The names of the sensitive volumes, and of their sensors (auxiliary tag SensDet)."""
        return dict(self.compiled.sensors)

    @property
    def notes(self) -> list[str]:
        """The ignored properties and surfaces, one sentence each."""
        return self.compiled.notes

    @property
    def warnings(self) -> list[str]:
        """The warnings of the reader of the file, energies that are not those of light, and border surfaces that name no placement or
        one of several with the same name."""
        return [*self.compiled.warnings, *self.compiled.optical_warnings]

    def check(self) -> Findings:
        """The probable mistakes in the optical part of the file, in the order of the rules: the findings `optical` and `unused` of the
        command `rayweave check`. The page "Photons: physics and conventions" lists the rules.

        Examples
        --------
        >>> import rayweave.photons
        >>> detector = rayweave.photons.load("bar.gdml")  # doctest: +SKIP
        >>> print(detector.check())  # doctest: +SKIP
        optical: bar.gdml:12:5: ...
        """
        return Findings(self.compiled.findings())

    def check_source(self, source: Source, *, seed: int = 0, event: int = 0) -> str | None:
        """A note about photons of a source that start outside the world or in a material without RINDEX, where they end at once; None
        if there are none. The first 1,000 photons are examined; if all of them start there, the call raises an error."""
        count = 1000 if source.count is None else min(source.count, 1000)
        settings = _settings(seed, event, "both", 1, np.inf, "delta", None, None, "cpu")
        return self.compiled.check_start(source.compiled, settings | {"range": (0, count)})

    def material(self, name: str) -> Material:
        """The material of a name."""
        return _named(self.materials, "material", name)

    def surface(self, name: str) -> Surface:
        """The optical surface of a name."""
        return _named(self.surfaces, "surface", name)

    def simulate(
        self,
        source: Source,
        n: int | None = None,
        *,
        range: tuple[int, int] | range | None = None,
        seed: int = 0,
        detect: Literal["both", "efficiency", "volume"] = "both",
        max_steps: int = 10_000,
        max_time: float = np.inf,
        wls_time_profile: Literal["delta", "exponential"] = "delta",
        record: Record | None = None,
        event: int = 0,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
        progress: Progress = None,
    ) -> Run:
        """Simulates photons until each of them ends. A source whose first 1,000 photons all start outside the world or in a material
        without RINDEX is an error.

        A photon is a function of the detector, the source, the seed, the event and its number: `threads`, `device`, `record` and `range`
        do not change it.

        Parameters
        ----------
        source
            The source.
        n
            The number of photons of the run; by default that of the source.
        range
            The photons of the run to simulate, from the first number up to the second one exclusively.
        seed
            The seed of all random numbers.
        detect
            The events that count as detection: absorption at a surface with the probability EFFICIENCY, entering a sensitive
            volume, or both.
        max_steps
            The maximum number of steps of a photon.
        max_time
            The maximum time of a photon in ns.
        wls_time_profile
            The times of wavelength shifters: always WLSTIMECONSTANT (Geant4's default), or exponential with it as the mean.
        record
            The histories to record: "counts" of processes and surfaces; "sequences" of Opticks' flags, with counts; or all
            "steps", with both.
        event
            The number of the event, from 0 to 2^32 - 1: photons of different events have different random numbers, and the
            column `event` of the hits tells them apart.
        threads
            The number of threads; by default RAYWEAVE_THREADS or the number of cores.
        device
            The CPU, a graphics card ("gpu"; in packages built with it), or a graphics card if there is one that can hold the
            detector ("auto"). All give the same photons, bit for bit; histories are recorded by the CPU alone.
        progress
            Called with the number of finished photons and the total; True draws a bar on standard error.

        Examples
        --------
        >>> import rayweave.photons
        >>> detector = rayweave.photons.load("bar.gdml")  # doctest: +SKIP
        >>> source = rayweave.photons.point([0, 0, 0], 550)
        >>> run = detector.simulate(source, n=100_000, seed=1)  # doctest: +SKIP
        >>> run.hits.save("hits.parquet")  # doctest: +SKIP
        """
        first, last = self._numbers(source, n, range)
        settings = _settings(seed, event, detect, max_steps, max_time, wls_time_profile, record, threads, device)
        start = self.check_source(source, seed=seed, event=event)
        run = self._run(source, (first, last), settings, progress)
        notes = [start] if start else []
        doubts = notes.copy()
        # a lower limit of steps is a choice
        if max_steps >= _MAX_STEPS:
            mistakes = self._mistakes(run)
            notes += run.compiled.notes(mistakes)
            doubts += run.compiled.notes(mistakes, few=False)
        run.notes = tuple(notes)
        for note in doubts:
            warnings.warn(note, stacklevel=2)
        return run

    def _mistakes(self, run: Run) -> int | None:
        """The number of probable mistakes in the detector, for a run that has many photons and no hits."""
        # a world without sensors detects nothing
        if not run.compiled.is_dark or not run.hits.sensor_paths:
            return None
        return sum(kind == "optical" for kind, _, _ in self.compiled.findings())

    def read_hits(self, path: str | PathLike[str]) -> Hits:
        """Reads a table of hits of this detector that `Hits.save`, the command `rayweave photons` or `rayweave merge` wrote: .csv, or
        .npy with the file of names beside it.

        >>> import rayweave.photons as rp
        >>> detector = rp.load("bar.gdml")
        >>> run = detector.simulate(rp.point([0, 0, 0], 550), n=1000)
        >>> run.hits.save("hits.npy")
        >>> detector.read_hits("hits.npy") == run.hits
        True
        """
        file = Path(path)
        if file.suffix.lower() == ".parquet":
            raise _core.RayweaveError(
                f"{file} cannot be read as hits: they are read from .csv and .npy. "
                "Read it by pandas.read_parquet, or save the hits as .npy."
            )
        return Hits(self.compiled.read_hits(file), self.name)

    def stream(
        self,
        source: Source,
        n: int | None = None,
        *,
        chunk: int = 1 << 18,
        range: tuple[int, int] | range | None = None,
        seed: int = 0,
        detect: Literal["both", "efficiency", "volume"] = "both",
        max_steps: int = 10_000,
        max_time: float = np.inf,
        wls_time_profile: Literal["delta", "exponential"] = "delta",
        record: Record | None = None,
        event: int = 0,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
        progress: Progress = None,
    ) -> Iterator[Run]:
        """Simulates photons in runs of `chunk` photons each, in memory that does not grow with their number. The runs, one after
        the other, hold the photons of `simulate` with the same arguments.

        Examples
        --------
        >>> for run in detector.stream(source, n=10**9):  # doctest: +SKIP
        ...     total += len(run.hits["photon"])
        """
        first, last = self._numbers(source, n, range)
        size = whole(chunk, "chunk", least=1)
        settings = _settings(seed, event, detect, max_steps, max_time, wls_time_profile, record, threads, device)
        start = self.check_source(source, seed=seed, event=event)
        if start:
            warnings.warn(start, stacklevel=2)
        return self._stream(source, (first, last), size, settings, progress)

    def _stream(
        self,
        source: Source,
        numbers: tuple[int, int],
        size: int,
        settings: dict[str, Any],
        progress: Progress,
    ) -> Iterator[Run]:
        first, last = numbers
        tell = reporter(progress)
        while first < last:
            end = min(first + size, last)
            begin = first
            run = self._run(
                source,
                (first, end),
                settings,
                None if progress is None else lambda done, _: tell(begin - numbers[0] + done, last - numbers[0]),
            )
            first = end
            yield run

    def _run(
        self, source: Source, numbers: tuple[int, int], settings: dict[str, Any], progress: Progress
    ) -> Run:
        compiled = self.compiled.simulate(source.compiled, settings | {"range": numbers}, callback(progress))
        return Run(compiled, self.name)

    def _numbers(self, source: Source, n: int | None, range: Any) -> tuple[int, int]:
        """The numbers of the photons of a run."""
        if not isinstance(source, Source):
            raise TypeError(f"source is {source!r}: a Source is needed. rayweave.photons.point and photons make one.")
        if n is None:
            if source.count is None:
                raise _core.RayweaveError("n is missing: the source has no number of photons of its own.")
            n = source.count
        count = whole(n, "n", bits=62)
        if range is None:
            return 0, count
        first, last = _ends(range)
        if not first <= last <= count:
            raise _core.RayweaveError(f"range is ({first}, {last}): the run has the photons 0 to {count}.")
        return first, last


def load(
    path: str | PathLike[str],
    *,
    tables: SurfaceTables | None = None,
    parameters: Mapping[str, float | str] | None = None,
    allow: Sequence[str | PathLike[str]] = (),
    strict: bool = False,
    allow_missing: bool = False,
) -> Detector:
    """Reads a detector from a GDML file, or from a native model with optical properties.

    The file may read others in its folder and below, and the files and folders in `allow`. With `strict`, warnings of the reader
    are errors. All invalid properties are reported at once. `tables` are those of measured surfaces. `parameters` replace the values
    of constants, variables and quantities of a GDML file, or of parameters of a native model, by numbers or arithmetic text. Refused
    solids and undefined references are errors, unless `allow_missing` accepts the remaining parts.

    Examples
    --------
    >>> import rayweave.photons
    >>> detector = rayweave.photons.load("bar.gdml")
    >>> detector.material("Crystal").refractive_index.at([400, 550])
    array([1.79, 1.79])
    """
    given = None if parameters is None else dict(parameters)
    compiled = _core.load_detector(
        path, _tables(tables), given, allow=list(allow), strict=strict, allow_missing=allow_missing
    )
    file = Path(path)
    kept = file.read_text(encoding="utf-8", errors="surrogateescape")
    made = Detector(compiled, file.name, kept, tables, parameters=given, is_native=file.suffix.lower() != ".gdml")
    for text in made.warnings:
        warnings.warn(text, stacklevel=2)
    return made


def loads(
    text: str,
    *,
    tables: SurfaceTables | None = None,
    parameters: Mapping[str, float | str] | None = None,
    allow: Sequence[str | PathLike[str]] = (),
    strict: bool = False,
    allow_missing: bool = False,
) -> Detector:
    """As `load`, from the text of a GDML file or of a native model. Names of files are relative to the current folder.

    >>> from pathlib import Path
    >>> import rayweave.photons as rp
    >>> rp.loads(Path("bar.gdml").read_text()).material("Crystal").name
    'Crystal'
    """
    # XML begins with an angle bracket, which no native model does
    is_native = not text.lstrip("\ufeff \t\r\n").startswith("<")
    given = None if parameters is None else dict(parameters)
    compiled = _core.loads_detector(
        text,
        _tables(tables),
        given,
        allow=list(allow),
        strict=strict,
        allow_missing=allow_missing,
        native=is_native,
    )
    made = Detector(compiled, "detector", text, tables, parameters=given, is_native=is_native)
    for warning in made.warnings:
        warnings.warn(warning, stacklevel=2)
    return made


def _again(
    text: str,
    tables: SurfaceTables | None,
    name: str,
    parameters: dict[str, float | str] | None,
    is_native: bool,
) -> Detector:
    """A detector from its pickled parts. Other files that the text names must be in the current folder or below."""
    compiled = _core.loads_detector(text, _tables(tables), parameters, allow_missing=True, native=is_native)
    return Detector(compiled, name, text, tables, parameters=parameters, is_native=is_native)


def _tables(tables: SurfaceTables | None) -> _core.PhotonTables:
    if tables is not None and not isinstance(tables, SurfaceTables):
        raise TypeError(f"tables is {tables!r}: it must be a rayweave.photons.SurfaceTables.")
    return (SurfaceTables() if tables is None else tables).compiled


def _plot(title: str, properties: Iterable[Property]) -> Drawing:
    return Drawing(_core.photon_property_svg(title, [own._curve() for own in properties]))


def _settings(
    seed: int,
    event: int,
    detect: str,
    max_steps: int,
    max_time: float,
    wls_time_profile: str,
    record: Record | None,
    threads: int | None,
    device: str,
) -> dict[str, Any]:
    if record is not None and record not in _RECORDS:
        unknown("record", record, _RECORDS)
    return {
        "seed": whole(seed, "seed"),
        "event": whole(event, "event", bits=32),
        "detect": detect,
        "max_steps": whole(max_steps, "max_steps", bits=32),
        "max_time": real(max_time, "max_time"),
        "wls_time_profile": wls_time_profile,
        "threads": None if threads is None else whole(threads, "threads", least=1),
        "record": None if record is None else _RECORDS[record],
        "device": device,
    }


def _ends(numbers: Any) -> tuple[int, int]:
    """The first and the last number of a range or a pair."""
    if isinstance(numbers, type(range(0))):
        if numbers.step != 1:
            raise _core.RayweaveError(f"range is {numbers!r}: its step must be 1.")
        return numbers.start, max(numbers.start, numbers.stop)
    try:
        first, last = numbers
    except (TypeError, ValueError):
        raise TypeError(f"range is {numbers!r}: a pair of numbers is needed.") from None
    return whole(first, "range[0]", bits=62), whole(last, "range[1]", bits=62)


def _described(row: Any) -> tuple[str, dict[str, Property], dict[str, float]]:
    name, properties, constants = row
    tables = {key: Property(key, energies * 1e6, values, unit, energies) for key, energies, values, unit in properties}
    return name, tables, dict(constants)


def _named(things: Sequence[_Thing], kind: str, name: str) -> _Thing:
    for thing in things:
        if thing.name == name:
            return thing
    unknown(kind, name, [thing.name for thing in things])
