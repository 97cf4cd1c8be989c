"""Pickles of detectors, sources and systems; jobs on several processes, with the bits of one; workers that are killed.

Dask, Ray and mpi4py are optional: their tests are skipped where they are not installed.
"""

import multiprocessing
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import rayweave
import rayweave.photons as rp
from rayweave import RayweaveError, cluster, optics

ROOT = Path(__file__).resolve().parents[3]
GUIDE = (ROOT / "docs/guides/photons.md").read_text(encoding="utf-8")
BAR = re.search(r"^```xml\n(.*?)^```$", GUIDE, re.MULTILINE | re.DOTALL)[1]


def again(thing):
    return pickle.loads(pickle.dumps(thing))


def same(a, b):
    """True if two dicts of columns have the same bits."""
    return list(a) == list(b) and all(x.dtype == y.dtype and x.tobytes() == y.tobytes() for x, y in zip(a.values(), b.values()))


def photon_job(n=9000):
    detector = rp.loads(BAR)
    return cluster.Photons(detector, rp.point([0, 0, 0], 550), n, seed=3)


def bench():
    lens = optics.biconvex_lens(50, 50, 6, aperture=20, material="N-BK7").rotate_x(2).translate([0, 0, 10])
    screen = optics.detector(30).translate([0, 0, 60])
    lamp = optics.beam(15, 5000, wavelength_nm={486.0: 1, 656.0: 2}).rotate_y(1).polarised(1, 0.5, 0, 0)
    return optics.System([lens, screen], unit="mm"), lamp


def whole_of(job):
    """The result of a job on one process, by the function that it divides."""
    return job.detector.simulate(job.source, job.total, **job.settings)


def test_detectors_and_sources_pickle():
    detector = rp.loads(BAR)
    for source in (
        rp.point([0, 0, 0], 550, towards=[0, 0, 1], cone_degrees=20),
        rp.disc([0, 0, 0], 3, ("uniform", 500, 600), normal=[0, 1, 0]),
        rp.photons([[0, 0, 0]] * 50, [[0, 0, 1]] * 50, wavelengths_nm=550),
        rp.volume(detector, "Bar", 550),
    ):
        twin, copy = again((detector, source))
        a, b = detector.simulate(source, 50, seed=1).hits, twin.simulate(copy, 50, seed=1).hits
        assert same(dict(a), dict(b)) and a.sensor_paths == b.sensor_paths
        assert repr(source) == repr(copy) and repr(detector) == repr(twin)
    assert len(pickle.dumps(detector)) < 2 * len(BAR) + 4000


def test_a_changed_array_does_not_change_the_pickle():
    positions = np.zeros((5, 3))
    source = rp.photons(positions, [[0, 0, 1]] * 5, wavelengths_nm=550)
    positions[:] = 1000.0
    detector = rp.loads(BAR)
    assert same(dict(detector.simulate(source).hits), dict(detector.simulate(again(source)).hits))


def test_systems_and_light_pickle():
    system, lamp = bench()
    twin, copy = again((system, lamp))
    settings = {"branches": "both", "threshold": 1e-6}
    a, b = system.trace(lamp, **settings), twin.trace(copy, **settings)
    assert same(a.columns, b.columns) and a.balance == b.balance
    cube = optics.beam_splitter_cube(20)
    assert [part.name for part in again(cube)] == ["cube1", "cube2"]
    assert again(optics.glass("N-SF11")) == optics.glass("N-SF11")
    with pytest.raises(RayweaveError, match="cannot be pickled"):
        pickle.dumps(optics.Glass.sellmeier("own", [1.0], [0.01]))


def test_ranges_of_rays():
    system, lamp = bench()
    total = len(lamp)
    whole = system.trace(lamp, branches="both", threshold=1e-6)
    parts = [system.trace(lamp, branches="both", threshold=1e-6, range=span) for span in [(0, 2048), (2048, total)]]
    before = parts[0].rows
    parent = parts[1]["parent"]
    joined = {name: np.concatenate([part[name] for part in parts]) for name in whole}
    joined["parent"] = np.concatenate([parts[0]["parent"], np.where(parent < 0, parent, parent + before)])
    assert same(whole.columns, joined)
    with pytest.raises(RayweaveError, match="start and end at multiples of 2048"):
        system.trace(lamp, range=(0, 1000))


