"""Optical systems from model files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any

from rayweave import _core
from rayweave._progress import Progress
from rayweave.optics._elements import Element
from rayweave.optics._sources import Source
from rayweave.optics._stream import Stream
from rayweave.optics._system import Balance, System, Trace


@dataclass(frozen=True, eq=False)
class OpticalModel:
    """The contents of the `[optics]` tables of a model file: a system, its sources, and the settings of traces.

    `settings` are arguments of `System.trace`. `trace`, `stream` and `trace_to` use them; keyword arguments override
    them.

    >>> import rayweave.optics as ro
    >>> text = '''
    ... rayweave = 1
    ... [solid.ball]
    ... sphere = { radius = 5 }
    ... [[region]]
    ... solid = "ball"
    ... medium = "glass"
    ... [medium.glass]
    ... index = 1.5
    ... [optics.medium]
    ... glass = "N-BK7"
    ... [[optics.sheet]]
    ... name = "screen"
    ... circle = 20
    ... action = "absorb"
    ... transform = [{ translate = [0, 0, 8] }]
    ... [[optics.source]]
    ... beam = { circle = 2, rays = 100 }
    ... transform = [{ translate = [0, 0, -10] }]
    ... '''
    >>> model = ro.loads(text)
    >>> model.system.element_names, len(model.sources[0])
    (['ball', 'screen'], 100)
    >>> model.trace().spot("screen").points.shape
    (100, 2)
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
    warnings are errors. All problems are reported at once, each with file, line and column.

    >>> from pathlib import Path
    >>> import rayweave.optics as ro
    >>> text = '''
    ... rayweave = 1
    ... [solid.ball]
    ... sphere = { radius = 5 }
    ... [[region]]
    ... solid = "ball"
    ... medium = "glass"
    ... [medium.glass]
    ... index = 1.5
    ... [optics.medium]
    ... glass = "N-BK7"
    ... [[optics.sheet]]
    ... name = "screen"
    ... circle = 20
    ... action = "absorb"
    ... transform = [{ translate = [0, 0, 8] }]
    ... [[optics.source]]
    ... beam = { circle = 2, rays = 100 }
    ... transform = [{ translate = [0, 0, -10] }]
    ... '''
    >>> _ = Path("ball.toml").write_text(text)
    >>> ro.load("ball.toml").system.element_names
    ['ball', 'screen']
    """
    if str(fspath(path)).lower().endswith(".zmx"):
        raise _core.RayweaveError(
            f"{fspath(path)} is a Zemax lens file: it has no [optics] tables. Read it with Prescription.read_zmx(path); `rayweave info` "
            "lists its surfaces, and `rayweave convert LENS.zmx LENS.toml` makes a model of it."
        )
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
    read files there and below.

    >>> import rayweave.optics as ro
    >>> text = '''
    ... rayweave = 1
    ... [solid.ball]
    ... sphere = { radius = 5 }
    ... [[region]]
    ... solid = "ball"
    ... medium = "glass"
    ... [medium.glass]
    ... index = 1.5
    ... [optics.medium]
    ... glass = "N-BK7"
    ... [[optics.sheet]]
    ... name = "screen"
    ... circle = 20
    ... action = "absorb"
    ... transform = [{ translate = [0, 0, 8] }]
    ... [[optics.source]]
    ... beam = { circle = 2, rays = 100 }
    ... transform = [{ translate = [0, 0, -10] }]
    ... '''
    >>> ro.loads(text).system.element_names
    ['ball', 'screen']
    """
    values = None if parameters is None else dict(parameters)
    return _model(_core.loads_optics(text, values, allow=list(allow), strict=strict))


def _model(read: tuple[Any, ...]) -> OpticalModel:
    compiled, elements, sources, settings, unit, warnings = read
    system = System._of(compiled, [_element(element) for element in elements], unit)
    return OpticalModel(system, tuple(Source(source) for source in sources), settings, tuple(warnings))


def _element(read: _core.ReadElement) -> Element:
    name, body, material, place = read.parts()
    return Element(name, body, material or "absorber", place=place, read=read)
