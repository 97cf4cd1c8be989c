"""Runs on many processes or machines, with results that are bit-identical to those of one process.

A job is a function of its arguments and a range of numbers: of photons, rays or items. Its parts run anywhere, in any order, and the
joined result does not depend on how the numbers were divided. The modules `futures`, `dask`, `ray` and `mpi` run jobs on
`concurrent.futures`, Dask, Ray and mpi4py; each has a function `run`.

>>> import rayweave.photons
>>> from concurrent.futures import ProcessPoolExecutor
>>> from rayweave import cluster
>>> detector = rayweave.photons.load("bar.gdml")  # doctest: +SKIP
>>> job = cluster.Photons(detector, rayweave.photons.point([0, 0, 0], 550), n=10**8)  # doctest: +SKIP
>>> with ProcessPoolExecutor() as executor:  # doctest: +SKIP
...     found = cluster.futures.run(job, executor)
"""

from rayweave.cluster import dask, futures, mpi, ray
from rayweave.cluster._job import Call, Incomplete, Job, Light, Packed, PhotonResult, Photons, missing, ranges

__all__ = [
    "Call",
    "Incomplete",
    "Job",
    "Light",
    "Packed",
    "PhotonResult",
    "Photons",
    "dask",
    "futures",
    "missing",
    "mpi",
    "ranges",
    "ray",
]
