"""Answers in arrays: the same bits for any division into batches, and arrays of the caller."""

import copy
import math
import pickle
import threading

import numpy as np
import pytest

import rayweave
from rayweave import Crossings, RayweaveError, box, cylinder, half_space, sphere

INF = math.inf
FIELDS = ("ray", "t", "point", "normal", "enters", "surface", "leaf", "placement", "occurrence", "offsets", "start_inside")
REGIONS = ("region_before", "region_after", "medium_before", "medium_after")


def die():
    bore = cylinder(0.5)
    return (box(2) & sphere(1.35)) - bore - bore.rotate_x(90) - bore.rotate_y(90)


def lumps(count):
    rng = np.random.default_rng(count)
    return rayweave.union([sphere(0.4).translate(rng.uniform(-1.5, 1.5, 3)) for _ in range(count)])


MODEL = """
rayweave = 1
[solid]
outer = { sphere = { radius = 2 } }
inner = { sphere = { radius = 1.2 } }
hole = { cylinder = { radius = 0.4 } }
[medium]
glass = { index = 1.5 }
water = { index = 1.33 }
[[region]]
solid = "outer"
medium = "glass"
[[region]]
solid = "inner"
medium = "water"
[[region]]
solid = "hole"
medium = "world"
"""

SUBJECTS = {
    "die": die,
    "lumps": lambda: lumps(40),
    "placed": lambda: rayweave.place(die().scale(0.3), np.random.default_rng(3).uniform(-1.5, 1.5, (20, 3))),
    "unbounded": lambda: ~die() | half_space([1, 2, 3], -1),
    "model": lambda: rayweave.loads(MODEL),
}


def rays(rng, count):
    origins = rng.normal(size=(count, 3))
    origins *= 5 / np.linalg.norm(origins, axis=1)[:, None]
    return origins, rng.uniform(-1.5, 1.5, (count, 3)) - origins


def assert_same(expected, found):
    """Bit for bit, NaN included."""
    assert expected.shape == found.shape and expected.dtype == found.dtype
    assert expected.tobytes() == found.tobytes()


def assert_same_answers(expected, found):
    names = FIELDS + REGIONS if hasattr(expected, "region_before") else FIELDS
    for name in names:
        assert_same(getattr(expected, name), getattr(found, name))


def padded(hits, rows, value):
    return np.concatenate((hits, np.full((rows - hits.shape[0], hits.shape[1]), value, hits.dtype)))


@pytest.mark.parametrize("name", SUBJECTS)
def test_the_same_bits_for_any_threads(rng, name):
    subject = SUBJECTS[name]()
    origins, directions = rays(rng, 20_000)
    hits, surfaces = subject.hits(origins, directions, return_surfaces=True, threads=1)
    nearest = subject.nearest(origins, directions, threads=1)
    crossings = subject.crossings(origins, directions, threads=1)
    inside = subject.contains(origins / 4, threads=1)
    assert hits.shape[0] > 2 and inside.any() and not inside.all()
    for threads in (2, 3, 16):
        again = subject.hits(origins, directions, return_surfaces=True, threads=threads)
        assert_same(hits, again[0])
        assert_same(surfaces, again[1])
        assert_same(hits, subject.hits(origins, directions, threads=threads))
        assert_same_answers(nearest, subject.nearest(origins, directions, threads=threads))
        assert_same_answers(crossings, subject.crossings(origins, directions, threads=threads))
        assert_same(inside, subject.contains(origins / 4, threads=threads))


