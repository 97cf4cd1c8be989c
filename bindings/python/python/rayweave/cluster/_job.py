"""Jobs: functions of a range of numbers, and the join of their parts."""

from __future__ import annotations

import hashlib
import pickle
import threading
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rayweave._core import RayweaveError
from rayweave.optics._given import whole
from rayweave.optics._sources import Source as LightSource
from rayweave.optics._system import System
from rayweave.photons._detector import Detector
from rayweave.photons._sources import Source

#: A range of numbers: the first one, and the one after the last.
Range = tuple[int, int]

#: Rays of optical traces whose segments are written together: ranges begin at multiples.
_CHUNK = 2048


class Job(ABC):
    """A function of a range of numbers from 0 to `total`, whose ranges begin at multiples of `step`.

    >>> from rayweave import cluster
    >>> issubclass(cluster.Light, cluster.Job)
    True
    """

    total: int
    step: int = 1

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.total} numbers, in multiples of {self.step}>"

    @abstractmethod
    def part(self, first: int, last: int) -> Any:
        """The result for the numbers from `first` up to `last`, exclusively."""

    @abstractmethod
    def join(self, parts: Sequence[Any]) -> Any:
        """The whole from the results of all ranges, in their order."""


@dataclass(frozen=True, eq=False, repr=False)
class PhotonResult:
    """The detected photons of a run: columns as those of `rayweave.photons.Hits`, the paths that `sensor` counts, the number of
    photons by way of ending, of all photons, and of their steps.

    >>> from rayweave import cluster
    >>> from rayweave import photons
    >>> job = cluster.Photons(photons.load("bar.gdml"), photons.point([0, 0, 0], 550), n=100)
    >>> part = job.part(0, 100)
    >>> part.photons
    100
    """

    hits: dict[str, NDArray[Any]]
    sensor_paths: list[str]
    ends: dict[str, int]
    photons: int
    steps: int

    def __repr__(self) -> str:
        hits = len(next(iter(self.hits.values()), ()))
        return f"<PhotonResult of {self.photons} photons: {hits} hits>"


class Photons(Job):
    """Simulation of photons: `detector.simulate(source, n, **settings)`. The settings are those of `simulate` except `record`,
    `range` and `progress`; `threads` counts those of each process, 1 by default.

    >>> from rayweave import cluster
    >>> from rayweave import photons
    >>> job = cluster.Photons(photons.load("bar.gdml"), photons.point([0, 0, 0], 550), n=100)
    >>> job.join([job.part(0, 50), job.part(50, 100)]).photons
    100
    """

    def __init__(self, detector: Detector, source: Source, n: int, **settings: Any) -> None:
        for name in ("record", "range", "progress"):
            if name in settings:
                raise RayweaveError(f"{name} is given: a job has no {name}.")
        self.detector, self.source, self.total = detector, source, whole(n, "n", bits=62)
        self.settings = {"threads": 1} | settings

    def part(self, first: int, last: int) -> PhotonResult:
        run = self.detector.simulate(self.source, self.total, range=(first, last), **self.settings)
        return PhotonResult(dict(run.hits), run.hits.sensor_paths, run.ends, run.photons, run.steps)

    def join(self, parts: Sequence[PhotonResult]) -> PhotonResult:
        # paths are numbered in the order in which they first occur
        paths = {path: number for number, path in enumerate(dict.fromkeys(path for part in parts for path in part.sensor_paths))}
        columns = []
        for part in parts:
            numbers = np.array([paths[path] for path in part.sensor_paths], np.int32)
            columns.append(part.hits | {"sensor": numbers[part.hits["sensor"]]})
        ends = {end: sum(part.ends.get(end, 0) for part in parts) for end in dict.fromkeys(end for part in parts for end in part.ends)}
        photons, steps = sum(part.photons for part in parts), sum(part.steps for part in parts)
        return PhotonResult(_concatenated(columns), list(paths), ends, photons, steps)