def test_ranges():
    assert cluster.ranges(0, 3) == [(0, 0)] and cluster.ranges(2, 5) == [(0, 1), (1, 2)]
    for total, pieces, step in [(10_000, 7, 2048), (4096, 3, 2048), (100, 100, 1), (5000, 1, 2048)]:
        spans = cluster.ranges(total, pieces, step=step)
        assert spans[0][0] == 0 and spans[-1][1] == total and len(spans) <= pieces
        assert all(a[1] == b[0] and b[0] % step == 0 for a, b in zip(spans, spans[1:]))
        assert cluster.missing(total, spans) == []


def test_joined_photons_are_those_of_one_run(rng):
    job = photon_job()
    whole = whole_of(job)
    for _ in range(5):
        cuts = [0, *sorted(rng.integers(0, job.total, 4).tolist()), job.total]
        found = job.join([job.part(*span) for span in zip(cuts, cuts[1:])])
        assert same(dict(whole.hits), found.hits) and found.sensor_paths == whole.hits.sensor_paths
        assert {end: count for end, count in found.ends.items() if count} == {
            end: count for end, count in whole.ends.items() if count
        }
        assert (found.photons, found.steps) == (whole.photons, whole.steps)


def squares(first, last):
    return np.arange(first, last) ** 2


def processes(count=2):
    # a forked process would share the threads of this one
    return ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"))


def test_concurrent_futures():
    job = photon_job()
    system, lamp = bench()
    light = cluster.Light(system, lamp, branches="both", threshold=1e-6)
    with processes() as executor:
        found = cluster.futures.run(job, executor, pieces=7)
        traced = cluster.futures.run(light, executor, pieces=2)
        numbers = cluster.futures.run(cluster.Call(squares, total=1000), executor, pieces=13)
    assert same(dict(whole_of(job).hits), found.hits)
    assert same(dict(system.trace(lamp, branches="both", threshold=1e-6).columns), traced)
    np.testing.assert_array_equal(numbers, np.arange(1000) ** 2)


def slicings(job, rng, times, run):
    """Runs a job in random slices and compares it with one run each time; `run` takes a number of pieces and the results that are
    known already, which are random ranges."""
    whole = whole_of(job)
    for _ in range(times):
        cuts = sorted(rng.choice(job.total, 4, replace=False).tolist())
        done = {span: job.part(*span) for span in zip(cuts[::2], cuts[1::2])}
        found = run(int(rng.integers(1, 9)), done)
        assert same(dict(whole.hits), found.hits) and found.sensor_paths == whole.hits.sensor_paths, cuts
        assert (found.photons, found.steps) == (whole.photons, whole.steps), cuts


def test_random_slicings(rng):
    job = photon_job(1000)
    with processes() as executor:
        slicings(job, rng, 50, lambda pieces, done: cluster.futures.run(job, executor, pieces=pieces, done=done))


@pytest.fixture
def marks(tmp_path_factory):
    return tmp_path_factory.mktemp("marks")


def slow(marks, first, last):
    """Numbers; the first process that computes the middle waits for long."""
    if first <= 50 < last and not list(Path(marks).iterdir()):
        Path(marks, "slow").touch()
        time.sleep(600)
    return np.arange(first, last)


def kill(executor):
    """Ends an executor with its running parts, which it would wait for."""
    children = list(executor._processes.values())
    executor.shutdown(wait=False, cancel_futures=True)
    for child in children:
        child.kill()


