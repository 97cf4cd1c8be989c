"""Jobs on Dask's distributed scheduler."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rayweave.cluster._job import Job, Packed, Range, collected, joined, part_of, planned
from rayweave.optics._given import package


def run(job: Job, client: Any, *, pieces: int | None = None, done: Mapping[Range, Any] | None = None) -> Any:
    """Runs a job on the workers of a `distributed.Client` in `pieces` ranges, by default four for each thread of the workers, and returns
    the joined result. Each worker receives the job once. Dask repeats parts of workers that die; if it gives up, the error is an
    `Incomplete`."""
    distributed = package("distributed", "jobs on Dask")
    threads = sum(client.nthreads().values())
    todo, known = planned(job, pieces or 4 * max(threads, 1), done)
    # a task, unlike scattered data, is repeated if all workers that have its result die
    packed = client.submit(_kept, Packed(job), pure=False)
    # a key of the contents alone would return the result of an earlier run
    waiting = {client.submit(part_of, packed, span, pure=False): span for span in todo}
    finished = distributed.as_completed(waiting)
    return joined(job, known, collected(waiting, finished, known, lambda failure: type(failure).__name__ == "KilledWorker"))


def _kept(packed: Packed) -> Packed:
    return packed