class Light(Job):
    """A trace of light: `system.trace(sources, **settings)`. The result is the columns of the trace. Ranges begin at multiples of 2,048
    rays. `threads` counts those of each process, 1 by default.

    >>> from rayweave import cluster
    >>> import rayweave.optics as ro
    >>> system = ro.System([ro.biconvex_lens(50, 50, 5, aperture=25), ro.detector(25.0).translate([0, 0, 49])])
    >>> job = cluster.Light(system, ro.beam(10.0, 100).translate([0, 0, -10]))
    >>> columns = job.join([job.part(0, job.total)])
    >>> len(columns["id"]) > 0
    True
    """

    step = _CHUNK

    def __init__(self, system: System, sources: LightSource | Iterable[LightSource], **settings: Any) -> None:
        for name in ("range", "progress", "phases"):
            if name in settings:
                raise RayweaveError(f"{name} is given: a job has no {name}.")
        self.system = system
        self.sources = [sources] if isinstance(sources, LightSource) else list(sources)
        self.total = sum(len(source) for source in self.sources)
        self.settings = {"threads": 1} | settings

    def part(self, first: int, last: int) -> dict[str, NDArray[Any]]:
        return dict(self.system.trace(self.sources, range=(first, last), **self.settings).columns)

    def join(self, parts: Sequence[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
        before, columns = 0, []
        for part in parts:
            parent = part["parent"]
            columns.append(part | {"parent": np.where(parent < 0, parent, parent + before)})
            before += len(parent)
        return _concatenated(columns)


class Call(Job):
    """Calls of a function of a module: `function(*args, first, last)` returns an array, or a mapping of arrays, with the results of
    the items from `first` up to `last`; they are concatenated.

    >>> from rayweave import cluster
    >>> import numpy as np
    >>> job = cluster.Call(np.arange, total=10)
    >>> job.join([job.part(0, 4), job.part(4, 10)])
    array([0, 1, 2, 3, 4, 5, 6, 7, 8, 9])
    """

    def __init__(self, function: Callable[..., Any], *args: Any, total: int, step: int = 1) -> None:
        self.function, self.args = function, args
        self.total, self.step = whole(total, "total", bits=62), whole(step, "step", least=1)

    def part(self, first: int, last: int) -> Any:
        return self.function(*self.args, first, last)

    def join(self, parts: Sequence[Any]) -> Any:
        return _concatenated(parts) if isinstance(parts[0], Mapping) else np.concatenate(parts)


def _concatenated(parts: Sequence[Mapping[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


class Incomplete(RayweaveError):
    """Parts of a job are missing, because workers failed. `missing` are their ranges, `done` the results by range: pass it to `run`
    as `done` to compute only the missing ones.

    >>> from rayweave import cluster
    >>> issubclass(cluster.Incomplete, ValueError)
    True
    """

    def __init__(self, missing: list[Range], done: dict[Range, Any], reason: str) -> None:
        listed = ", ".join(f"{first}:{last}" for first, last in missing)
        super().__init__(f"the ranges {listed} are missing: {reason}. Run the job again with done=error.done.")
        self.missing, self.done, self._reason = missing, done, reason

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.missing, self.done, self._reason)


def ranges(total: int, pieces: int, *, step: int = 1) -> list[Range]:
    """About equal ranges of 0 to `total`, at most `pieces`, that begin at multiples of `step`; one empty range for a total of 0.

    >>> from rayweave import cluster
    >>> cluster.ranges(10, 3)
    [(0, 4), (4, 7), (7, 10)]
    """
    total, step = whole(total, "total", bits=62), whole(step, "step", least=1)
    blocks = -(-total // step)
    count = max(1, min(whole(pieces, "pieces", least=1), blocks))
    cuts = [step * (-(-blocks * k // count)) for k in range(count)]
    return list(zip(cuts, [*cuts[1:], total], strict=True))


def missing(total: int, done: Iterable[Range]) -> list[Range]:
    """The ranges of 0 to `total` that no range covers.

    >>> from rayweave import cluster
    >>> cluster.missing(10, [(2, 5), (8, 9)])
    [(0, 2), (5, 8), (9, 10)]
    """
    found, reached = [], 0
    for first, last in sorted(done):
        if first > reached:
            found.append((reached, first))
        reached = max(reached, last)
    return found if reached >= total else [*found, (reached, total)]


#: Jobs and models of this process by the hash of their bytes: a model is compiled once, whatever the number of its parts.
_UNPACKED: OrderedDict[str, Any] = OrderedDict()
_KEPT = 4
_LOCK = threading.Lock()


#: Why parts are missing that were not finished within `timeout`.
LATE = "they were not finished within the timeout"


class Packed:
    """A job as bytes, which a process unpacks once.

    >>> from rayweave import cluster
    >>> import numpy as np
    >>> packed = cluster.Packed(cluster.Call(np.arange, total=10))
    >>> packed.part((0, 3))
    array([0, 1, 2])
    """

    def __init__(self, job: Any) -> None:
        self.data = pickle.dumps(job, protocol=5)
        self.key = hashlib.sha256(self.data).hexdigest()

    def unpacked(self) -> Any:
        """The job, the same object in each call in a process."""
        with _LOCK:
            job = _UNPACKED.get(self.key)
            if job is None:
                job = _UNPACKED[self.key] = pickle.loads(self.read())
            _UNPACKED.move_to_end(self.key)
            while len(_UNPACKED) > _KEPT:
                _UNPACKED.popitem(last=False)
        return job

    def part(self, span: Range) -> Any:
        """The result of a range."""
        return self.unpacked().part(*span)

    def read(self) -> bytes:
        """The bytes of the job."""
        return self.data


def planned(job: Job, pieces: int, done: Mapping[Range, Any] | None) -> tuple[list[Range], dict[Range, Any]]:
    """The ranges to compute, and the results so far."""
    known = dict(done or {})
    spans = sorted(span for span in known if span[0] < span[1])
    for (a, b), (c, d) in zip(spans, spans[1:]):
        if c < b:
            raise RayweaveError(f"done has the ranges {a}:{b} and {c}:{d}: they overlap. Leave one of them out.")
    if spans and spans[-1][1] > job.total:
        raise RayweaveError(f"done reaches {spans[-1][1]}: the job has {job.total} items.")
    todo = []
    for first, last in missing(job.total, known) if known else [(0, job.total)]:
        share = max(1, round(pieces * (last - first) / max(job.total, 1)))
        todo += [(first + a, first + b) for a, b in ranges(last - first, share, step=job.step)]
    return todo, known


def part_of(packed: Packed, span: Range) -> Any:
    """The result of a range, as a function that engines send to workers."""
    return packed.part(span)


def collected(
    waiting: Mapping[Any, Range],
    finished: Iterable[Any],
    known: dict[Range, Any],
    is_dead: Callable[[BaseException], bool],
    reason: str = "workers died",
) -> str:
    """Adds the results of futures to `known`, in the order in which they finish. Returns why some are missing, by default `reason`. An
    error that is not the death of a worker is raised. Then, after an interrupt, and when `finished` raises `TimeoutError`, parts that
    have not started are cancelled."""
    futures = iter(finished)
    try:
        while True:
            try:
                future = next(futures)
            except StopIteration:
                break
            except TimeoutError:
                reason = LATE
                break
            failure = future.exception()
            if failure is None:
                known[waiting[future]] = future.result()
            elif is_dead(failure):
                reason = f"a worker died ({failure})"
            else:
                raise failure
    finally:
        for future in waiting:
            if not future.done():
                future.cancel()
    return reason


def joined(job: Job, done: Mapping[Range, Any], reason: str) -> Any:
    """The whole; an error that names the missing ranges."""
    gaps = missing(job.total, done)
    if gaps:
        raise Incomplete(gaps, dict(done), reason)
    return job.join([done[span] for span in sorted(done)])