def test_a_slow_worker_leaves_its_range(tmp_path):
    job = cluster.Call(slow, str(tmp_path), total=100)
    executor = processes()
    try:
        # both processes have started, so that the limit counts the work only
        cluster.futures.run(cluster.Call(squares, total=100), executor, pieces=4)
        with pytest.raises(cluster.Incomplete, match="are missing: they were not finished within the timeout") as caught:
            cluster.futures.run(job, executor, pieces=10, timeout=10)
    finally:
        kill(executor)
    assert caught.value.missing == [(50, 60)]
    with processes(1) as executor:
        np.testing.assert_array_equal(cluster.futures.run(job, executor, done=caught.value.done), np.arange(100))


def late(first, last):
    raise TimeoutError("of the function itself")


def test_a_timeout_of_the_function_is_its_error():
    with processes(1) as executor, pytest.raises(TimeoutError, match="of the function itself"):
        cluster.futures.run(cluster.Call(late, total=10), executor, timeout=600)


def mortal(marks, deaths, first, last):
    """Numbers; the process kills itself the first times that it computes the middle."""
    if first <= 50 < last and len(list(Path(marks).iterdir())) < deaths:
        Path(marks, str(os.getpid())).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return np.arange(first, last)


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="processes cannot be killed by a signal here")
def test_killed_workers_leave_missing_ranges(tmp_path):
    job = cluster.Call(mortal, str(tmp_path), 2, total=100)
    done = {}
    for _ in range(2):
        with processes() as executor, pytest.raises(cluster.Incomplete, match="are missing: a worker died") as caught:
            cluster.futures.run(job, executor, pieces=10, done=done)
        done = caught.value.done
        assert any(first <= 50 < last for first, last in caught.value.missing)
        assert cluster.missing(100, done) == caught.value.missing
    with processes() as executor:
        np.testing.assert_array_equal(cluster.futures.run(job, executor, pieces=10, done=done), np.arange(100))


def failing(marks, first, last):
    """A function with a bug; leaves a mark for each part that is computed."""
    Path(marks, str(first)).touch()
    raise RuntimeError(f"a bug at {first}")


def test_an_error_of_the_job_is_no_dead_worker(tmp_path):
    job = cluster.Call(failing, str(tmp_path), total=1000)
    with processes(1) as executor, pytest.raises(RuntimeError, match="a bug at 0"):
        cluster.futures.run(job, executor, pieces=1000)
    # parts that had not started were cancelled
    assert len(list(tmp_path.iterdir())) < 500


def test_results_that_overlap_are_rejected():
    job = cluster.Call(squares, total=10)
    with processes(1) as executor:
        with pytest.raises(RayweaveError, match="the ranges 0:5 and 3:10: they overlap"):
            cluster.futures.run(job, executor, done={(0, 5): squares(0, 5), (3, 10): squares(3, 10)})
        with pytest.raises(RayweaveError, match="done reaches 12: the job has 10 items"):
            cluster.futures.run(job, executor, done={(3, 12): squares(3, 12)})


def test_incomplete_results_pickle():
    error = cluster.Incomplete([(0, 5)], {(5, 7): np.arange(2)}, "a worker died")
    found = again(error)
    assert str(found) == str(error) and found.missing == [(0, 5)] and list(found.done) == [(5, 7)]


def test_errors_of_parts_pass_through():
    with processes(1) as executor, pytest.raises(RayweaveError, match="0 to 9000"):
        job = photon_job()
        job.part(0, 10_000)
        cluster.futures.run(job, executor)
    with pytest.raises(RayweaveError, match="a job has no range"):
        cluster.Photons(rp.loads(BAR), rp.point([0, 0, 0], 550), 10, range=(0, 5))


@pytest.mark.filterwarnings("ignore")
def test_dask(tmp_path, rng, marks):
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    job, short = photon_job(), photon_job(1000)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as local:
        with distributed.Client(local) as client:
            found = cluster.dask.run(job, client, pieces=9)
            numbers = cluster.dask.run(cluster.Call(mortal, str(tmp_path), 2, total=100), client, pieces=10)
            slicings(short, rng, 50, lambda pieces, done: cluster.dask.run(short, client, pieces=pieces, done=done))
            with pytest.raises(cluster.Incomplete, match="not finished within the timeout"):
                cluster.dask.run(cluster.Call(slow, str(marks), total=100), client, pieces=10, timeout=5)
    assert same(dict(whole_of(job).hits), found.hits)
    # killed twice; Dask has computed the parts again
    np.testing.assert_array_equal(numbers, np.arange(100))
    assert len(list(tmp_path.iterdir())) == 2


