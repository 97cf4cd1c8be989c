"""Jobs on Ray."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from typing import Any

from rayweave.cluster._job import LATE, Job, Packed, Range, joined, part_of, planned
from rayweave.optics._given import package


def run(
    job: Job, *, pieces: int | None = None, done: Mapping[Range, Any] | None = None, timeout: float | None = None
) -> Any:
    """Runs a job on the Ray cluster that `ray.init` has connected to, in `pieces` ranges, by default four for each processor, and
    returns the joined result. The job is stored once in Ray's object store. Ray repeats tasks of workers that die; if it gives up, or
    parts are not finished after `timeout` seconds, the error is an `Incomplete`."""
    ray = package("ray", "jobs on Ray")
    todo, known = planned(job, pieces or 4 * max(int(ray.cluster_resources().get("CPU", 1)), 1), done)
    packed = ray.put(Packed(job))
    task = ray.remote(part_of)
    waiting = {task.remote(packed, span): span for span in todo}
    reason = "workers died"
    end = None if timeout is None else time.monotonic() + timeout
    while waiting:
        left = None if end is None else max(0.0, end - time.monotonic())
        finished, _ = ray.wait(list(waiting), num_returns=1, timeout=left)
        if not finished:
            reason = LATE
            _cancel(ray, waiting)
            break
        (ready,) = finished
        span = waiting.pop(ready)
        try:
            known[span] = ray.get(ready)
        except ray.exceptions.RayTaskError:
            # the job itself failed
            _cancel(ray, waiting)
            raise
        except ray.exceptions.RayError as error:
            reason = f"a worker died ({type(error).__name__})"
    return joined(job, known, reason)


def _cancel(ray: Any, tasks: Iterable[Any]) -> None:
    for task in tasks:
        ray.cancel(task)