@pytest.mark.parametrize("name", SUBJECTS)
@pytest.mark.parametrize("size", [1, 7, 64, 1000, 10_000])
def test_the_same_bits_for_any_batch(rng, name, size):
    subject = SUBJECTS[name]()
    origins, directions = rays(rng, 10_000)
    hits, surfaces = subject.hits(origins, directions, return_surfaces=True)
    nearest, crossings = subject.nearest(origins, directions), subject.crossings(origins, directions)
    inside = subject.contains(origins / 4)
    # one ray at a time, for some of the rays
    for start in range(0, min(10_000, 200 * size), size):
        part = slice(start, start + size)
        some, with_faces = subject.hits(origins[part], directions[part], return_surfaces=True)
        assert some.shape[0] % 2 == 0 and (some.shape[0] == 2 or np.isfinite(some[-2:]).any() or (some[-2:] == -INF).any())
        assert_same(hits[:, part], padded(some, len(hits), INF))
        assert_same(surfaces[:, part], padded(with_faces, len(hits), -1))
        first = subject.nearest(origins[part], directions[part])
        for field in ("t", "point", "normal", "enters", "surface", "leaf", "placement", "start_inside"):
            assert_same(getattr(nearest, field)[part], getattr(first, field))
        rows = slice(crossings.offsets[start], crossings.offsets[min(start + size, 10_000)])
        some = subject.crossings(origins[part], directions[part])
        for field in ("t", "point", "normal", "enters", "surface", "leaf", "placement"):
            assert_same(getattr(crossings, field)[rows], getattr(some, field))
        assert_same(crossings.start_inside[part], some.start_inside)
        assert_same(inside[part], subject.contains(origins[part] / 4))


@pytest.mark.parametrize("name", SUBJECTS)
def test_nearest_is_the_first_of_the_crossings(rng, name):
    subject = SUBJECTS[name]()
    origins, directions = rays(rng, 5000)
    crossings, nearest = subject.crossings(origins, directions, 0.0), subject.nearest(origins, directions)
    assert_same(crossings.start_inside, nearest.start_inside)
    hit = np.diff(crossings.offsets) > 0
    assert hit.any() and not hit.all()
    first = crossings.offsets[:-1][hit]
    names = FIELDS + REGIONS if name == "model" else FIELDS
    for field in names:
        if field not in ("offsets", "start_inside"):
            assert_same(getattr(crossings, field)[first], getattr(nearest, field)[hit])
    missed = {"t": INF, "enters": False, "surface": -1, "leaf": -1, "placement": -1, "occurrence": -1}
    for field, value in missed.items():
        assert (getattr(nearest, field)[~hit] == value).all()
    assert np.isnan(nearest.point[~hit]).all() and np.isnan(nearest.normal[~hit]).all()


