"""Jobs on MPI processes, by mpi4py."""

from __future__ import annotations

from typing import Any

from rayweave._core import RayweaveError
from rayweave.cluster._job import Job, Packed, Range, ranges
from rayweave.optics._given import package


def run(job: Job | None, comm: Any = None, *, pieces: int | None = None) -> Any:
    """Runs a job on all processes of a communicator, by default `MPI.COMM_WORLD`, and returns the joined result in process 0 and None in
    the others. Every process calls it; the job is that of process 0, from where it is sent once. The ranges, by default four for each
    process, are dealt out in turn. An error in one process is raised in all. MPI ends all processes if one of them dies: for long runs
    on unreliable machines write parts with the command.
    """
    if comm is None:
        comm = package("mpi4py.MPI", "jobs on MPI").COMM_WORLD
    # an error in one process is an error in all: the others would wait for its message forever
    plan: tuple[Packed, int, int] | None = None
    failure = ""
    if comm.rank == 0:
        try:
            plan = _plan(job)
        except Exception as error:
            failure = f"{type(error).__name__}: {error}"
    plan, failure = comm.bcast((plan, failure))
    if plan is None:
        raise RayweaveError(f"the job cannot be sent: {failure}")
    packed, total, step = plan
    own = ranges(total, pieces or 4 * comm.size, step=step)[comm.rank :: comm.size]
    parts: list[tuple[Range, Any]] = []
    try:
        parts = [(span, packed.part(span)) for span in own]
    except Exception as error:
        failure = f"process {comm.rank} failed: {type(error).__name__}: {error}"
    failures = [text for text in comm.allgather(failure) if text]
    if failures:
        raise RayweaveError("; ".join(failures))
    found = comm.gather(parts)
    if comm.rank > 0 or job is None:
        return None
    return job.join([part for _, part in sorted((pair for some in found for pair in some), key=lambda pair: pair[0])])


def _plan(job: Job | None) -> tuple[Packed, int, int]:
    if job is None:
        raise RayweaveError("process 0 has no job: pass the job there.")
    return Packed(job), job.total, job.step