def first_times(solid, origins, directions):
    return solid.nearest(origins, directions, threads=1).t


def counted(folder):
    """A sphere; leaves a mark in each process that makes it."""
    Path(folder, str(os.getpid())).touch()
    return rayweave.sphere(1)


class Marked:
    """A thing whose unpickling leaves a mark."""

    def __init__(self, folder):
        self.folder = folder

    def __reduce__(self):
        return counted, (self.folder,)


@pytest.mark.filterwarnings("ignore")
def test_blocks_of_dask_arrays(tmp_path, rng):
    array = pytest.importorskip("dask.array", reason="Dask is not installed")
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    origins, directions = 3 * rng.normal(size=(10_000, 3)), rng.normal(size=(10_000, 3))
    blocks = [array.from_array(rays, chunks=(700, 3)) for rays in (origins, directions)]
    times = cluster.dask.map_blocks(first_times, Marked(str(tmp_path)), *blocks, drop_axis=1, dtype=float)
    assert times.shape == (10_000,) and times.dtype == float
    expected = rayweave.sphere(1).nearest(origins, directions).t
    assert times.compute(scheduler="sync").tobytes() == expected.tobytes()
    assert len(list(tmp_path.iterdir())) == 1
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as local:
        with distributed.Client(local):
            assert times.compute().tobytes() == expected.tobytes()
    # one process here, and at most two workers, each once
    assert 2 <= len(list(tmp_path.iterdir())) <= 3


@pytest.mark.filterwarnings("ignore")
def test_ray(tmp_path, rng, marks):
    ray = pytest.importorskip("ray", reason="Ray is not installed")
    job, short = photon_job(), photon_job(1000)
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, runtime_env={"env_vars": {"PYTHONPATH": str(Path(__file__).parent)}})
    try:
        found = cluster.ray.run(job, pieces=9)
        numbers = cluster.ray.run(cluster.Call(mortal, str(tmp_path), 2, total=100), pieces=10)
        slicings(short, rng, 50, lambda pieces, done: cluster.ray.run(short, pieces=pieces, done=done))
        with pytest.raises(cluster.Incomplete, match="not finished within the timeout"):
            cluster.ray.run(cluster.Call(slow, str(marks), total=100), pieces=10, timeout=5)
    finally:
        ray.shutdown()
    assert same(dict(whole_of(job).hits), found.hits)
    np.testing.assert_array_equal(numbers, np.arange(100))
    assert len(list(tmp_path.iterdir())) == 2


MPI = """
import hashlib, sys
import numpy as np
from mpi4py import MPI
sys.path.insert(0, sys.argv[1])
from rayweave import cluster
from test_cluster import photon_job, same, whole_of
rank = MPI.COMM_WORLD.rank
job = photon_job() if rank == 0 else None
found = cluster.mpi.run(job, pieces=9)
assert (found is None) == (rank > 0)
if rank == 0:
    assert same(dict(whole_of(job).hits), found.hits)
    print("equal on", MPI.COMM_WORLD.size)
"""


def test_mpi(tmp_path):
    pytest.importorskip("mpi4py", reason="mpi4py is not installed")
    if shutil.which("mpiexec") is None:
        pytest.skip("mpiexec is not installed")
    script = tmp_path / "run.py"
    script.write_text(MPI)
    # Open MPI refuses to run as root, and more processes than cores; other implementations ignore these
    allowed = ["OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_rmaps_base_oversubscribe"]
    done = subprocess.run(
        ["mpiexec", "-n", "3", sys.executable, str(script), str(Path(__file__).parent)],
        env=os.environ | dict.fromkeys(allowed, "1"),
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0 and "equal on 3" in done.stdout, done.stderr
