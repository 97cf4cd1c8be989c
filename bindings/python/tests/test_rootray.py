"""The root-ray algebra under the names of the module rootray, compared point by point with the boolean functions."""

import copy
import math
import operator
import pickle

import numpy as np
import pytest

from rayweave import RayweaveError, RootRay, rootray

INF = math.inf
FUNCTIONS = [
    (rootray.union, operator.or_, lambda a, b: a or b),
    (rootray.intersection, operator.and_, lambda a, b: a and b),
    (rootray.difference, operator.sub, lambda a, b: a and not b),
    (rootray.symmetric_difference, operator.xor, lambda a, b: a != b),
]


def inside(pair, t):
    """Whether a pair is inside at a time that is not a root."""
    start, roots = pair
    return (start == -1) != (sum(root < t for root in roots) % 2 == 1)


def random_pair(rng):
    """A pair whose times are small whole numbers, so that ties are common."""
    return int(rng.choice([-1, 1])), sorted(map(float, rng.choice(12, rng.integers(0, 8), replace=False)))


def test_functions_are_the_boolean_functions(rng):
    samples = np.arange(-1, 13) + 0.5
    for _ in range(300):
        f, g = random_pair(rng), random_pair(rng)
        for function, _, truth in FUNCTIONS:
            h = function(f, g)
            assert type(h) is tuple and type(h[1]) is list
            assert all(inside(h, t) == truth(inside(f, t), inside(g, t)) for t in samples)
            assert h[1] == sorted(set(h[1]))
        assert all(inside(rootray.complement(f), t) != inside(f, t) for t in samples)


def test_operators_are_the_functions_without_the_weld(rng):
    for _ in range(100):
        f, g = random_pair(rng), random_pair(rng)
        for function, symbol, _ in FUNCTIONS:
            assert symbol(RootRay(*f), RootRay(*g)) == function(f, g)
        assert ~RootRay(*f) == rootray.complement(f)
        assert ~~RootRay(*f) == RootRay(*f)
    thin = RootRay(1, [1.0, 2.0]) | RootRay(1, [2.0 + 1e-15, 3.0])
    assert len(thin.roots) == 4
    assert thin.weld() == (1, [1.0, 3.0])
    assert rootray.union((1, [1.0, 2.0]), (1, [2.0 + 1e-15, 3.0])) == (1, [1.0, 3.0])
    assert thin.weld(0.0) == thin
    assert thin.weld(1.5) == (1, [])
    for length in [-1.0, INF, math.nan]:
        with pytest.raises(RayweaveError, match="min_sep is"):
            thin.weld(length)


def test_constants():
    assert rootray.vacuum() == (1, []) and (-1, []) == rootray.plenum()
    f = (-1, [2.0])
    assert rootray.union(f, rootray.vacuum()) == f
    assert rootray.intersection(rootray.plenum(), f) == f
    assert rootray.union(f, rootray.plenum()) == rootray.plenum()


def test_the_result_has_the_type_of_the_operands():
    pair, ray = (1, [1.0]), RootRay("outside", [1.0])
    assert type(rootray.union(pair, pair)) is tuple
    assert type(rootray.union(pair, ray)) is RootRay
    assert type(rootray.difference(ray, pair)) is RootRay
    assert type(rootray.complement(pair)) is tuple
    assert type(rootray.clip_time(ray, 0, 2)) is RootRay
    assert rootray.complement((+1, (1, 2))) == (-1, [1.0, 2.0])
    assert rootray.complement((+1, np.array([1, 2]))) == (-1, [1.0, 2.0])


def test_a_root_ray_is_its_pair():
    ray = RootRay("inside", [1, 2.5])
    start, roots = ray
    assert (start, roots) == (-1, [1.0, 2.5]) and type(roots[0]) is float
    assert (ray[0], ray[1], ray[-1], len(ray)) == (-1, [1.0, 2.5], [1.0, 2.5], 2)
    with pytest.raises(IndexError):
        ray[2]
    assert ray == RootRay(-1, np.array([1, 2.5], np.float32)) != RootRay(1, [1, 2.5])
    assert ray != (-1, [1.0]) and ray != "text" and ray is not None
    assert hash(ray) == hash(RootRay(-1, [1, 2.5]))
    assert repr(ray) == "RootRay(-1, [1.0, 2.5])"
    assert repr(RootRay(1, range(1000))) == "RootRay(+1, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, ... 994 more])"
    assert ray.starts_inside and ray.ends_inside
    assert RootRay(1, [0.0]).ends_inside and not RootRay(1, [0.0]).starts_inside
    assert ray.spans() == [(-INF, 1.0), (2.5, INF)]
    for twin in (copy.copy(ray), copy.deepcopy(ray), pickle.loads(pickle.dumps(ray))):
        assert twin == ray
    with pytest.raises(AttributeError):
        ray.start = 1


