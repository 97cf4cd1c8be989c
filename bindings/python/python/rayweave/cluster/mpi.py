"""Jobs on MPI processes, by mpi4py."""

from __future__ import annotations

from typing import Any

from rayweave.cluster._job import Job, Packed, ranges
from rayweave.optics._given import package


def run(job: Job | None, comm: Any = None, *, pieces: int | None = None) -> Any:
    """Runs a job on all processes of a communicator, by default `MPI.COMM_WORLD`, and returns the joined result in process 0 and None in
    the others. Every process calls it; the job is that of process 0, from where it is sent once. The ranges, by default four for each
    process, are dealt out in turn. MPI ends all processes if one of them dies: for long runs on unreliable machines write parts with
    the command.
    """
    if comm is None:
        comm = package("mpi4py.MPI", "jobs on MPI").COMM_WORLD
    packed, total, step = comm.bcast(None if job is None else (Packed(job), job.total, job.step))
    own = ranges(total, pieces or 4 * comm.size, step=step)[comm.rank :: comm.size]
    found = comm.gather([(span, packed.part(span)) for span in own])
    if comm.rank > 0:
        return None
    assert job is not None, "process 0 has the job"
    return job.join([part for _, part in sorted((pair for some in found for pair in some), key=lambda pair: pair[0])])
