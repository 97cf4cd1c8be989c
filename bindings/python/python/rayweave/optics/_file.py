"""Optical systems from model files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

from rayweave import _core
from rayweave.optics._elements import Element
from rayweave.optics._sources import Source
from rayweave.optics._stream import Progress, Stream
from rayweave.optics._system import Balance, System, Trace


@dataclass(frozen=True, eq=False)
class OpticalModel:
    """The contents of the `[optics]` tables of a model file: a system, its sources, and the settings of traces.

    `settings` are arguments of `System.trace`. `trace`, `stream` and `trace_to` use them; keyword arguments override
    them.
    """

    system: System
    sources: tuple[Source, ...]
    settings: dict[str, Any]
    warnings: tuple[str, ...] = ()

    def trace(self, **changes: Any) -> Trace:
        """Traces the light of all sources: see `System.trace`."""
        return self.system.trace(self.sources, **(self.settings | changes))

    def stream(self, *, rows: int = 1 << 17, progress: Progress = None, **changes: Any) -> Stream:
        """Traces the light batch by batch: see `System.stream`."""
        return self.system.stream(self.sources, rows=rows, progress=progress, **(self.settings | changes))

    def trace_to(
        self, path: str | PathLike[str], *, rows: int = 1 << 17, progress: Progress = None, **changes: Any
    ) -> Balance:
        """Traces the light into a file: see `System.trace_to`."""
        wishes = self.settings | changes
        return self.system.trace_to(path, self.sources, rows=rows, progress=progress, **wishes)


def load(
    path: str | PathLike[str],
    parameters: Mapping[str, float | str] | None = None,
    *,
    allow: Sequence[str | PathLike[str]] = (),
    strict: bool = False,
) -> OpticalModel:
    """The `[optics]` tables of a model file. `parameters` overrides parameters of the file with numbers or arithmetic
    expressions. The model may read files in its folder and below, and the files and folders in `allow`. With `strict`,
    warnings are errors. All problems are reported at once, each with file, line and column."""
    values = None if parameters is None else dict(parameters)
    return _model(_core.load_optics(path, values, allow=list(allow), strict=strict))


def loads(
    text: str,
    parameters: Mapping[str, float | str] | None = None,
    *,
    allow: Sequence[str | PathLike[str]] = (),
    strict: bool = False,
) -> OpticalModel:
    """As `load`, from the text of a model file. The names of files are relative to the current folder; the model may
    read files there and below."""
    values = None if parameters is None else dict(parameters)
    return _model(_core.loads_optics(text, values, allow=list(allow), strict=strict))


def _model(read: tuple[Any, ...]) -> OpticalModel:
    compiled, elements, sources, settings, unit, warnings = read
    system = System._of(compiled, [_element(element) for element in elements], unit)
    return OpticalModel(system, tuple(Source(source) for source in sources), settings, tuple(warnings))


def _element(read: _core.ReadElement) -> Element:
    name, body, material, place = read.parts()
    return Element(name, body, material or "absorber", place=place, read=read)