def test_sides_and_windows():
    ray = RootRay(1, [1, 4, 5, 10])
    assert [ray.is_inside(t) for t in (-INF, 0.9, 1, 4, 5, 10, INF)] == [False, False, True, False, True, False, False]
    assert ray.clip(1, 10) == (-1, [4.0, 5.0])
    assert ray.clip(4.5) == (1, [5.0, 10.0])
    assert ray.clip(t_max=4.5) == (1, [1.0, 4.0])
    assert rootray.clip_time((1, [1, 4, 5, 10]), 2, 7) == (-1, [4.0, 5.0])
    for window in [(2, 1), (1, 1), (math.nan, 1), (0, math.nan)]:
        with pytest.raises(RayweaveError, match="window"):
            ray.clip(*window)
    with pytest.raises(RayweaveError, match="NaN"):
        ray.is_inside(math.nan)


def test_hit_array_columns():
    assert RootRay.from_hits([-INF, 1, 3, 3, 7, INF]) == (-1, [1.0, 7.0])
    assert RootRay(-1, [1, 7]).to_hits().tolist() == [-INF, 1, 7, INF]
    assert RootRay(1, []).to_hits().tolist() == [INF, INF]
    with pytest.raises(RayweaveError, match="column has 3 rows"):
        RootRay.from_hits([1, 2, 3])


def test_min_sep():
    times = np.concatenate((np.geomspace(1e-300, 1e300, 50), [0, 5e-324]))
    for t in times:
        assert rootray.min_sep(t, 2.0) == rootray.min_sep(2.0, t) == rootray.min_sep(-t, 2.0) > 0
        assert t == 0 or rootray.min_sep(t, t) < max(1e-13 * t, 1e-321)
    with pytest.raises(RayweaveError, match="t2 is NaN"):
        rootray.min_sep(0.0, math.nan)


def test_surface_count():
    rays = [RootRay(1, [1, 4, 5, 10]), (1, [0, 2, 3, 5]), rootray.plenum()]
    start, steps = rootray.surface_count(rays)
    assert start == 1
    assert steps == [(0, 2), (1, 3), (2, 2), (3, 3), (4, 2), (5, 2), (10, 1)]


def test_validate_reports_everything():
    assert rootray.validate((1, [1, 2])) == []
    assert rootray.validate(RootRay(1, [1, 2])) == []
    problems = rootray.validate((2, [1, math.nan, 0.5, 0.5 + 1e-16, INF, 3, 3 + 1e-15]))
    words = ["sign 2", "root 1 is NaN", "root 2 is 0.5, not greater than 1", "root 3", "root 4 is inf", "root 5", "root 6"]
    assert len(problems) == len(words) and all(word in text for word, text in zip(words, problems, strict=True))
    assert "closer than" in rootray.validate(RootRay(1, [3, 3 + 1e-15]))[0]


@pytest.mark.parametrize(
    ("start", "roots", "error", "message"),
    [
        (1, [1, math.nan], RayweaveError, "root 1 is NaN"),
        (1, [1, INF], RayweaveError, "root 1 is inf"),
        (1, [1, 2, 2], RayweaveError, "root 2 is 2, not greater than 2"),
        (0, [], RayweaveError, "sign is 0"),
        ("outer", [], RayweaveError, "start is 'outer'"),
        (True, [], TypeError, "start is True"),
        (1.5, [], TypeError, "start is 1.5"),
        (1, [[1]], RayweaveError, r"roots has shape \(1, 1\)"),
        (1, ["a"], TypeError, "roots has dtype"),
        (1, None, TypeError, "roots is None"),
    ],
)
def test_bad_root_rays(start, roots, error, message):
    with pytest.raises(error, match=message):
        RootRay(start, roots)


def test_bad_operands():
    with pytest.raises(TypeError, match="f2 is 3: "):
        rootray.union((1, []), 3)
    with pytest.raises(TypeError):
        RootRay(1, []) | (1, [])
    with pytest.raises(RayweaveError, match="root 1"):
        rootray.union((1, [2, 1]), (1, []))
