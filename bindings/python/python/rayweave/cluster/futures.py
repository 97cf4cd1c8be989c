"""Jobs on executors of `concurrent.futures`: processes of one machine, or of many (`mpi4py.futures`)."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from concurrent.futures import BrokenExecutor, Executor, as_completed
from pathlib import Path
from typing import Any

from rayweave.cluster._job import Job, Packed, Range, collected, joined, planned


class _InFile(Packed):
    """A job in a temporary file, so that it is not sent with each of its parts."""

    def __init__(self, job: Job, folder: str) -> None:
        super().__init__(job)
        self.path = Path(folder, self.key)
        self.path.write_bytes(self.data)
        del self.data

    def read(self) -> bytes:
        return self.path.read_bytes()


def run(
    job: Job,
    executor: Executor,
    *,
    pieces: int | None = None,
    done: Mapping[Range, Any] | None = None,
    folder: str | None = None,
    timeout: float | None = None,
) -> Any:
    """Runs a job in `pieces` ranges, by default four for each core of this machine, and returns the joined result.

    `folder`, by default that for temporary files, must be visible to all processes; the job is written there once. If workers die, or
    parts are not finished after `timeout` seconds, the error is an `Incomplete` with the results so far. Parts that have started run
    on in the executor.
    """
    todo, known = planned(job, pieces or 4 * (os.cpu_count() or 1), done)
    reason = "workers died"
    with tempfile.TemporaryDirectory(dir=folder) as place:
        packed = _InFile(job, place)
        waiting = {}
        try:
            for span in todo:
                waiting[executor.submit(packed.part, span)] = span
        except RuntimeError as error:
            # the executor is broken
            reason = f"a part could not be started ({error})"
        reason = collected(waiting, as_completed(waiting, timeout), known, _is_dead, reason)
    return joined(job, known, reason)


def _is_dead(failure: BaseException) -> bool:
    return isinstance(failure, BrokenExecutor)
