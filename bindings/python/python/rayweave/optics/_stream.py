"""Traces of any length in bounded memory: batch by batch, or into files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rayweave import _core
from rayweave._files import AtomicFile
from rayweave._progress import Progress, reporter
from rayweave.optics._given import package, whole

if TYPE_CHECKING:
    from rayweave.optics._sources import Source
    from rayweave.optics._system import Balance, System, Trace

_NAMED = ("element", "surface", "event")


class Stream:
    """The segments of a run as an iterator of traces, each of at least `rows` rows except the last one.

    The rows are those of `System.trace`, in the same order; `parent` counts the rows of the whole run. Light is traced
    in the background, a few batches ahead. After the last batch `balance` contains the balance of power. Ending early
    (`close`, the end of a `with` block, or deletion of the stream) stops the run. Several threads may take batches from
    one stream: each batch goes to one of them, and all of them end when the run is over or the stream is closed.

    >>> import rayweave.optics as ro
    >>> system = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25), ro.detector(25.0).translate([0, 0, 49])])
    >>> stream = system.stream(ro.beam(10.0, 100).translate([0, 0, -10]))
    >>> rows = sum(batch.rows for batch in stream)
    >>> rows, round(stream.balance.emitted, 9)
    (300, 1.0)
    """

    def __init__(self, system: System, compiled: _core.SegmentStream, total: int, progress: Progress) -> None:
        self.system = system
        self._compiled = compiled
        self._total = total
        self._tell = reporter(progress)

    def __iter__(self) -> Iterator[Trace]:
        from rayweave.optics._system import Trace

        for columns in self._compiled:
            self._tell(min(self._compiled.rays, self._total), self._total)
            yield Trace(self.system, columns, None)
        # a stream that was closed early is not complete
        if self._compiled.balance is not None:
            self._tell(self._total, self._total)

    @property
    def balance(self) -> Balance:
        """The balance of power, once all batches have been taken."""
        accounts = self._compiled.balance
        if accounts is None:
            raise _core.RayweaveError(
                "the balance is not known yet: take all batches before closing the stream."
            )
        return self.system._balance(accounts)

    def to_arrow(self) -> Iterator[Any]:
        """The batches as record batches of pyarrow, with the names of elements, surfaces and events."""
        for trace in self:
            yield record_batch(trace)

    def close(self) -> None:
        """Stops the run."""
        self._compiled.cancel()

    def __enter__(self) -> Stream:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def record_batch(trace: Trace) -> Any:
    """A record batch of a trace: numbers without copies, names as dictionaries."""
    pyarrow = package("pyarrow", "Arrow tables")
    system = trace.system
    names = {
        "element": system.element_names,
        "surface": system.surface_names,
        "event": _core.event_names(),
    }
    arrays = {}
    for name, column in trace.items():
        arrays[name] = _dictionary(column, names[name]) if name in _NAMED else pyarrow.array(column)
    return pyarrow.record_batch(arrays)


def _dictionary(numbers: NDArray[Any], names: list[str]) -> Any:
    pyarrow = package("pyarrow", "Arrow tables")
    indices = pyarrow.array(numbers.astype(np.int32), mask=numbers.astype(np.int32) < 0)
    return pyarrow.DictionaryArray.from_arrays(indices, pyarrow.array(names, pyarrow.string()))


def write(
    system: System,
    sources: list[Source],
    path: Path,
    settings: dict[str, Any],
    rows: int,
    phases: bool,
    progress: Progress,
) -> Balance:
    whole(rows, "rows", least=1)
    if path.suffix.lower() != ".parquet":
        # the writer and the columns of the command-line tool
        tell = reporter(progress) if progress else None
        compiled = [source.compiled for source in sources]
        return system._balance(system._compiled.trace_to(path, system.unit, compiled, settings, phases, tell))
    return _write_parquet(system, system._stream(sources, settings, rows, phases, progress), path)


def _write_parquet(system: System, stream: Stream, path: Path) -> Balance:
    parquet = package("pyarrow.parquet", "Parquet files")
    if not path.absolute().parent.is_dir():
        raise _core.RayweaveError(f"cannot create {path}: the folder {path.parent} does not exist. Create it first.")
    writer = None
    with AtomicFile(path) as file:
        try:
            with stream:
                for batch in stream.to_arrow():
                    with_units = batch.replace_schema_metadata(_units(system.unit, batch.schema.names))
                    if writer is None:
                        writer = parquet.ParquetWriter(file, with_units.schema, compression="snappy")
                    writer.write_batch(with_units)
                balance = stream.balance
            if writer is None:
                raise _core.RayweaveError("there are no segments to write: the sources emit no light.")
        finally:
            if writer is not None:
                writer.close()
        file.finish()
        return balance


def _units(unit: str, columns: list[str]) -> dict[str, str]:
    lengths = ("x0", "y0", "z0", "x1", "y1", "z1", "path")
    units = {"wavelength_nm": "nm", "phase_s": "deg", "phase_p": "deg"} | dict.fromkeys(lengths, unit)
    return {f"unit.{name}": units[name] for name in units if name in columns}
