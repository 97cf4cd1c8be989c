"""Results of runs: hits, ways of ending, histories."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._drawing import Drawing
from rayweave._files import AtomicFile
from rayweave._table import Table, dataset, table_of
from rayweave._whole import whole
from rayweave.optics._columns import Columns
from rayweave.optics._given import package

Numbers = NDArray[np.float64]

class _Named(Columns):
    """Columns, some of which are numbers of names."""

    #: The names of the values of such columns; -1 has no name.
    names: dict[str, list[str]]

    def _vector(self, letters: str) -> Numbers:
        return np.stack([self[name] for name in letters.split()], axis=1)

    @property
    def position(self) -> Numbers:
        """(N, 3) the positions in mm."""
        return self._vector("x y z")

    @property
    def direction(self) -> Numbers:
        """(N, 3) the directions: unit vectors."""
        return self._vector("dx dy dz")

    @property
    def polarisation(self) -> Numbers:
        """(N, 3) the polarisations: unit vectors."""
        return self._vector("px py pz")

    @property
    def time(self) -> Numbers:
        """(N,) the times in ns."""
        return self["time"]

    @property
    def wavelength_nm(self) -> Numbers:
        """(N,) the wavelengths in nm."""
        return self["wavelength_nm"]

    def named(self, column: str) -> NDArray[np.object_]:
        """The names of a column of numbers; None for -1."""
        names = np.array([*self.names[column], None], dtype=object)
        return np.asarray(names[self[column]])

    def to_pandas(self) -> Any:
        """The columns as a pandas DataFrame, with names as categories; the units are in its `attrs`."""
        pandas = package("pandas", "data frames")
        table = super().to_pandas()
        for column, names in self.names.items():
            table[column] = pandas.Categorical.from_codes(np.array(self[column]), names)
        return table

    def to_arrow(self) -> Any:
        """The columns as an Arrow table, with names as dictionaries; the units are in the metadata of its fields."""
        arrow = package("pyarrow", "Arrow tables")
        table = super().to_arrow()
        for column, names in self.names.items():
            codes = arrow.array(self[column], mask=self[column] < 0)
            values = arrow.DictionaryArray.from_arrays(codes, arrow.array(names, arrow.string()))
            table = table.set_column(table.schema.get_field_index(column), column, values)
        return table

    def to_xarray(self) -> Any:
        """The columns as an xarray Dataset with the dimension `row`, with names as texts; the units are in the attribute `units` of
        each variable."""
        columns = {name: self.named(name) if name in self.names else self[name] for name in self}
        return dataset(columns, self.units)


def _save(columns: _Named, compiled: _core.PhotonHits | _core.PhotonHistories, path: str | PathLike[str]) -> None:
    target = Path(path)
    if target.suffix.lower() != ".parquet":
        # the writer of the command
        return compiled.save(target)
    parquet = package("pyarrow.parquet", "Parquet files")
    if not target.absolute().parent.is_dir():
        raise _core.RayweaveError(f"cannot create {target}: the folder {target.parent} does not exist. Create it first.")
    units = {f"unit.{name}": unit for name, unit in columns.units.items() if unit}
    with AtomicFile(target) as file:
        parquet.write_table(columns.to_arrow().replace_schema_metadata(units), file)
        file.finish()


class Hits(_Named):
    """The detected photons: `photon`, the number in the run; `event`; the position `x`, `y`, `z` in mm; `time` in ns; the
    direction `dx`, `dy`, `dz`; the polarisation `px`, `py`, `pz`; `wavelength_nm`; `weight`, which is 1; the number of `steps`;
    `sensor`, an index of `sensor_paths`, equal in all runs of a detector; `copy`, the number of the innermost copy in its path, -1 without one; and for a source of
    gensteps `genstep`, the number of the genstep.

    All photons of a wavelength shifter have the number of the absorbed one.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> run = detector.simulate(rp.point([0, 0, 0], 550), n=1000)
    >>> len(run.hits["time"]) == run.ends["detected"]
    True
    >>> run.hits.to_pandas().columns[:4].tolist()
    ['event', 'photon', 'x', 'y']
    """

    def __init__(self, compiled: _core.PhotonHits, title: str) -> None:
        found = compiled.columns()
        columns = {**found, "weight": np.ones(len(found["photon"]))}
        super().__init__(columns, {"x": "mm", "y": "mm", "z": "mm", "time": "ns", "wavelength_nm": "nm"})
        self.names = {"sensor": compiled.sensor_paths}
        self._compiled = compiled
        self._title = title

    @property
    def sensor_paths(self) -> list[str]:
        """The paths of the sensors of the detector, in the order of their placements: the names of the volumes that lead to them, with
        the copy numbers of their placements. Sensors are the sensitive volumes and those behind surfaces with an EFFICIENCY."""
        return self.names["sensor"]

    @property
    def copy_numbers(self) -> NDArray[np.int64]:
        """(N, L) the copy numbers of the L steps of the paths of the sensors, from the outermost one; -1 for steps without a number and
        behind the last step of a shorter path."""
        steps = [[_copy_number(step) for step in path.split("/")] for path in self.sensor_paths]
        length = max(map(len, steps), default=0)
        table = np.array([own + [-1] * (length - len(own)) for own in steps], np.int64).reshape(len(steps), length)
        return table[self["sensor"]]

    @overload
    def __getitem__(self, key: str) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, key: int) -> dict[str, Any]: ...
    @overload
    def __getitem__(self, key: slice | NDArray[Any] | list[int] | list[bool]) -> Hits: ...
    def __getitem__(self, key: Any) -> Any:
        """A column by its name, a row by its number, or the hits of a slice, a mask or a list of numbers."""
        if not isinstance(key, (slice, list, np.ndarray)):
            return super().__getitem__(key)
        rows = np.arange(self.rows)[key]
        return Hits(self._compiled.select(rows.tolist()), self._title)

    def _chosen(self, sensor: str | int | None) -> list[int] | None:
        """The numbers of the sensors that a call names; None for all."""
        if sensor is None:
            return None
        if isinstance(sensor, str):
            return self._compiled.sensors_named(sensor)
        number = whole(sensor, "sensor", least=0, bits=31)
        if number >= len(self.sensor_paths):
            raise IndexError(f"sensor is {number}: there are {len(self.sensor_paths)} sensors, numbered from 0.")
        return [number]

    def counts(self) -> dict[str, int]:
        """The number of hits of each sensor, with those without hits."""
        counts = np.bincount(self["sensor"], minlength=len(self.sensor_paths))
        return dict(zip(self.sensor_paths, counts.tolist(), strict=True))

    def save(self, path: str | PathLike[str]) -> None:
        """Writes a table, complete or not at all: .csv or .npy (with a table of names), the table of hits of the command
        `rayweave photons`; or .parquet, all columns, by pyarrow."""
        _save(self, self._compiled, path)

    def to_opticks(self) -> NDArray[np.float32]:
        """(N, 4, 4): the photons in the layout of Opticks' `hit.npy` (`sphoton.h`).

        Rows: position and time; direction and, as an integer, the index of the instance, which is 0; polarisation and wavelength; as
        integers (`view(np.uint32)`), the flag SURFACE_DETECT, the number of the sensor plus 1 (24 bits) with the upper bits of the
        photon's number, its lower bits, and the flag mask. The mask has the flags of all steps if the run records histories (`record`),
        else SURFACE_DETECT alone. Opticks' number of the boundary is 0.
        """
        return self._compiled.opticks().view(np.float32)

    def plot(
        self,
        plane: str | None = None,
        *,
        bins: int | None = None,
        scale: Literal["linear", "log"] = "linear",
        sensor: str | int | None = None,
    ) -> Drawing:
        """Maps of the hits: hits per area of each sensor, in the plane of the two coordinates along which it extends most if it is
        flat, or else its hits.

        Of several sensors, the first map is a projection of all hits, in which sensors may overlap. It has a colour scale of its own;
        the sixteen sensors with the most hits follow with a common scale, in the order of `sensor_paths`, or as they lie if they are
        equal and form a grid of up to four columns. With `sensor`, the hits of the chosen sensors alone are drawn, and each of them has
        a map: the end of a path, such as "SiPM[1]" or "Gap[3]/SiPM", "all", or a number.

        `plane` is the plane of all maps: "xy", "xz" or "yz"; "sphere" gives one map of the azimuth and the cosine of the polar angle
        of all hits as seen from the origin, in hits per steradian, or with a marker for each sensor if all are small as seen from
        there and `bins` is not given. `scale="log"` shows sensors with few hits beside those with many; cells without hits are then
        grey. `bins` is the number of cells along the longer side of each map
        (for "sphere", along the polar angle, and twice as many along the azimuth); by default it is chosen for about 10 hits in a
        cell, from 4 to 64. The cells divide the extent of the sensor in both coordinates; sensors of equal size have equal cells."""
        cells = None if bins is None else whole(bins, "bins", least=1, bits=10)
        return Drawing(self._compiled.map_svg(self._title, cells, plane, scale, self._chosen(sensor)))

    def plot_spectra(
        self, *, bins: int | None = None, time: tuple[float, float] | None = None, sensor: str | int | None = None
    ) -> Drawing:
        """Histograms of the times and of the wavelengths, of all hits or of those of a `sensor`: its number, or the end of its path, as
        for `plot`; of several such sensors together.

        `bins` is the number of bins of each, up to 1023; by default about 60 of a round width, fewer for few hits. `time` is the
        range of times in ns; by default that of the hits, without the latest 0.5 % if they are much later than the others. The
        drawing states the number of hits beyond."""
        count = None if bins is None else whole(bins, "bins", least=1, bits=10)
        if time is not None:
            first, last = (float(end) for end in time)
            if not (np.isfinite([first, last]).all() and first < last):
                raise ValueError(f"time is {time}: it must be two finite numbers, the smaller one first.")
            time = first, last
        chosen = self._chosen(sensor)
        title = f"Hits: {self._title}"
        if chosen is not None:
            title += f", {self.sensor_paths[chosen[0]] if len(chosen) == 1 else sensor}"
        return Drawing(self._compiled.spectra_svg(title, count, time, chosen))


def _copy_number(step: str) -> int:
    """The copy number of a step of a path, such as 3 of `Gap[3]` and `Gap[3]#2`; -1 without one."""
    found = re.search(r"\[(-?\d+)\](#\d+)?$", step)
    return int(found[1]) if found else -1


@dataclass(frozen=True, eq=False, repr=False)
class Sequences(Table):
    """The histories of photons as Opticks' packed sequences.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> run = detector.simulate(rp.point([0, 0, 0], 550), n=100, record="steps")
    >>> sequences = run.histories.sequences()
    >>> len(sequences.texts) == len(sequences.photon)
    True
    """

    _columns: ClassVar[tuple[str, ...]] = ("photon", "track", "texts", "words")

    photon: NDArray[np.int64]
    """(N,) the number of the photon in the run."""
    track: NDArray[np.int64]
    """(N,) the number of the track, as in `Histories`."""
    words: NDArray[np.uint64]
    """(N, 2) the sequences, as `seq[:, 0]` of Opticks: 4 bits for each of the first 32 rows of the history, the first one in the
    lowest bits; 1 plus the number of the flag's bit in OpticksPhoton.h, and 0 after the end."""
    texts: list[str]
    """The sequences as texts, such as "TO BT SD"; of histories of more than 32 flags, the first 32 and "..."."""

    def _column(self, name: str) -> NDArray[Any]:
        column = getattr(self, name)
        return np.array(column, dtype=object) if name == "texts" else np.asarray(column)

    def counts(self) -> dict[str, int]:
        """The number of photons of each sequence, the most frequent first."""
        counts: dict[str, int] = {}
        for text in self.texts:
            counts[text] = counts.get(text, 0) + 1
        return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))


