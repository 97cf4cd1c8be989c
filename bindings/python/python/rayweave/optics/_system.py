"""Optical systems, and the light traced in them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._core import Glass, Model, Solid
from rayweave._model import Medium, Region
from rayweave._progress import Progress, callback
from rayweave._table import Rows, dataset, table_of
from rayweave.optics._analysis import PathList, Spot, ghosts_beside, irradiance_of, paths_of, spot_of
from rayweave.optics._elements import Element, _medium, _yellow
from rayweave.optics._given import all_of, array, flag, package, real, text, unknown, whole
from rayweave.optics._plot import Plot, one_axes
from rayweave.optics._sources import Source
from rayweave.optics._stream import Stream, record_batch, write

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: The actions of sheets that change or depend on the polarisation of light.
_POLARISES = ("polariser", "retarder")

_UNIT_NM = {"nm": 1.0, "um": 1e3, "mm": 1e6, "cm": 1e7, "m": 1e9, "in": 2.54e7}


@dataclass(frozen=True)
class Balance:
    """The balance of power; `error` is the part unaccounted for, 0 except for rounding.

    Light that leaves the system is `escaped`, also after a sheet that transmits it, such as the image of a lens prescription:
    `trace.spot("image").total` is the power that passed through it.

    >>> import rayweave.optics as ro
    >>> system = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25), ro.detector(25.0).translate([0, 0, 49])])
    >>> trace = system.trace(ro.beam(10.0, 100).translate([0, 0, -10]))
    >>> round(trace.balance.emitted, 6), round(trace.balance.absorbed["detector"], 6)
    (1.0, 0.998855)
    """

    emitted: float
    absorbed: dict[str, float]
    absorbed_in_media: float
    escaped: float
    dropped: float

    @property
    def error(self) -> float:
        """The power unaccounted for: 0 except for rounding."""
        ends = sum(self.absorbed.values()) + self.absorbed_in_media + self.escaped + self.dropped
        return self.emitted - ends

    def _repr_html_(self) -> str:
        absorbed = {f"absorbed by {name}": power for name, power in self.absorbed.items()}
        rest = {"absorbed in media": self.absorbed_in_media, "escaped": self.escaped, "dropped": self.dropped}
        return table_of("Balance of power", {"emitted": self.emitted, **absorbed, **rest, "error": self.error})


class System:
    """An optical system: elements in a world, in which light is traced.

    Where solids overlap, the later one has priority; parts that touch need no gap. `world` is the medium outside all
    elements. `unit` is the unit of all lengths; it matters where wavelengths are compared with lengths.

    >>> import rayweave.optics as ro
    >>> system = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25), ro.detector(25.0).translate([0, 0, 49])])
    >>> system.element_names
    ['lens', 'detector']
    >>> trace = system.trace(ro.beam(10.0, 100).translate([0, 0, -10]))
    >>> trace.spot("detector").points.shape
    (100, 2)
    """

    def __init__(
        self,
        elements: Element | Iterable[Element | list[Element]],
        *,
        world: Glass | str | float | complex = 1.0,
        unit: Literal["nm", "um", "mm", "cm", "m", "in"] = "mm",
    ) -> None:
        flat = all_of(Element, _flat(elements), "elements", "Make one of a solid with element(solid, material).")
        if text(unit, "unit", ", ".join(_UNIT_NM)) not in _UNIT_NM:
            raise _core.RayweaveError(f"unit is {unit!r}: it can be {', '.join(_UNIT_NM)}.")
        self.elements = tuple(flat)
        self.unit: str = unit
        self._world: Any = world
        self._compiled = _core.CompiledSystem([part._part() for part in flat], _medium(world), _UNIT_NM[unit])

    @classmethod
    def _of(cls, compiled: _core.CompiledSystem, elements: list[Element], unit: str) -> System:
        system = cls.__new__(cls)
        system.elements, system.unit, system._compiled = tuple(elements), unit, compiled
        system._world = None
        return system

    def __reduce__(self) -> tuple[Any, ...]:
        if self._world is None:
            raise _core.RayweaveError("the System cannot be pickled: it was read from a model file. Pickle the name of the file.")
        return _again, (self.elements, self._world, self.unit)

    def __repr__(self) -> str:
        names = ", ".join(self.element_names[:8]) + (", ..." if len(self.element_names) > 8 else "")
        return f"<System in {self.unit}, {len(self.element_names)} elements: {names}>"

    def _repr_html_(self) -> str:
        materials = {f"{k}: {part.name}": _material_text(part) for k, part in enumerate(self.elements)}
        return table_of(f"System in {self.unit}", materials)

    def _balance(self, accounts: dict[str, Any]) -> Balance:
        absorbed = dict(zip(self.element_names, accounts["absorbed"], strict=True))
        return Balance(**(accounts | {"absorbed": absorbed}))

    @property
    def element_names(self) -> list[str]:
        """The names of the elements, by their numbers in results."""
        return self._compiled.element_names

    @property
    def surface_names(self) -> list[str]:
        """The names of the surfaces, by their numbers in results."""
        return self._compiled.surface_names

    def to_model(self) -> Model:
        """The solids of the system as a model, for pictures, sections and files. Sheets have no volume and are left out.

        A medium has the name of its material; `index` is that in yellow light, where the material has one.
        """
        regions, media = [], {}
        for element in self.elements:
            if isinstance(element.body, Solid):
                name, index = _named_material(element.material)
                media[name] = Medium(name, index)
                regions.append(Region(element.name, element.body, medium=name))
        return Model(regions, list(media.values()), unit=self.unit)

    def save(
        self, path: str | PathLike[str], *, format: str | None = None, tolerance: float | None = None, text: bool = False
    ) -> list[str]:
        """Writes the solids of the system to a file in the format of its ending: see `Model.save`. Sheets, such as stops and the
        image of a prescription, faces and light are not written; in a native file they can be added as `[optics]` tables.

        >>> import rayweave.optics as ro
        >>> _ = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25)]).save("lens.stl")
        """
        return self.to_model().save(path, format=format, tolerance=tolerance, text=text)

    def trace(
        self,
        sources: Source | Iterable[Source],
        *,
        branches: Literal["ideal", "both", "random"] = "ideal",
        polarised: bool | None = None,
        generation_limit: int = 1000,
        threshold: float = 0.0,
        keep_escaped: bool = True,
        seed: int = 0,
        threads: int | None = None,
        phases: bool = False,
        range: tuple[int, int] | None = None,
        progress: Progress = None,
    ) -> Trace:
        """Traces the light of sources through the system.

        For a model file, call `OpticalModel.trace`, which uses the settings of the file; this method does not read them.

        Parameters
        ----------
        branches
            The rays traced at faces that reflect and transmit: "ideal" refracts without Fresnel loss, or reflects totally, while
            mirrors, metals and beam splitters keep their reflectance; "both" traces both parts with their power by the Fresnel
            equations; "random" traces one of them with all the power.
        polarised
            Whether polarisation is computed; by default it is if the system has a `polariser` or a `wave_plate`, or a source emits
            `Source.polarised` light. Without it light is unpolarised at each face.
        generation_limit, threshold
            Rays end after this number of events, or below this power.
        keep_escaped
            Whether light that leaves the system has a row, with an end of NaN.
        seed
            The seed of random choices.
        threads
            The number of threads; results do not depend on it.
        phases
            Adds the columns `phase_s` and `phase_p`, for which each event is evaluated again: see `Trace.phases`.
        range
            Traces only the rays with these numbers, from the first up to the second exclusively. The rows are those of these rays in
            the trace of all, with parents counted from the first row. Both numbers are multiples of 2048 or the number of rays,
            because the rows of 2048 rays are sorted together.
        progress
            Called with the number of finished rays and the total; True draws a bar on standard error.
        """
        given = _all_sources(sources)
        is_followed = self._follows(polarised, given)
        settings = _settings(branches, is_followed, generation_limit, threshold, keep_escaped, seed, threads)
        if range is not None:
            first, last = range
            settings["rays"] = whole(first, "range[0]", bits=62), whole(last, "range[1]", bits=62)
        compiled = [source.compiled for source in given]
        columns, accounts = self._compiled.trace_sources(compiled, settings, callback(progress))
        return self._trace_of(columns, accounts, phases)

    def stream(
        self,
        sources: Source | Iterable[Source],
        *,
        rows: int = 1 << 17,
        branches: Literal["ideal", "both", "random"] = "ideal",
        polarised: bool | None = None,
        generation_limit: int = 1000,
        threshold: float = 0.0,
        keep_escaped: bool = True,
        seed: int = 0,
        threads: int | None = None,
        phases: bool = False,
        progress: Progress = None,
    ) -> Stream:
        """Traces the light of sources batch by batch, each of at least `rows` rows except the last one, in memory that
        does not grow with the number of rays. All batches together are the rows of `trace`; `polarised` and `phases`
        are as there."""
        given = _all_sources(sources)
        is_followed = self._follows(polarised, given)
        settings = _settings(branches, is_followed, generation_limit, threshold, keep_escaped, seed, threads)
        return self._stream(given, settings, rows, phases, progress)

    def _stream(
        self, given: list[Source], settings: dict[str, Any], rows: int, phases: bool, progress: Progress
    ) -> Stream:
        compiled = self._compiled.stream([source.compiled for source in given], settings, whole(rows, "rows", least=1), phases)
        return Stream(self, compiled, sum(len(source) for source in given), progress)

    def trace_to(
        self,
        path: str | PathLike[str],
        sources: Source | Iterable[Source],
        *,
        rows: int = 1 << 17,
        branches: Literal["ideal", "both", "random"] = "ideal",
        polarised: bool | None = None,
        generation_limit: int = 1000,
        threshold: float = 0.0,
        keep_escaped: bool = True,
        seed: int = 0,
        threads: int | None = None,
        phases: bool = False,
        progress: Progress = None,
    ) -> Balance:
        """Traces the light of sources into a table of segments, `.parquet` (with pyarrow, in row groups of at least
        `rows` rows), `.csv` or `.npy` (with a separate file of names), in memory that does not grow with the number of
        rays. The file appears under its name when it is complete; elements, surfaces and events are stored by
        name. `polarised` and `phases` are as in `trace`."""
        given = _all_sources(sources)
        is_followed = self._follows(polarised, given)
        settings = _settings(branches, is_followed, generation_limit, threshold, keep_escaped, seed, threads)
        return write(self, given, FilePath(path), settings, rows, phases, progress)

    def trace_rays(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        wavelength_nm: ArrayLike = 587.5618,
        power: ArrayLike = 1.0,
        source: ArrayLike = 0,
        *,
        stokes: ArrayLike | None = None,
        branches: Literal["ideal", "both", "random"] = "ideal",
        polarised: bool | None = None,
        generation_limit: int = 1000,
        threshold: float = 0.0,
        keep_escaped: bool = True,
        seed: int = 0,
        threads: int | None = None,
        phases: bool = False,
        progress: Progress = None,
    ) -> Trace:
        """Traces rays, (N, 3) or (3,), broadcast against each other, with wavelengths in nanometres and powers (N,).

        `stokes` (N, 7) is the polarisation: i, q, u, v, of which only the proportions count, and the axis of q > 0,
        which is projected onto the plane perpendicular to the ray. Polarisation is computed as in `trace`: by default if `stokes` is given or an
        element affects it. `source` (N,) are numbers of sources, for the column of that name.
        """
        starts, ways = _rays(origins, directions)
        count = len(starts)
        light = None if stokes is None else _stokes(_column("stokes", stokes, (count, 7)), ways)
        is_followed = self._follows(polarised, (), light is not None)
        settings = _settings(branches, is_followed, generation_limit, threshold, keep_escaped, seed, threads)
        columns, accounts = self._compiled.trace(
            starts,
            ways,
            _column("wavelength_nm", wavelength_nm, (count,)),
            _column("power", power, (count,)),
            _numbers_of("source", source, count),
            None if light is None else light.tolist(),
            settings,
            callback(progress),
        )
        return self._trace_of(columns, accounts, phases)

    def _follows(self, polarised: bool | None, sources: Iterable[Source], is_polarised: bool = False) -> bool:
        """Whether polarisation is computed: as requested or, by default, if an element or a source affects it."""
        if polarised is not None:
            return flag(polarised, "polarised", "True, False or None")
        is_polarised = is_polarised or any(source.is_polarised for source in sources)
        return is_polarised or any(part.action is not None and part.action.kind in _POLARISES for part in self.elements)

    def _trace_of(self, columns: dict[str, NDArray[Any]], accounts: dict[str, Any], phases: bool) -> Trace:
        trace = Trace(self, columns, self._balance(accounts))
        if flag(phases, "phases"):
            columns["phase_s"], columns["phase_p"] = trace.phases()
        return trace


def _flat(elements: Any) -> Any:
    """The elements with nested lists flattened, as `cemented` returns lists."""
    if isinstance(elements, Element) or not isinstance(elements, Iterable):
        return elements
    return [part for given in elements for part in (given if isinstance(given, list) else [given])]


def _settings(
    branches: str,
    polarised: bool,
    generation_limit: int,
    threshold: float,
    keep_escaped: bool,
    seed: int,
    threads: int | None,
) -> dict[str, Any]:
    least = real(threshold, "threshold", "a power")
    if not least >= 0.0:
        raise _core.RayweaveError(f"threshold is {threshold}: it is a power and must be at least 0.")
    return {
        "branches": text(branches, "branches", '"ideal", "both" or "random"'),
        "polarised": polarised,
        "generation_limit": whole(generation_limit, "generation_limit", bits=32),
        "threshold": least,
        "keep_escaped": flag(keep_escaped, "keep_escaped"),
        "seed": whole(seed, "seed"),
        "threads": threads,
        "rays": None,
    }


def _again(elements: tuple[Element, ...], world: Any, unit: Any) -> System:
    """A system from its pickled parts."""
    return System(elements, world=world, unit=unit)


def _all_sources(sources: Source | Iterable[Source]) -> list[Source]:
    given = all_of(Source, sources, "sources")
    if not given:
        raise _core.RayweaveError("sources is empty: light has to come from somewhere.")
    return given


class Trace(Mapping[str, NDArray[Any]]):
    """The segments of all rays as columns: a mapping from names to arrays of equal length.

    `id` is the number of the source ray, `parent` the row of the segment before it (-1 for the first), `generation` the number
    of earlier events, `source` the number of the source; `wavelength_nm`; `intensity` the power at the start of the segment;
    `index` of the medium; `x0`, `y0`, `z0` and `x1`, `y1`, `z1` the start and the end (NaN for light that escapes),
    `x_tilt`, `y_tilt`, `z_tilt` the direction cosines; `path` the optical path length from the source to the end (to the
    start for light that escapes); `element`, `surface` and
    `event` describe the end. `phase_s` and `phase_p` are present if requested by `phases`.

    >>> import rayweave.optics as ro
    >>> system = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25), ro.detector(25.0).translate([0, 0, 49])])
    >>> trace = system.trace(ro.beam(10.0, 100).translate([0, 0, -10]))
    >>> trace["event"].dtype, trace.rows
    (dtype('uint8'), 300)
    >>> trace.to_pandas(names=True)["element"].value_counts().to_dict()
    {'lens': 200, 'detector': 100}
    """

    def __init__(self, system: System, columns: dict[str, NDArray[Any]], balance: Balance | None) -> None:
        self.system = system
        self.columns = columns
        self._balance = balance
        self._is_whole = True

    @property
    def balance(self) -> Balance:
        """The balance of power of the whole run, also for a selection by `at`; a batch of a stream has none."""
        if self._balance is None:
            raise _core.RayweaveError("a batch has no balance. Take all batches and use the balance of the stream.")
        return self._balance

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.columns:
            raise KeyError(f"there is no column {name!r}: the columns are {', '.join(self.columns)}.")
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def rows(self) -> int:
        """The number of segments."""
        return len(self.columns["id"])

    def __repr__(self) -> str:
        return f"<Trace of {self.rows} segments, {len(self.columns)} columns>"

    def _repr_html_(self) -> str:
        return self._rows()._repr_html_()

    def _rows(self) -> Rows:
        """The segments as rows with the names of elements, surfaces and events."""
        names = {"element": self.system.element_names, "surface": self.system.surface_names, "event": _core.event_names()}
        return Rows(self.columns, {name: [*list_of, None] for name, list_of in names.items() if name in self.columns})

    def at(self, element: str, *, event: str | None = None) -> Trace:
        """The segments that end at an element, optionally only those with this event."""
        names = self.system.element_names
        if element not in names:
            unknown("element", element, names)
        chosen = self.columns["element"] == names.index(element)
        if event is not None:
            events = _core.event_names()
            if event not in events:
                unknown("event", event, events)
            chosen &= self.columns["event"] == events.index(event)
        return self._selected(chosen)

    def _selected(self, chosen: NDArray[np.bool_]) -> Trace:
        """Some of the rows."""
        part = Trace(self.system, {name: column[chosen] for name, column in self.columns.items()}, self._balance)
        part._is_whole = False
        return part

    def phases(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The phase of each row at the end of its `path`, in degrees from 0 to 360, for light polarised perpendicular
        (s) and parallel (p) to the plane of incidence.

        It grows by 360 degrees per wavelength of the optical path and jumps where light is reflected or enters a
        different medium, by the argument of the amplitude of the Fresnel equations or of a coating; waves go as exp(i
        (k.r - w t)), and p keeps its sign where light is reflected by a denser medium at normal incidence with p = k x s (Born &
        Wolf, Principles of Optics, section 1.5.2). The phases hold for light that stays s or p, that is, where all
        planes of incidence coincide. Scattered light has no phase: NaN. Only a whole trace has phases, not a
        selection by `at`.
        """
        if not self._is_whole:
            raise _core.RayweaveError("earlier rows are missing. Call phases on the whole trace, then select.")
        return self.system._compiled.phases(self.columns)

    def spot(self, element: str) -> Spot:
        """The spot of the light that arrives at an element, in the coordinates in which the element was created, with
        the power at the start of the last segment."""
        arriving = self.at(element)
        return spot_of(_local(arriving, element), arriving["intensity"])

    def irradiance(
        self, element: str, bins: int | tuple[int, int] = 64, *, size: tuple[float, float] | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Power per area that arrives at a plane sheet: an array (y, x), and the edges of its cells along x and y in
        the coordinates in which the sheet was created. `size` is the width and the height of the map about the origin;
        by default the map contains all light that arrives."""
        arriving = self.at(element)
        return irradiance_of(_local(arriving, element), arriving["intensity"], bins, size)

    def angles(self, element: str) -> NDArray[np.float64]:
        """The angles of incidence of the light that arrives at an element: degrees from its z axis, 0 to 90, from either
        side."""
        arriving = self.at(element)
        axis = self._element(element).place[:3, 2]
        tilts = np.stack([arriving[f"{k}_tilt"] for k in "xyz"], axis=1)
        cosine = np.abs(tilts @ axis) / np.linalg.norm(axis)
        return np.asarray(np.degrees(np.arccos(np.clip(cosine, 0.0, 1.0))))

    def paths(self) -> PathList:
        """The paths of the light, as sequences of elements, with rays and power, the strongest first. A `*` marks a
        reflection: in a lens, ghosts are the paths with two reflections. `Path.reflected_at` has their surfaces: in a system of a
        `Prescription`, `lens 2-3` has the surface 2 at its front and 3 at its back. `print` shows a table, and notes about ghosts
        that pass beside a sheet (`ghosts_beside`)."""
        found = paths_of(self, self.system.element_names, self.system.surface_names, _core.event_names())
        found.notes = [note for part in self.system.elements if isinstance(part.body, _core.Sheet) if (note := self._note(part.name))]
        return found

    def ghosts_beside(self, element: str) -> Trace:
        """The rows of ghosts that miss a sheet: light that was reflected by solids where it was split (`branches="both"`), leaves
        the system, and crosses the plane of the sheet beside it. A wider sheet catches it; that of a prescription is
        as wide as its `image_semi_diameter`, by default as the light of its fields."""
        if not self._is_whole:
            raise _core.RayweaveError("earlier rows are missing. Call ghosts_beside on the whole trace.")
        part = self._element(element)
        number = self.system.element_names.index(element)
        chosen = ghosts_beside(self, number, np.asarray(part.place), _core.event_names())
        return self._selected(chosen)

    def _note(self, element: str) -> str:
        """The note about ghosts that pass beside a sheet, if there are any."""
        beside = self.ghosts_beside(element)
        if not beside.rows:
            return ""
        count = "1 ray" if beside.rows == 1 else f"{beside.rows} rays"
        power = float(beside["intensity"].sum())
        hint = "Make it wider; that of a prescription by image_semi_diameter."
        return f"{count} of ghosts with a power of {power:.3e} pass beside the sheet {element!r}. {hint}"

    def _element(self, name: str) -> Element:
        return self.system.elements[self.system.element_names.index(name)]

    def points(self) -> NDArray[np.float64]:
        """The end points of the segments, (rows, 3)."""
        return np.stack([self.columns[name] for name in ("x1", "y1", "z1")], axis=1)

    def to_pandas(self, *, names: bool = False) -> Any:
        """Copies of the columns as a pandas DataFrame; or, with `names`, elements, surfaces and events by name, as
        categories."""
        if names:
            return self._rows().to_pandas()
        columns = {name: np.array(column) for name, column in self.columns.items()}
        return package("pandas", "data frames").DataFrame(columns, copy=False)

    def to_xarray(self, *, names: bool = False) -> Any:
        """The columns as an xarray Dataset with the dimension `row`; or, with `names`, elements, surfaces and events by name."""
        return self._rows().to_xarray() if names else dataset(self.columns, {})

    def to_arrow(self, *, names: bool = False) -> Any:
        """The columns as an Arrow table, without copies; or, with `names`, elements, surfaces and events by name."""
        pyarrow = package("pyarrow", "Arrow tables")
        if names:
            return pyarrow.Table.from_batches([record_batch(self)])
        return pyarrow.table({name: pyarrow.array(column) for name, column in self.columns.items()})

    def to_polars(self) -> Any:
        """The columns as a polars DataFrame, without copies, with numbers of surfaces, elements and events; the system
        has their names."""
        return package("polars", "its data frames").from_arrow(self.to_arrow(), rechunk=False)

    def show(
        self,
        view: Literal["zx", "zy", "xy"] = "zy",
        *,
        color: Literal["wavelength", "source"] | str = "wavelength",
        ax: Axes | Plot | None = None,
        ray_width: float = 0.8,
        rays: int | None = None,
        escape: float | None = None,
    ) -> Plot:
        """Draws the cross-section of the solids in the coordinate plane `view`, with all rays projected onto it, by
        matplotlib.

        Rays are coloured by wavelength, by source, or all in one colour. If there are more than `rays` rays, every n-th is
        drawn. By default at most 200 rays with at most 1500 segments are drawn; where there are more, as in traces of ghosts, only those
        in the plane of the picture, if there are any. Light with less power has thinner and fainter lines; light with less than a
        ten-thousandth of its initial power is omitted. The picture shows the elements and a margin of 0.6 times their size. Light that escapes is drawn with the length `escape`, by default a fifth of the picture.
        """
        return Plot(self._show(view, color=color, ax=ax, ray_width=ray_width, rays=rays, escape=escape))

    def _show(
        self,
        view: str = "zy",
        *,
        color: str = "wavelength",
        ax: Axes | Plot | None = None,
        ray_width: float = 0.8,
        rays: int | None = None,
        escape: float | None = None,
        hidden: Sequence[str] = (),
    ) -> Axes:
        """The drawing of `show`, without the elements with the names `hidden`."""
        from rayweave.optics._drawing import draw

        given = one_axes(ax) if isinstance(ax, Plot) else ax
        count = None if rays is None else whole(rays, "rays", least=1)
        return draw(self, view, color, given, ray_width, count, escape, hidden)


def _material_text(element: Element) -> str:
    """The material of an element, or that it is a sheet."""
    if not isinstance(element.body, Solid):
        return "sheet"
    return _named_material(element.material)[0]


def _named_material(material: Any) -> tuple[str, float | None]:
    """The name of a material, and its index if it has one."""
    if isinstance(material, str) and material in ("mirror", "absorber"):
        return material, None
    medium = _medium(material)
    if isinstance(medium, Glass):
        return medium.name, _yellow(medium)[0]
    if isinstance(medium, tuple):
        return f"index {medium[0]:g}", float(medium[0])
    return "graded medium", None


def _local(trace: Trace, element: str) -> NDArray[np.float64]:
    inverse = np.linalg.inv(trace._element(element).place)
    return np.asarray(trace.points() @ inverse[:3, :3].T + inverse[:3, 3])


def _rays(origins: ArrayLike, directions: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    vectors = []
    for name, given in (("origins", origins), ("directions", directions)):
        found = array(given, name)
        if found.ndim == 0 or found.shape[-1] != 3:
            raise _core.RayweaveError(f"{name} has shape {found.shape}: it must be (N, 3), (3,), or a grid (..., 3).")
        vectors.append(found.reshape(-1, 3))
    counts = {len(rows) for rows in vectors} - {1} or {1}
    if len(counts) > 1:
        lengths = f"origins has {len(vectors[0])} rows and directions {len(vectors[1])}"
        raise _core.RayweaveError(f"{lengths}: pass one row for each ray, or one for all.")
    first, second = (np.ascontiguousarray(np.broadcast_to(rows, (min(counts), 3))) for rows in vectors)
    return first, second


def _column(name: str, given: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    found = array(given, name)
    try:
        return np.broadcast_to(found, shape)
    except ValueError:
        raise _core.RayweaveError(f"{name} has shape {found.shape}: it must be {shape}.") from None


def _numbers_of(name: str, given: ArrayLike, count: int) -> NDArray[np.uint32]:
    """Whole numbers of 32 bits, one for each ray."""
    found = _column(name, given, (count,))
    wrong = np.flatnonzero(~((found >= 0.0) & (found < 2.0**32) & (found == np.floor(found))))
    if len(wrong):
        needed = "it must be a whole number, at least 0 and below 2^32"
        raise _core.RayweaveError(f"{name}[{wrong[0]}] is {found[wrong[0]]:g}: {needed}.")
    return found.astype(np.uint32)


def _stokes(rows: NDArray[np.float64], ways: NDArray[np.float64]) -> NDArray[np.float64]:
    """The Stokes parameters with their axes, normalised and perpendicular to the rays."""
    i, q, u, v = rows[:, :4].T
    with np.errstate(invalid="ignore", over="ignore"):
        is_light = (i > 0.0) & np.isfinite(i) & (np.sqrt(q * q + u * u + v * v) <= i * (1.0 + 1e-12))
    if not is_light.all():
        k = int(np.argmin(is_light))
        needed = "i, q, u, v are finite, with i > 0 and q^2 + u^2 + v^2 <= i^2"
        raise _core.RayweaveError(f"stokes[{k}] is {rows[k].tolist()}: {needed}.")
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        axes = rows[:, 4:] / np.abs(rows[:, 4:]).max(axis=1, keepdims=True)
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        along = ways / np.abs(ways).max(axis=1, keepdims=True)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        across = axes - (axes * along).sum(axis=1, keepdims=True) * along
        length = np.linalg.norm(across, axis=1, keepdims=True)
        # rounding dominates a shorter component across the ray; invalid rays are reported later
        has_axis = (length > 1e-9) | ~np.isfinite(along).all(axis=1, keepdims=True)
    if not has_axis.all():
        k = int(np.argmin(has_axis))
        needed = "its last three numbers are the axis of q > 0, which must be neither 0 nor NaN nor along the ray"
        raise _core.RayweaveError(f"stokes[{k}] is {rows[k].tolist()}: {needed}.")
    return np.concatenate([rows[:, :4], across / length], axis=1)
