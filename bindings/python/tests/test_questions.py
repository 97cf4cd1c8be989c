"""Queries along rays, compared with closed forms and with sampling."""

import math
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import rayweave
from rayweave import Crossings, RayweaveError, box, half_space, slab, sphere

INF = math.inf


def random_rays(rng, count, spread=4.0):
    return rng.uniform(-spread, spread, (count, 3)), rng.normal(size=(count, 3)) * rng.uniform(0.1, 10, (count, 1))


def sphere_times(origins, directions, radius):
    """Both roots of |o + t d| = r, NaN where there are none."""
    a = np.sum(directions**2, axis=1)
    b = np.sum(origins * directions, axis=1)
    closest = -b / a
    miss = np.sum((origins + closest[:, None] * directions) ** 2, axis=1)
    with np.errstate(invalid="ignore"):
        half = np.sqrt((radius**2 - miss) / a)
    return closest - half, closest + half


def box_times(origins, directions, half):
    """Entry and exit of the slabs |x| < half, NaN where the ray misses."""
    ends = np.stack([(-half - origins) / directions, (half - origins) / directions])
    enter, leave = ends.min(axis=0).max(axis=1), ends.max(axis=0).min(axis=1)
    return np.where(enter < leave, enter, np.nan), np.where(enter < leave, leave, np.nan)