class Histories(_Named):
    """The steps of photons: a row for the emission and for each process, with the photon after it.

    `photon`, the number in the run; `track`, equal to it, and a number of 2^62 or more for further photons of a wavelength
    shifter; `step`, the number of steps so far; `process`, an index of `process_names`; `x`, `y`, `z` in mm; `time` in ns; `dx`,
    `dy`, `dz`; `px`, `py`, `pz`; `wavelength_nm`; `volume`, the volume that the step led through, an index of `volume_paths`;
    `surface`, the optical surface at its end, an index of `surface_names`, -1 without one. The last row of a track is its end.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> run = detector.simulate(rp.point([0, 0, 0], 550), n=100, record="steps")
    >>> run.histories.process_names[:2]
    ['emission', 'cerenkov']
    >>> run.histories.of(0).rows > 1
    True
    """

    def __init__(self, compiled: _core.PhotonHistories, title: str) -> None:
        units = {"x": "mm", "y": "mm", "z": "mm", "time": "ns", "wavelength_nm": "nm"}
        super().__init__(compiled.columns(), units)
        self.names = {
            "process": compiled.process_names,
            "volume": compiled.volume_paths,
            "surface": compiled.surface_names,
        }
        self._compiled = compiled
        self._title = title

    @property
    def process_names(self) -> list[str]:
        """The names of the processes."""
        return self.names["process"]

    @property
    def volume_paths(self) -> list[str]:
        """The paths of the volumes."""
        return self.names["volume"]

    @property
    def surface_names(self) -> list[str]:
        """The names of the optical surfaces."""
        return self.names["surface"]

    @property
    def processes(self) -> dict[str, int]:
        """The number of rows by process."""
        return dict(self._compiled.processes)

    @property
    def surfaces(self) -> dict[str | None, dict[str, int]]:
        """The number of events at each optical surface by process; None for interfaces without a surface."""
        found: dict[str | None, dict[str, int]] = {}
        for surface, process, count in self._compiled.surfaces:
            name = None if surface is None else self.surface_names[surface]
            found.setdefault(name, {})[process] = count
        return found

    def sequences(self) -> Sequences:
        """The sequences of flags; empty in a record of counts."""
        return Sequences(*self._compiled.sequences())

    def of(self, photon: int) -> History:
        """The rows of one photon, with the names of processes, volumes and surfaces."""
        self._require_steps()
        rows = np.flatnonzero(self["photon"] == photon)
        columns = {name: self.named(name)[rows] if name in self.names else self[name][rows] for name in self}
        return History(columns, self.units, self, int(photon))

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the table of steps of the command `rayweave photons`, complete or not at all: .csv, .npy (with a table of
        names), or .parquet by pyarrow."""
        self._require_steps()
        _save(self, self._compiled, path)

    def plot(self, plane: str | None = None, *, photons: ArrayLike | None = None) -> Drawing:
        """The tracks in a section of the detector: lines coloured by wavelength, and a circle where a photon is detected.

        `plane` is "yz", "xz", "xy", or a position along an axis such as "x=2.5"; by default the plane nearest to the tracks. `photons`
        are the numbers of the photons to draw, by default all: `photons=run.hits.photon` draws the detected ones. A few hundred
        tracks make a legible drawing.
        """
        self._require_steps()
        if photons is None:
            return Drawing(self._compiled.tracks_svg(self._title, plane))
        numbers = np.atleast_1d(np.asarray(photons))
        if numbers.dtype.kind not in "iu" and numbers.size:
            raise TypeError(f"photons has the type {numbers.dtype}: it must be an array of whole numbers.")
        missing = np.setdiff1d(numbers, self["photon"])
        if missing.size:
            raise _core.RayweaveError(
                f"photons has {missing[0]}: the histories have no such photon. Select from their column `photon`."
            )
        return Drawing(self._compiled.tracks_svg(self._title, plane, numbers.tolist()))

    def _require_steps(self) -> None:
        if self.rows == 0 and sum(self.processes.values()) > 0:
            reason = "the run recorded sequences or counts alone"
            raise _core.RayweaveError(f'the histories have no steps: {reason}. Simulate with record="steps".')


class History(Columns):
    """The history of one photon: the rows of `Histories`, with the names of processes, volumes and surfaces.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> run = detector.simulate(rp.point([0, 0, 0], 550), n=100, record="steps")
    >>> history = run.histories.of(0)
    >>> history.process[0]
    'emission'
    >>> history.plot("yz").save("photon.svg")
    """

    def __init__(
        self, columns: Mapping[str, ArrayLike], units: Mapping[str, str], histories: Histories, photon: int
    ) -> None:
        super().__init__(columns, units)
        self._histories = histories
        self._photon = photon

    def plot(self, plane: str | None = None) -> Drawing:
        """The tracks of the photon in a section of the detector, as `Histories.plot` draws them."""
        return self._histories.plot(plane, photons=[self._photon])


class Run:
    """The result of a run.

    >>> import rayweave.photons as rp
    >>> detector = rp.load("bar.gdml")
    >>> run = detector.simulate(rp.point([0, 0, 0], 550), n=1000)
    >>> run.photons, run.ends["detected"] == run.hits.rows
    (1000, True)
    """

    def __init__(self, compiled: _core.PhotonRun, title: str) -> None:
        self.compiled = compiled
        self.photons: int = compiled.photons
        """The number of photons, with those that wavelength shifters emitted in addition."""
        self.steps: int = compiled.steps
        """The number of steps of all photons."""
        self.seconds: float = compiled.seconds
        """The duration in seconds."""
        self.ends: dict[str, int] = compiled.ends
        """The number of photons by way of ending; the sum is `photons`."""
        self.hits = Hits(compiled.hits, title)
        """The detected photons."""
        self.notes: tuple[str, ...] = ()
        """Sentences about a run of `simulate`: a part of the source is outside the world or in a material without RINDEX; and, unless
        the limit of steps is below the default, no hits in a detector with sensors, and photons stopped by the limit of steps.
        `simulate` also issues them as warnings, except that about stopped photons if they are at most half of all."""
        self._histories = None if compiled.histories is None else Histories(compiled.histories, title)

    @property
    def histories(self) -> Histories:
        """The recorded histories."""
        if self._histories is None:
            raise _core.RayweaveError('no histories are recorded: simulate with record="steps", "sequences" or "counts".')
        return self._histories

    def fractions(self) -> dict[str, tuple[float, float]]:
        """The fraction p of the photons that each sensor detects, and its statistical error, the binomial standard deviation
        sqrt(p (1 - p) / n) of n photons: 0 without hits, where the fraction is below 3 / n with a confidence of 95 %.

        >>> import rayweave.photons as rp
        >>> run = rp.load("bar.gdml").simulate(rp.point([0, 0, 0], 550), n=1000)
        >>> [(fraction, error)] = run.fractions().values()
        >>> fraction == run.hits.rows / 1000, 0 < error < 0.016
        (True, True)
        """
        photons = max(self.photons, 1)
        shares = {path: count / photons for path, count in self.hits.counts().items()}
        return {path: (p, (p * max(1 - p, 0.0) / photons) ** 0.5) for path, p in shares.items()}

    def _repr_html_(self) -> str:
        return table_of(f"Run of {self.photons} photons", self.ends)

    def __repr__(self) -> str:
        ends = ", ".join(f"{count} {end}" for end, count in self.ends.items() if count)
        return f"<Run of {self.photons} photons: {ends or 'none'}>"
