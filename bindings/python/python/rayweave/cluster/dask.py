"""Jobs on Dask's distributed scheduler, and queries of rays in Dask arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from rayweave.cluster._job import Job, Packed, Range, collected, joined, part_of, planned
from rayweave.optics._given import package


def run(
    job: Job,
    client: Any,
    *,
    pieces: int | None = None,
    done: Mapping[Range, Any] | None = None,
    timeout: float | None = None,
) -> Any:
    """Runs a job on the workers of a `distributed.Client` in `pieces` ranges, by default four for each thread of the workers, and returns
    the joined result. Each worker receives the job once. Dask repeats parts of workers that die; if it gives up, or
    parts are not finished after `timeout` seconds, the error is an `Incomplete`."""
    distributed = package("distributed", "jobs on Dask")
    threads = sum(client.nthreads().values())
    todo, known = planned(job, pieces or 4 * max(threads, 1), done)
    # a task, unlike scattered data, is repeated if all workers that have its result die
    packed = client.submit(_kept, Packed(job), pure=False)
    # a key of the contents alone would return the result of an earlier run
    waiting = {client.submit(part_of, packed, span, pure=False): span for span in todo}
    finished = distributed.as_completed(waiting, timeout=timeout)
    return joined(job, known, collected(waiting, finished, known, lambda failure: type(failure).__name__ == "KilledWorker"))


def _kept(packed: Packed) -> Packed:
    return packed


def map_blocks(function: Callable[..., Any], model: Any, *arrays: Any, dtype: Any, **options: Any) -> Any:
    """A Dask array of type `dtype` whose blocks are `function(model, *blocks)`, for the blocks of `arrays` at the same place.

    `model` is a solid, a model, or anything else that can be pickled. It is sent to each worker once, not with each block, and compiled
    there once. `arrays` and `options` are those of `dask.array.map_blocks`: rays of the shape (n, 3) with an answer for each ray need
    `drop_axis=1`, and must not be divided along their second axis.

    >>> import numpy as np
    >>> import rayweave as rw
    >>> from rayweave import cluster
    >>> import dask.array as da  # doctest: +SKIP
    >>> origins = da.zeros((10**8, 3), chunks=(10**6, 3))  # doctest: +SKIP
    >>> directions = da.random.normal(size=(10**8, 3), chunks=(10**6, 3))  # doctest: +SKIP
    >>> def times(solid, origins, directions):
    ...     return solid.nearest(origins, directions, threads=1).t
    >>> t = cluster.dask.map_blocks(times, rw.sphere(1), origins, directions, drop_axis=1, dtype=float)  # doctest: +SKIP
    >>> float(t.mean())  # doctest: +SKIP
    1.0
    """
    array = package("dask.array", "arrays of Dask")
    packed = package("dask", "arrays of Dask").delayed(Packed(model), traverse=False)
    return array.map_blocks(_of_block, *arrays, rayweave_function=function, rayweave_model=packed, dtype=dtype, **options)


def _of_block(*blocks: Any, rayweave_function: Callable[..., Any], rayweave_model: Packed, **options: Any) -> Any:
    if not isinstance(rayweave_model, Packed):
        # Dask tries the function on empty blocks, before the model is there; it goes on without the result
        raise RuntimeError("the model is not there yet")
    return rayweave_function(rayweave_model.unpacked(), *blocks, **options)