@pytest.mark.parametrize(
    ("solid", "times"),
    [
        (sphere(2), lambda o, d: sphere_times(o, d, 2.0)),
        (box([2, 4, 6]), lambda o, d: box_times(o, d, np.array([1.0, 2.0, 3.0]))),
    ],
)
def test_hits_are_the_closed_form(rng, solid, times):
    origins, directions = random_rays(rng, 5000)
    enter, leave = times(origins, directions)
    hits = solid.hits(origins, directions)
    assert hits.shape == (2, 5000) and hits.dtype == np.float64 and hits.flags.c_contiguous
    found = ~np.isnan(enter)
    assert 0.1 < found.mean() < 0.9
    np.testing.assert_allclose(hits[0, found], enter[found], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(hits[1, found], leave[found], rtol=1e-9, atol=1e-9)
    assert (hits[:, ~found] == INF).all()


def lumps(rng):
    """A union of overlapping balls with a hole."""
    balls = [sphere(float(rng.uniform(0.3, 1.5))).translate(rng.uniform(-3, 3, 3)) for _ in range(12)]
    return rayweave.union(balls) - box([1, 1, 20])


def test_hits_agree_with_contains_between_them(rng):
    solid = lumps(rng)
    origins, directions = random_rays(rng, 2000)
    hits = solid.hits(origins, directions)
    assert hits.shape[0] > 4
    inside = np.zeros(hits.shape[1], bool)
    for row in range(hits.shape[0] - 1):
        finite = np.isfinite(hits[row + 1])
        middle = 0.5 * (hits[row] + hits[row + 1])[finite]
        points = origins[finite] + middle[:, None] * directions[finite]
        inside = row % 2 == 0
        assert (solid.contains(points) == inside).all()


def test_unbounded_solids_show_infinities():
    below = half_space([0, 0, 2], 6)
    assert below.hits([0, 0, 0], [0, 0, 1]).tolist() == [[-INF], [3]]
    assert below.hits([0, 0, 0], [0, 0, -1]).tolist() == [[-3], [INF]]
    assert (~sphere(1)).hits([0, 0, -3], [0, 0, 1]).tolist() == [[-INF], [2], [4], [INF]]
    assert slab([0, 0, 1], -1, 1).hits([0, 0, 0], [1, 0, 0]).tolist() == [[-INF], [INF]]


def test_rows_are_even_and_just_enough():
    rays = [[0, 0, -9], [5, 0, -9]], [0, 0, 1]
    two = sphere(1) | sphere(1).translate([0, 0, 3])
    assert two.hits(*rays).tolist() == [[8, INF], [10, INF], [11, INF], [13, INF]]
    assert sphere(1).hits([[5, 0, 0]], [0, 0, 1]).shape == (2, 1)
    assert sphere(1).hits(np.zeros((0, 3)), [0, 0, 1]).shape == (2, 0)


def test_windows():
    solid = sphere(1) | sphere(1).translate([0, 0, 3])
    ray = [0, 0, -2], [0, 0, 1]
    assert solid.hits(*ray)[:, 0].tolist() == [1, 3, 4, 6]
    # inside at both ends: from -inf, to +inf
    assert solid.hits(*ray, 2, 5)[:, 0].tolist() == [-INF, 3, 4, INF]
    # a root at t_min or t_max is not in the window
    assert solid.hits(*ray, t_min=1, t_max=4)[:, 0].tolist() == [-INF, 3]
    assert solid.nearest(*ray, t_min=1).t.tolist() == [3]
    assert solid.nearest(*ray, t_min=3).t.tolist() == [4]
    assert solid.nearest(*ray, t_min=-INF).t.tolist() == [1]
    assert solid.nearest(*ray, t_max=0.5).t.tolist() == [INF]
    assert solid.nearest([0, 0, 0], [0, 0, 1]).t.tolist() == [1]
    for window in [(1, 1), (2, 1), (math.nan, 1), (0, math.nan)]:
        with pytest.raises(RayweaveError, match="t_min = .*t_max = "):
            solid.hits(*ray, *window)


def test_crossings_have_points_normals_and_faces(rng):
    solid = sphere(2).named("ball") - box(2).named("hole")
    origins, directions = random_rays(rng, 3000)
    answer = solid.crossings(origins, directions)
    assert type(answer) is Crossings and len(answer) == len(answer.t) > 1000
    rows = {"ray": np.int64, "t": np.float64, "enters": np.bool_, "surface": np.int32, "leaf": np.int32}
    for name, dtype in rows.items():
        assert getattr(answer, name).dtype == dtype and getattr(answer, name).shape == (len(answer),)
    assert answer.offsets.dtype == np.int64 and answer.offsets.shape == (3001,)
    assert answer.start_inside.dtype == np.bool_ and answer.start_inside.shape == (3000,)
    assert answer.point.shape == answer.normal.shape == (len(answer), 3)
    # sorted by ray, then t
    assert (np.diff(answer.ray) >= 0).all()
    assert (np.diff(answer.t)[np.diff(answer.ray) == 0] > 0).all()
    np.testing.assert_array_equal(answer.offsets, np.searchsorted(answer.ray, np.arange(3001)))
    # points on the ray, unit normals against it where it enters
    o, d = origins[answer.ray], directions[answer.ray]
    np.testing.assert_allclose(answer.point, o + answer.t[:, None] * d, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(answer.normal, axis=1), 1, atol=1e-15)
    np.testing.assert_array_equal(np.sum(answer.normal * d, axis=1) < 0, answer.enters)
    # faces: the ball's normal is radial, those of the hole point into it
    names = np.array(answer.surface_names)[answer.surface]
    on_ball = names == "ball.side"
    assert on_ball.any() and (~on_ball).any()
    np.testing.assert_allclose(answer.normal[on_ball], answer.point[on_ball] / 2, atol=1e-9)
    np.testing.assert_allclose(np.abs(answer.point[~on_ball]).max(axis=1), 1, atol=1e-12)
    axis = np.abs(answer.point[~on_ball]).argmax(axis=1)
    inward = -np.sign(np.take_along_axis(answer.point[~on_ball], axis[:, None], 1))
    np.testing.assert_allclose(np.take_along_axis(answer.normal[~on_ball], axis[:, None], 1), inward)
    assert all(name.startswith("hole.") for name in names[~on_ball])
    np.testing.assert_array_equal(answer.leaf, np.where(on_ball, 0, 1))


def test_crossings_and_hits_and_nearest_agree(rng):
    solid = ~lumps(rng)
    origins, directions = random_rays(rng, 3000)
    answer = solid.crossings(origins, directions)
    hits, surfaces = solid.hits(origins, directions, return_surfaces=True)
    assert surfaces.dtype == np.int32 and surfaces.shape == hits.shape
    finite = np.isfinite(hits)
    np.testing.assert_array_equal(hits.T[finite.T], answer.t)
    np.testing.assert_array_equal(surfaces.T[finite.T], answer.surface)
    assert (surfaces[~finite] == -1).all()
    np.testing.assert_array_equal(hits[0] == -INF, answer.start_inside)
    enters = (np.cumsum(np.ones_like(hits), axis=0) % 2 == 1).T[finite.T]
    np.testing.assert_array_equal(answer.enters, enters)
    # the first crossing after t = 0
    ahead = np.where(hits > 0, hits, INF).min(axis=0)
    nearest = solid.nearest(origins, directions)
    np.testing.assert_array_equal(nearest.t, ahead)
    np.testing.assert_array_equal(nearest.ray, np.arange(3000))
    np.testing.assert_array_equal(nearest.offsets, np.arange(3001))
    np.testing.assert_array_equal(nearest.start_inside, solid.contains(origins))
    found = nearest.t < INF
    assert found.any() and (~found).any()
    for name in ("point", "normal"):
        value = getattr(nearest, name)
        assert np.isnan(value[~found]).all() and np.isfinite(value[found]).all()
    assert (nearest.surface[~found] == -1).all() and (nearest.leaf[~found] == -1).all()
    assert not nearest.enters[~found].any()


def test_evaluators_and_threads_agree_to_the_bit(rng):
    solid = lumps(rng) | rayweave.torus(2, 0.5).rotate_x(40)
    origins, directions = random_rays(rng, 4000)
    expected = solid.hits(origins, directions, return_surfaces=True)
    evaluators = [{"evaluator": name} for name in ("weave", "reference", "single_hit")]
    for options in [*evaluators, {"evaluator": "weave", "threads": 1}, {"evaluator": "reference", "threads": 3}, {"threads": 7}]:
        for a, b in zip(expected, solid.hits(origins, directions, return_surfaces=True, **options), strict=True):
            np.testing.assert_array_equal(a, b)
        a, b = solid.nearest(origins, directions), solid.nearest(origins, directions, **options)
        for name in ("t", "point", "normal", "surface", "leaf", "enters"):
            np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
        np.testing.assert_array_equal(solid.contains(origins), solid.contains(origins, **options))


def test_variable_for_threads(rng, monkeypatch):
    origins, directions = random_rays(rng, 5000)
    expected = sphere(2).hits(origins, directions)
    for value in ("1", "3", "nonsense"):
        monkeypatch.setenv("RAYWEAVE_THREADS", value)
        np.testing.assert_array_equal(sphere(2).hits(origins, directions), expected)


@pytest.mark.parametrize(
    "layout",
    [
        lambda x: x.tolist(),
        lambda x: x.astype(np.float32),
        lambda x: x.astype(">f8"),
        np.asfortranarray,
        lambda x: np.flip(np.flip(x, 0).copy(), 0),
        lambda x: np.concatenate((x, x), axis=1)[:, :3],
        lambda x: np.repeat(x, 3, axis=0)[::3],
        lambda x: x[:, ::-1].copy()[:, ::-1],
        lambda x: np.lib.stride_tricks.as_strided(x, x.shape, x.strides, writeable=False),
    ],
)
def test_any_layout(rng, layout):
    origins, directions = (np.round(x, 2).astype(np.float32).astype(float) for x in random_rays(rng, 300))
    expected = sphere(2).hits(origins, directions)
    np.testing.assert_array_equal(sphere(2).hits(layout(origins), directions), expected)
    np.testing.assert_array_equal(sphere(2).hits(origins, layout(directions)), expected)
    np.testing.assert_array_equal(sphere(2).contains(layout(origins)), sphere(2).contains(origins))


def test_rays_from_record_arrays():
    rays = np.zeros(5, dtype=[("flag", "i1"), ("o", "f8", 3), ("d", "f8", 3)])
    rays["o"][:, 2] = -5
    rays["d"][:, 2] = 1
    assert (sphere(1).hits(rays["o"], rays["d"])[0] == 4).all()


def test_broadcasting():
    down = [0, 0, -1]
    origins = np.array([[0, 0, 5], [0.5, 0, 5], [9, 0, 5]])
    expected = sphere(1).hits(origins, np.tile(down, (3, 1)))
    np.testing.assert_array_equal(sphere(1).hits(origins, down), expected)
    np.testing.assert_array_equal(sphere(1).hits(origins, [down]), expected)
    one_origin = sphere(1).hits([0, 0, 5], [down, [0, 0, 1]])
    assert one_origin.tolist() == [[4, -6], [6, -4]]
    assert sphere(1).hits([0, 0, 5], down).shape == (2, 1)
    assert sphere(1).nearest([0, 0, 5], down).t.shape == (1,)
    assert sphere(1).contains([0, 0, 0]).tolist() == [True]
    assert sphere(1).hits(np.zeros((0, 3)), down).shape == (2, 0)
    assert len(sphere(1).crossings(np.zeros((0, 3)), np.zeros((0, 3)))) == 0
    assert sphere(1).contains(np.zeros((0, 3))).shape == (0,)


def test_out():
    origins, down = np.array([[0, 0, 5.0], [9, 0, 5]]), [0, 0, -1]
    out = np.full((4, 2), 7.0)
    assert sphere(1).hits(origins, down, out=out) is out
    assert out.tolist() == [[4, INF], [6, INF], [INF, INF], [INF, INF]]
    view = np.zeros((2, 6), order="F")[:, ::-3]
    hits, surfaces = sphere(1).hits(origins, down, out=view, return_surfaces=True)
    assert hits is view and view.tolist() == [[4, INF], [6, INF]] and surfaces.tolist() == [[0, -1], [0, -1]]
    for bad in (np.zeros((3, 2)), np.zeros((2, 3)), np.zeros((0, 2))):
        with pytest.raises(RayweaveError, match="out has shape"):
            sphere(1).hits(origins, down, out=bad)
    for bad in (np.zeros((2, 2), np.float32), np.zeros(4), [[0, 0], [0, 0]]):
        with pytest.raises(TypeError, match="out must be a two-dimensional float64 array"):
            sphere(1).hits(origins, down, out=bad)
    with pytest.raises(RayweaveError, match="out: .*not writeable"):
        sphere(1).hits(origins, down, out=np.broadcast_to(0.0, (2, 2)))


@pytest.mark.parametrize(
    ("origins", "directions", "message"),
    [
        (np.zeros((4, 2)), [0, 0, 1], r"origins has shape \(4, 2\): it must be \(N, 3\), \(3,\), or a grid"),
        ([0, 0, 0], np.zeros((2, 2, 3)), r"directions\[0, 0\] has length 0"),
        (np.zeros(()), [0, 0, 1], r"origins has shape \(\)"),
        ([0, 0, 0], [0, 0, 0], "directions has length 0"),
        (np.zeros((4, 3)), [[0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 0]], r"directions\[3\] has length 0"),
        ([[0, 0, 0], [0, math.nan, 0]], [0, 0, 1], r"origins\[1\] is \(0.0, NaN, 0.0\): every component must be finite"),
        ([0, 0, 0], [0, 0, INF], r"directions is \(0.0, 0.0, inf\)"),
        ([0, 0, 0], [[0, 0, 1], [0, 1e200, 0]], r"directions\[1\] is .* from -1e100 to 1e100"),
        ([0, 0, 0], [[0, 0, 1], [0, -1e-200, 0]], r"directions\[1\] is .* at least 1e-100"),
        ([[-1e200, 0, 0]], [0, 0, 1], r"origins\[0\] is .* from -1e100 to 1e100"),
        (np.zeros((2, 3)), np.ones((3, 3)), "there are 2 origins and 3 directions"),
        ([[0, 0], [0]], [0, 0, 1], "origins is not an array of numbers"),
    ],
)
def test_bad_rays_are_named(origins, directions, message):
    for question in (sphere(1).hits, sphere(1).crossings, sphere(1).nearest):
        with pytest.raises(RayweaveError, match=message):
            question(origins, directions)


@pytest.mark.parametrize("length", [1e-99, 1e-30, 1.0, 1e30, 1e99])
def test_directions_of_any_length(length):
    shapes = [sphere(2), rayweave.torus(2, 1), box(4), rayweave.cone(2, 1, 4), rayweave.cylinder(2)]
    for solid in shapes:
        unit = solid.hits([1.1, 0.2, -5], [0, 0.1, 1])
        scaled = solid.hits([1.1, 0.2, -5], np.array([0, 0.1, 1]) * length)
        np.testing.assert_allclose(scaled * length, unit, rtol=1e-12)
        assert np.isfinite(unit[0, 0])


def test_wrong_types_are_type_errors():
    ball = sphere(1)
    for bad in ("up", [True, False, True], [1j, 0, 0], None, [None, 1, 2]):
        with pytest.raises(TypeError, match="directions (has dtype|is None)"):
            ball.hits([0, 0, 0], bad)
        with pytest.raises(TypeError, match="points (has dtype|is None)"):
            ball.contains(bad)
    with pytest.raises(TypeError, match="threads is '"):
        ball.hits([0, 0, 0], [0, 0, 1], threads="all")
    with pytest.raises(TypeError):
        ball.hits([0, 0, 0], [0, 0, 1], 0, 1, True)


def test_bad_options():
    for threads in (0, -1):
        with pytest.raises(RayweaveError, match=f"threads is {threads}"):
            sphere(1).hits([0, 0, 0], [0, 0, 1], threads=threads)
    with pytest.raises(RayweaveError, match="evaluator is 'weaver'"):
        sphere(1).contains([0, 0, 0], evaluator="weaver")


def test_more_rays_than_memory_are_refused():
    origins = np.broadcast_to(np.zeros(3), (10**17, 3))
    for question in (sphere(1).hits, sphere(1).crossings, sphere(1).nearest):
        with pytest.raises(MemoryError):
            question([0, 0, 0], np.broadcast_to(np.ones(3), (10**17, 3)))
    with pytest.raises(MemoryError):
        sphere(1).contains(origins)


def test_a_solid_that_cannot_be_compiled():
    huge = sphere(1e60).scale(1e300)
    with pytest.raises(RayweaveError, match="sphere"):
        huge.hits([0, 0, 0], [0, 0, 1])


def test_other_threads_run_meanwhile(rng):
    """The interpreter is not blocked while rays are traced, and many threads can query one solid."""
    solid = lumps(rng)
    origins, directions = random_rays(rng, 100_000)
    expected = solid.nearest(origins, directions).t
    turns, done, results = 0, threading.Event(), []

    def work():
        results.extend(solid.nearest(origins, directions, threads=1).t for _ in range(3))
        done.set()

    worker = threading.Thread(target=work)
    worker.start()
    while not done.is_set():
        turns += 1
    worker.join()
    assert turns > 1000
    assert all((result == expected).all() for result in results)


# a shell without job control starts background processes with the signal ignored, and children inherit that
LONG_QUESTION = """
import signal
import numpy as np, rayweave
signal.signal(signal.SIGINT, signal.default_int_handler)
solid = rayweave.union([rayweave.sphere(1).translate([k % 7, k % 11, k % 13]) for k in range(300)])
origins = np.random.default_rng(1).normal(size=(400_000, 3))
print("ready", flush=True)
try:
    while True:
        solid.crossings(origins, -origins, evaluator="reference", threads=THREADS)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent in another way there")
@pytest.mark.parametrize("threads", [1, 3])
def test_ctrl_c_stops_a_query(threads):
    program = LONG_QUESTION.replace("THREADS", str(threads))
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.monotonic()
        process.send_signal(signal.SIGINT)
        try:
            assert process.communicate(timeout=60)[0] == "interrupted\n"
        finally:
            process.kill()
        # the query itself takes many times as long
        assert time.monotonic() - sent < 20
        assert process.returncode == 0


# each takes seconds or more: a solid of two million leaves, and a file of a hundred thousand solids
LONG_PREPARATIONS = {
    "compile": "solid = rayweave.union([cell.translate([k, 0, 0]) for k in range(200_000)]); go(lambda: solid.bounds)",
    "compile a model": "model = rayweave.loads(text); go(lambda: model.bounds)",
    "loads": "go(lambda: rayweave.loads(text))",
    "load": "go(lambda: rayweave.load(path))",
}

LONG_PREPARATION = """
import pathlib, signal, sys, tempfile, time
import rayweave
signal.signal(signal.SIGINT, signal.default_int_handler)
def go(work):
    print("ready", flush=True)
    try:
        while True:
            work()
    except KeyboardInterrupt:
        print("interrupted", flush=True)
cell = rayweave.union([rayweave.sphere(1).translate([0, 2 * k, 0]) for k in range(10)])
solids = "".join(f"[solid.s{k}]\\nsphere = {{ radius = {k + 1} }}\\n[[region]]\\nsolid = 's{k}'\\n" for k in range(30_000))
text = "rayweave = 1\\n" + solids
path = pathlib.Path(tempfile.mkdtemp()) / "many.toml"
path.write_text(text)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent in another way there")
@pytest.mark.parametrize("work", LONG_PREPARATIONS)
def test_ctrl_c_stops_reading_and_compiling(work):
    program = LONG_PREPARATION + LONG_PREPARATIONS[work]
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        time.sleep(0.3)
        sent = time.monotonic()
        process.send_signal(signal.SIGINT)
        try:
            assert process.stdout.readline() == "interrupted\n"
            # 50 ms between checks, and a margin for a busy machine
            assert time.monotonic() - sent < 2
        finally:
            process.kill()


def test_repeated_parts_are_rejected_before_they_are_copied():
    solid = rayweave.sphere(1)
    for k in range(40):
        solid = solid | solid.translate([2.0**k, 0, 0])
    start = time.monotonic()
    with pytest.raises(ValueError, match="describe more than 16777216 leaves"):
        solid.bounds
    assert time.monotonic() - start < 10
    same = rayweave.sphere(1)
    for _ in range(60):
        same = (same | same) & same.translate([0, 0, 0])
    assert (same.bounds == rayweave.sphere(1).bounds).all()


def test_differences_have_places():
    plate = box([20, 10, 2])
    bumped = (plate - box([2, 3, 10]).translate([-6, 1, 0])) | box([1, 1, 4]).translate([7, 2, 2])
    found = rayweave.diff(plate, bumped, cells=64)
    places = found.places
    assert places.part.tolist() == ["model", "model"] and places.is_a.tolist() == [True, False]
    # a hole of 2 x 3 x 2, and a post that is 3 higher than the plate; a grid of 24 rays across each place estimates volumes
    np.testing.assert_allclose(places.volume, [12, 3], rtol=0.12)
    np.testing.assert_allclose(places.centre, [[-6, 1, 0], [7, 2, 2.5]], atol=0.05)
    np.testing.assert_allclose(places.extent, [[2, 3, 2], [1, 1, 3]], atol=0.1)
    assert places[0]["part"] == "model" and list(places.to_pandas())[:3] == ["part", "is_a", "volume"]
    assert len(rayweave.diff(plate, plate, cells=16).places) == 0


PLATE = box([20, 10, 2]) - sphere(3)

LONG_QUERIES = {
    "measure": lambda progress: rayweave.measure(PLATE, precision=1e-4, progress=progress),
    "check": lambda progress: rayweave.check({"a": PLATE, "b": sphere(4)}, cells=400, progress=progress),
    "diff": lambda progress: rayweave.diff(PLATE, box([20, 10, 2.5]), cells=100, progress=progress),
    "distance": lambda progress: PLATE.distance(np.random.default_rng(0).uniform(-9, 9, (30_000, 3)), progress=progress),
}


@pytest.mark.parametrize("name", LONG_QUERIES)
def test_long_queries_tell_their_progress(name):
    seen = []
    LONG_QUERIES[name](lambda done, total: seen.append((done, total)))
    assert seen[-1][0] == seen[-1][1] > 0
    assert all(0 <= done <= total for done, total in seen)
    # only the total of a measurement is an estimate
    assert name == "measure" or (len({total for _, total in seen}) == 1 and seen == sorted(seen))


@pytest.mark.parametrize("name", LONG_QUERIES)
def test_an_exception_of_the_progress_ends_a_query(name):
    def stop(done, total):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        LONG_QUERIES[name](stop)


def test_progress_is_shown_on_standard_error(capsys):
    rayweave.measure(sphere(1), progress=True)
    sphere(1).distance([2, 0, 0], progress=True)
    assert capsys.readouterr().err.count("100 %") == 2
    sphere(1).distance([2, 0, 0], progress=False)
    assert capsys.readouterr().err == ""