def test_few_rays_that_need_many_rows(rng):
    """No estimate can predict the one ray among thousands that passes through everything."""
    pearls = rayweave.place(sphere(0.1), np.linspace(-20, 20, 150)[:, None] * [0, 0, 1])
    for count, at in ((3, 1), (900, 700), (50_000, 49_999), (50_000, 17)):
        origins = np.tile([1.0, 0, -50], (count, 1))
        origins[at] = [0, 0, -50]
        for threads in (1, 3):
            hits, surfaces = pearls.hits(origins, [0, 0, 1], return_surfaces=True, threads=threads)
            assert hits.shape == surfaces.shape == (300, count)
            expected = (np.linspace(30, 70, 150)[:, None] + [-0.1, 0.1]).ravel()
            np.testing.assert_allclose(hits[:, at], expected, atol=1e-12)
            assert (surfaces[:, at] == 0).all()
            others = np.delete(np.arange(count), at)
            assert (hits[:, others] == INF).all() and (surfaces[:, others] == -1).all()
        # then a query that needs few rows
        assert pearls.hits(origins[others[:2]], [0, 0, 1]).shape == (2, 2)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_crossings_of_more_rows_than_estimated(threads):
    """Rays with even numbers miss the ball and odd ones hit it, so that regular samples mislead the estimate."""
    count = 48 * 1024
    odd = np.arange(count) % 2 == 1
    origins = np.where(odd[:, None], [0.0, 0, -5], [9.0, 0, -5])
    found = sphere(2).crossings(origins, [0, 0, 1], threads=threads)
    assert len(found) == count
    np.testing.assert_array_equal(np.diff(found.offsets), 2 * odd)
    np.testing.assert_array_equal(found.ray, np.repeat(np.flatnonzero(odd), 2))
    np.testing.assert_array_equal(found.t.reshape(-1, 2), np.tile([3.0, 7.0], (count // 2, 1)))
    np.testing.assert_array_equal(found.point[:, 2], np.tile([-2.0, 2.0], count // 2))
    np.testing.assert_array_equal(found.normal[:, 2], np.tile([-1.0, 1.0], count // 2))
    np.testing.assert_array_equal(found.enters, np.tile([True, False], count // 2))
    assert not found.start_inside.any() and not found.surface.any()
    assert found.t.flags.owndata and found.t.flags.c_contiguous and found.t.base is None


def test_all_rays_need_more_rows_than_the_sample_rays(rng):
    solid = lumps(60)
    origins, directions = rays(rng, 700)
    away = solid.hits(origins, -directions, 0.0)
    assert away.shape[0] == 2
    hits = solid.hits(origins, directions)
    assert hits.shape[0] > 4
    assert_same(hits, solid.hits(np.tile(origins, (20, 1)), np.tile(directions, (20, 1)))[:, :700])


LAYOUTS = {
    "rows": lambda shape, dtype: np.full(shape, 7, dtype),
    "rows of more": lambda shape, dtype: np.full((shape[0], shape[1] + 5), 7, dtype)[:, 2:-3],
    "every other row": lambda shape, dtype: np.full((2 * shape[0], shape[1]), 7, dtype)[::2],
    "rows upwards": lambda shape, dtype: np.full(shape, 7, dtype)[::-1],
    "columns": lambda shape, dtype: np.full(shape, 7, dtype, order="F"),
    "columns backwards": lambda shape, dtype: np.full((shape[0], 3 * shape[1]), 7, dtype)[:, ::-3],
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("count", [1, 2, 3000])
@pytest.mark.parametrize("extra", [0, 4])
def test_given_arrays_of_any_layout(rng, layout, count, extra):
    origins, directions = rays(rng, count)
    expected, faces = die().hits(origins, directions, return_surfaces=True)
    shape = (len(expected) + extra, count)
    out = LAYOUTS[layout](shape, np.float64)
    before = out.base.copy() if out.base is not None else None
    assert die().hits(origins, directions, out=out) is out
    assert_same(padded(expected, shape[0], INF), np.ascontiguousarray(out))
    if before is not None:
        # nothing outside of it is modified
        left = out.base.copy()
        out[...] = 7
        assert (left != before).sum() <= out.size and (out.base == before).all()
    # with surfaces in a new array
    hits, surfaces = die().hits(origins, directions, out=out, return_surfaces=True)
    assert hits is out
    assert_same(padded(faces, shape[0], -1), surfaces)
    # and in a given one
    out, into = LAYOUTS[layout](shape, np.float64), LAYOUTS[layout](shape, np.int32)
    hits, surfaces = die().hits(origins, directions, out=(out, into), return_surfaces=True, threads=2)
    assert hits is out and surfaces is into
    assert_same(padded(expected, shape[0], INF), np.ascontiguousarray(out))
    assert_same(padded(faces, shape[0], -1), np.ascontiguousarray(into))


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("count", [100, 5000])
def test_given_arrays_that_are_too_small(rng, layout, count):
    origins, directions = rays(rng, count)
    rows = len(die().hits(origins, directions))
    assert rows > 2
    need = rf"out has shape \(2, {count}\): it must have {count} columns and an even number of rows, at least {rows}, since a ray has \d+ hits\."
    with pytest.raises(RayweaveError, match=need):
        die().hits(origins, directions, out=LAYOUTS[layout]((2, count), np.float64))
    pair = LAYOUTS[layout]((2, count), np.float64), LAYOUTS[layout]((2, count), np.int32)
    with pytest.raises(RayweaveError, match=rf"out\[0\] has shape .* at least {rows},"):
        die().hits(origins, directions, out=pair, return_surfaces=True)


def test_given_arrays_that_cannot_be_used(rng):
    origins, directions = rays(rng, 4)
    times, faces = np.zeros((10, 4)), np.zeros((10, 4), np.int32)

    def ask(out, return_surfaces=True):
        return die().hits(origins, directions, out=out, return_surfaces=return_surfaces)

    with pytest.raises(TypeError, match="out is a tuple"):
        ask((times, faces), return_surfaces=False)
    with pytest.raises(TypeError, match="out is a tuple"):
        ask((times,))
    with pytest.raises(TypeError, match=r"out\[0\] must be a two-dimensional float64 array"):
        ask((faces, times))
    with pytest.raises(TypeError, match=r"out\[1\] must be a two-dimensional int32 array"):
        ask((times, times))
    with pytest.raises(RayweaveError, match=r"out has shapes \(10, 4\) and \(8, 4\): both must be the same\."):
        ask((times, faces[:8]))
    with pytest.raises(RayweaveError, match=r"out\[1\]: .*not writeable"):
        ask((times, np.broadcast_to(np.int32(0), (10, 4))))
    shared = np.lib.stride_tricks.as_strided(np.zeros(4), (10, 4), (0, 8))
    with pytest.raises(RayweaveError, match="out has elements that share memory"):
        ask(shared)
    with pytest.raises(RayweaveError, match="out has elements that share memory"):
        ask(np.lib.stride_tricks.as_strided(np.zeros(20), (10, 4), (8, 8)))
    # the rays themselves
    both = np.zeros((12, 3))
    both[:, 2] = 1
    with pytest.raises(RayweaveError, match="out: .*borrowed"):
        sphere(1).hits(both[:4].reshape(4, 3), [0, 0, 1], out=both.reshape(-1)[:8].reshape(2, 4))


@pytest.mark.parametrize("layout", [np.ascontiguousarray, np.asfortranarray, lambda x: np.float32(x)])
@pytest.mark.parametrize("count", [5, 30_000])
@pytest.mark.parametrize("threads", [1, 3])
def test_the_first_invalid_ray_is_named(rng, layout, count, threads):
    for array, value, message in (
        ("origins", [0, math.nan, 0], r"origins\[{i}\] is \(0.0, NaN, 0.0\): "),
        ("origins", [-INF, 0, 0], r"origins\[{i}\] is \(-inf, 0.0, 0.0\): "),
        ("directions", [0, 0, INF], r"directions\[{i}\] is \(0.0, 0.0, inf\): "),
        ("directions", [0, -0.0, 0], r"directions\[{i}\] has length 0"),
    ):
        given = dict(zip(("origins", "directions"), rays(rng, count), strict=True))
        bad = count - 3
        given[array][[bad, count - 1]] = value
        given = {name: layout(vectors) for name, vectors in given.items()}
        for question in (die().hits, die().crossings, die().nearest):
            with pytest.raises(RayweaveError, match=message.format(i=bad)):
                question(**given, threads=threads)
        if array == "origins":
            with pytest.raises(RayweaveError, match=message.replace("origins", "points").format(i=bad)):
                die().contains(given["origins"], threads=threads)


def test_invalid_vectors_are_rejected_even_without_rays():
    none = np.zeros((0, 3))
    for question in (die().hits, die().crossings, die().nearest):
        with pytest.raises(RayweaveError, match="origins is .*NaN"):
            question([math.nan, 0, 0], none)
        with pytest.raises(RayweaveError, match="directions has length 0"):
            question(none, [0, 0, 0])
    out = np.zeros((2, 0))
    assert die().hits(none, [0, 0, 1], out=out) is out


def test_broadcast_rays_equal_explicit_rays(rng):
    origins, directions = rays(rng, 3000)
    for a, b in ((origins, directions[0]), (origins[0], directions)):
        given = np.broadcast_arrays(a, b)
        plain = [x.copy() for x in given]
        for question in (die().nearest, die().crossings):
            assert_same_answers(question(*plain), question(a, b))
            assert_same_answers(question(*plain), question(*given, threads=3))
        assert_same(die().hits(*plain), die().hits(a, b))


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize(
    "layout",
    [
        np.float32,
        np.int16,
        lambda x: np.asfortranarray(x, dtype=float),
        lambda x: np.repeat(x.astype(">f8"), 2, axis=0)[::2],
        lambda x: x[:, ::-1].copy()[:, ::-1],
    ],
)
def test_many_rays_of_any_layout(rng, layout, threads):
    """Whole numbers are the same in every type."""
    origins = rng.integers(-9, 10, (20_000, 3)).astype(float)
    directions = rng.integers(-3, 4, (20_000, 3)) + [0.0, 0, 4]
    o, d = layout(origins), layout(directions)
    for solid in (sphere(3), die()):
        expected = solid.hits(origins, directions, return_surfaces=True, threads=1)
        for hits, again in zip(expected, solid.hits(o, d, return_surfaces=True, threads=threads), strict=True):
            assert_same(hits, again)
        for question in (solid.nearest, solid.crossings):
            assert_same_answers(question(origins, directions, threads=1), question(o, d, threads=threads))
        assert_same(solid.contains(origins, threads=1), solid.contains(o, threads=threads))
    # and the closed form: t of |o + t d| = 3
    a, b, c = ((directions**2).sum(1), (origins * directions).sum(1), (origins**2).sum(1) - 9)
    with np.errstate(invalid="ignore"):
        first = (-b - np.sqrt(b * b - a * c)) / a
    t = sphere(3).nearest(o, d, -INF, threads=threads).t
    clear = np.abs(b * b - a * c) > 0.5
    np.testing.assert_array_equal(np.isfinite(t)[clear], (b * b > a * c)[clear])
    np.testing.assert_allclose(t[clear & (b * b > a * c)], first[clear & (b * b > a * c)], rtol=0, atol=1e-12)


def test_leaves_and_placements_that_follow_from_faces(rng):
    """They are computed on request, and compared with the positions of the crossings, for two balls side by side and
    for one that is placed twice."""
    origins, directions = rays(rng, 3000)
    apart = sphere(0.5).translate([1, 0, 0]).named("right") | sphere(0.5).translate([-1, 0, 0]).named("left")
    twice = rayweave.place(sphere(0.5), [[1, 0, 0], [-1, 0, 0]])
    for name in ("nearest", "crossings"):
        one, two = (getattr(solid, name)(origins, directions) for solid in (apart, twice))
        hit = np.isfinite(one.t)
        assert hit.any() and one.leaf.dtype == one.placement.dtype == two.placement.dtype == np.int32
        is_left = one.point[:, 0] < 0
        np.testing.assert_array_equal(one.leaf, np.where(hit, is_left, -1))
        np.testing.assert_array_equal(one.placement, np.where(hit, 0, -1))
        assert two.leaf[hit][0] >= 0
        np.testing.assert_array_equal(two.leaf, np.where(hit, two.leaf[hit][0], -1))
        placed = two.placement[hit]
        assert len(np.unique(placed)) == 2
        np.testing.assert_array_equal(placed == placed[is_left[hit]][0], is_left[hit])
        assert one.leaf is one.leaf and one.placement is one.placement


def test_columns_computed_on_request(rng):
    origins, directions = rays(rng, 2000)
    for question in (die().nearest, die().crossings):
        answer = question(origins, directions)
        assert type(answer) is Crossings
        again = pickle.loads(pickle.dumps(question(origins, directions)))
        assert_same_answers(answer, again)
        assert_same_answers(answer, copy.deepcopy(question(origins, directions)))
        assert answer.ray is answer.ray and answer.offsets is answer.offsets
        assert answer.ray.dtype == answer.offsets.dtype == np.int64
        np.testing.assert_array_equal(np.bincount(answer.ray, minlength=2000), np.diff(answer.offsets))
        with pytest.raises(AttributeError, match="'Crossings' object has no attribute 'rays'"):
            answer.rays  # noqa: B018
        with pytest.raises(AttributeError):
            answer.t = answer.t
    with pytest.raises(AttributeError, match="'ray'"):
        Crossings.__new__(Crossings).ray  # noqa: B018


def test_one_solid_queried_from_many_threads_at_once(rng):
    solid, fresh = lumps(40), lumps(40)
    origins, directions = rays(rng, 3000)
    expected, results = solid.hits(origins, directions), []

    def work():
        for size in (1, 10, 3000):
            results.append((size, fresh.hits(origins[:size], directions[:size], threads=2)))

    workers = [threading.Thread(target=work) for _ in range(6)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(results) == 18
    for size, hits in results:
        assert_same(expected[:, :size], padded(hits, len(expected), INF))
