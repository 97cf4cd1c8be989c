"""Solids: operators, transforms, copies, and invalid arguments."""

import copy
import functools
import math
import operator
import pickle

import numpy as np
import pytest

import rayweave
from rayweave import RayweaveError, Solid, box, half_space, place, universe, sphere, union, empty

INF = math.inf


def test_operators_are_boolean_functions_of_inside(rng):
    a, b = sphere(2), box(3).translate([1, 0, 0])
    points = rng.uniform(-4, 4, (3000, 3))
    in_a, in_b = a.contains(points), b.contains(points)
    for solid, expected in [
        (a | b, in_a | in_b),
        (a & b, in_a & in_b),
        (a - b, in_a & ~in_b),
        (a ^ b, in_a ^ in_b),
        (~a, ~in_a),
        (union([a, b]), in_a | in_b),
        (rayweave.intersection(iter((a, b))), in_a & in_b),
        (a - b | b, in_a | in_b),
        (~a & b, ~in_a & in_b),
    ]:
        np.testing.assert_array_equal(solid.contains(points), expected)


def test_empty_and_universe():
    point = [[1.0, 2.0, 3.0]]
    for nothing in (empty(), union([]), rayweave.intersection([empty(), sphere(1)]), ~universe()):
        assert not nothing.contains(point)
        assert nothing.hits(point, [0, 0, 1]).tolist() == [[INF], [INF]]
    for full in (universe(), rayweave.intersection([]), ~empty()):
        assert full.contains(point)
        assert full.hits(point, [0, 0, 1]).tolist() == [[-INF], [INF]]
    assert empty().bounds.tolist() == [[INF] * 3, [-INF] * 3]
    assert universe().bounds.tolist() == [[-INF] * 3, [INF] * 3]
    assert place(sphere(1), np.zeros((0, 3))).bounds.tolist() == empty().bounds.tolist()
    assert not place(sphere(1), []).contains([0, 0, 0])


def rotation(axis, degrees):
    """Rodrigues' formula."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.radians(degrees)
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k


@pytest.mark.parametrize(
    ("method", "arguments", "linear", "shift"),
    [
        ("translate", ([1, -2, 3],), np.eye(3), [1, -2, 3]),
        ("rotate", ([1, 2, -2], 50), rotation([1, 2, -2], 50), [0, 0, 0]),
        ("rotate_x", (70,), rotation([1, 0, 0], 70), [0, 0, 0]),
        ("rotate_y", (70,), rotation([0, 1, 0], 70), [0, 0, 0]),
        ("rotate_z", (-400,), rotation([0, 0, 1], -400), [0, 0, 0]),
        ("scale", (1.5,), 1.5 * np.eye(3), [0, 0, 0]),
        ("scale", ([1, 2, -0.5],), np.diag([1, 2, -0.5]), [0, 0, 0]),
        ("mirror", ([0, 3, 4],), np.eye(3) - 2 * np.outer([0, 0.6, 0.8], [0, 0.6, 0.8]), [0, 0, 0]),
    ],
)
def test_transforms_move_points(rng, method, arguments, linear, shift):
    lumpy = box([1, 2, 3]).translate([0.5, 0.2, 0.1]) | sphere(0.8).translate([1, 1, 1])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, shift
    points = rng.uniform(-2, 3, (2000, 3))
    images = points @ np.asarray(linear).T + shift
    expected = lumpy.contains(points)
    np.testing.assert_array_equal(getattr(lumpy, method)(*arguments).contains(images), expected)
    np.testing.assert_array_equal(lumpy.transform(matrix).contains(images), expected)
    assert 0.02 < expected.mean() < 0.9


def test_the_first_transform_acts_first():
    # the bar along z is laid along -y, then moved
    bar = box([1, 1, 10]).rotate_x(90).translate([0, 0, 7])
    assert bar.bounds.tolist() == [[-0.5, -5, 6.5], [0.5, 5, 7.5]]


def test_place():
    tiles = place(box(1), [[2 * i, 0, 0] for i in range(5)])
    assert tiles.hits([-10, 0, 0], [1, 0, 0])[:, 0].tolist() == [9.5, 10.5, 11.5, 12.5, 13.5, 14.5, 15.5, 16.5, 17.5, 18.5]
    turned = np.stack([np.eye(4)] * 2)
    turned[1, :3, :3] = 2 * np.eye(3)
    turned[1, :3, 3] = [5, 0, 0]
    assert place(box(1), turned).hits([-10, 0, 0], [1, 0, 0])[:, 0].tolist() == [9.5, 10.5, 14, 16]
    crossings = tiles.crossings([-10, 0, 0], [1, 0, 0])
    assert crossings.placement.tolist() == [1, 1, 2, 2, 3, 3, 4, 4, 5, 5]


def test_occurrence_paths_name_the_copies():
    brick = (box(2) - sphere(0.5).named("hole")).named("brick")
    tower = place(brick, [[0, 0, 4 * k] for k in range(3)]).named("tower")
    towers = place(tower, [[20 * k, 0, 0] for k in range(2)])
    found = towers.crossings([[20, 0, -9], [0, 90, 0]], [0, 0, 1])
    paths = [f"tower[1]/brick[{k}]/{leaf}" for k in range(3) for leaf in ("box", "hole", "hole", "box")]
    assert found.occurrence.dtype == np.int64
    assert towers.occurrence_paths(found.occurrence) == paths
    assert towers.occurrence_paths(list(found.occurrence), placed=True) == [p.rpartition("/")[0] for p in paths]
    nearest = towers.nearest([[20, 0, -9], [0, 90, 0]], [0, 0, 1])
    assert nearest.occurrence[1] == -1
    assert towers.occurrence_paths(nearest.occurrence) == [paths[0], ""]
    np.testing.assert_array_equal(found.occurrence, found.placement.astype(np.int64) << 32 | found.leaf)
    assert sphere(1).named("ball").occurrence_paths([0]) == ["ball"]


def test_occurrences_are_checked():
    with pytest.raises(ValueError, match=r"occurrences\[1\] is 7: there is no such occurrence"):
        sphere(1).occurrence_paths([0, 7])
    with pytest.raises(ValueError, match=r"occurrences\[0\] is -2"):
        sphere(1).occurrence_paths([-2])
    with pytest.raises(TypeError, match="occurrences is 0.5"):
        sphere(1).occurrence_paths(0.5)


def test_solids_compare_by_how_they_are_built():
    a = (sphere(1) | box([1, 2, 3]).translate([0.0, 1, 2])).named("a")
    b = (sphere(1) | box([1, 2, 3]).translate([-0.0, 1, 2])).named("a")
    assert a == b and hash(a) == hash(b) and a is not b
    assert len({a, b, sphere(1)}) == 2
    for other in (a.named("b"), a | a, sphere(1), ~a, a.translate([1, 0, 0]), 3, None, "a"):
        assert a != other
    assert sphere(1) | box(1) != box(1) | sphere(1)
    # sharing makes no difference
    ball = sphere(1)
    assert ball | ball == sphere(1) | sphere(1) and hash(ball | ball) == hash(sphere(1) | sphere(1))


def everything():
    """A solid with every kind of node in it."""
    shapes = [sphere(1), box([1, 2, 3]), rayweave.prism(5, 1, 2), rayweave.quadric(np.diag([1, 1, -1, -1.0]))]
    shapes += [rayweave.convex([[1, 0, 0, 1], [0, 1, 0, 2]]), rayweave.cylinder(1), rayweave.torus(2, 1)]
    joined = (union(shapes) & rayweave.intersection(shapes)) ^ (shapes[0] - shapes[1]) | ~shapes[2]
    placed = place(joined.named("pièce"), np.arange(6).reshape(2, 3))
    return (placed | empty() | universe()).rotate([1, 2, 3], 20).scale([1, 2, 0.5])


def test_copies():
    solid = everything()
    for twin in (copy.copy(solid), copy.deepcopy(solid)):
        assert twin is solid
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        twin = pickle.loads(pickle.dumps(solid, protocol))
        assert twin == solid and hash(twin) == hash(solid) and twin is not solid
    assert copy.deepcopy({"part": solid})["part"] is solid


def test_pickles_keep_sharing_small():
    solid = sphere(1)
    for _ in range(60):
        solid = solid | solid.translate([1, 0, 0])
    data = pickle.dumps(solid)
    assert len(data) < 20_000
    twin = pickle.loads(data)
    assert twin == solid and hash(twin) == hash(solid)
    assert len(repr(solid)) < 150


def test_damaged_pickles_are_refused():
    decode = rayweave._core.solid_from_bytes
    data = everything().__reduce__()[1][0]
    assert decode(data) == everything()
    for cut in range(len(data)):
        with pytest.raises(RayweaveError):
            decode(data[:cut])
    for k in range(17, len(data)):
        for value in (0, 1, 0x7F, 0xFF):
            try:
                assert isinstance(decode(data[:k] + bytes([value]) + data[k + 1 :]), Solid)
            except RayweaveError:
                pass
    with pytest.raises(RayweaveError, match="not a solid"):
        decode(b"")


def test_deep_trees():
    """A tree of 100,000 levels is built, compared, hashed, pickled, queried and dropped in linear time."""
    balls = [sphere(1).translate([2.5 * k, 0, 0]) for k in range(100_000)]
    deep = functools.reduce(operator.or_, balls)
    twin = pickle.loads(pickle.dumps(deep))
    assert twin == deep and hash(twin) == hash(deep)
    assert copy.deepcopy(deep) is deep
    assert len(repr(deep)) < 150
    hits = deep.hits([-5, 0, 0], [1, 0, 0])
    assert hits.shape == (200_000, 1)
    assert hits[:4, 0].tolist() == [4, 6, 6.5, 8.5]
    shared = functools.reduce(operator.sub, [sphere(1)] * 100_000)
    assert not shared.contains([0, 0, 0])
    chain = functools.reduce(lambda solid, _: ~solid.rotate_x(90), range(100_000), sphere(1))
    assert pickle.loads(pickle.dumps(chain)) == chain


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda s: s.translate([1, 2]), "v has 2 numbers"),
        (lambda s: s.translate([1, 2, math.nan]), r"v\[2\] is NaN"),
        (lambda s: s.translate([[1, 2, 3]]), r"v has shape \(1, 3\)"),
        (lambda s: s.rotate([0, 0, 0], 10), "axis has length 0"),
        (lambda s: s.rotate([0, 0, 1], INF), "degrees is inf"),
        (lambda s: s.rotate_y(math.nan), "degrees is NaN"),
        (lambda s: s.scale(0), "s: the transform is singular"),
        (lambda s: s.scale([1, 0, 1]), "s: the transform is singular"),
        (lambda s: s.scale(INF), "s is inf"),
        (lambda s: s.mirror([0, 0, 0]), "normal has length 0"),
        (lambda s: s.transform(np.zeros((4, 4))), r"matrix: the last row is \[0"),
        (lambda s: s.transform(np.eye(3)), r"matrix has shape \(3, 3\)"),
        (lambda s: s.transform(np.diag([1, 1, 0, 1])), "matrix: the transform is singular"),
        (lambda s: s.transform(np.diag([1, 1, math.nan, 1])), "matrix: the transform has an entry that is NaN"),
        (lambda s: place(s, np.zeros((2, 4))), r"transforms has shape \(2, 4\)"),
        (lambda s: place(s, [[0, 0, 0], [0, math.inf, 0]]), r"transforms\[1\]"),
        (lambda s: place(s, [np.eye(4), np.diag([1, 1, 0, 1])]), r"transforms\[1\]: the transform is singular"),
        (lambda s: s.named(""), "name is empty"),
    ],
)
def test_bad_values_are_refused_at_once(make, message):
    with pytest.raises(RayweaveError, match=message):
        make(sphere(1))


@pytest.mark.parametrize(
    "make",
    [
        lambda s: s | 1,
        lambda s: 1 - s,
        lambda s: s & None,
        lambda s: s.translate("up"),
        lambda s: s.rotate_x("90"),
        lambda s: s.scale("1"),
        lambda s: s.named(3),
        lambda s: union([s, 3]),
        lambda s: union(3),
        lambda s: place(3, [[0, 0, 0]]),
        lambda s: Solid(),
        lambda s: s.hits([0, 0, 0]),
    ],
)
def test_wrong_types_are_type_errors(make):
    with pytest.raises(TypeError):
        make(sphere(1))


def test_operands_are_named():
    with pytest.raises(TypeError, match=r"solids\[1\] is 3: it must be a Solid\."):
        union([sphere(1), 3])


def test_solids_do_not_change():
    solid = sphere(1)
    with pytest.raises(AttributeError):
        solid.radius = 2
    moved = solid.translate([5, 0, 0])
    assert solid.contains([0, 0, 0]) and not moved.contains([0, 0, 0])


def test_repr_reads_well():
    assert repr(sphere(1.5)) == "sphere(radius=1.5)"
    assert repr((half_space([0, 0, 1], 2) & ~sphere(1)).named("part")).startswith("(half_space(normal=[0, 0, 1], offset=2) & ~")


def test_rays_from_too_far_are_rejected_with_their_number():
    ball = sphere(1)
    origins = np.zeros((5000, 3))
    origins[:, 0] = -5
    origins[4321, 0] = -3e14
    message = "ray 4321: the ray is too far from the model: at its closest point, 3e14 from its origin"
    for query in (ball.hits, ball.nearest, ball.crossings):
        for evaluator in ("packets", "weave", "reference"):
            with pytest.raises(ValueError, match=message):
                query(origins, [1, 0, 0], evaluator=evaluator)
    # a quarter of the size is reached at 2^45
    assert ball.hits([-(2.0**45), 0, 0], [1, 0, 0]).shape == (2, 1)
    with pytest.raises(ValueError, match="ray 0: the ray is too far"):
        ball.hits([-(2.0**45 + 1), 0, 0], [1, 0, 0])
    # a clear miss, and a solid that does not vanish
    assert np.isinf(ball.hits([0, 1e15, 0], [1, 0, 0])).all()
    assert half_space([1, 0, 0], 0).hits([-1e20, 0, 0], [1, 0, 0])[-1] == 1e20


@pytest.mark.parametrize("solids", [(sphere(1), box(1)), (rayweave.space.ball(1, 2), rayweave.space.ball(2, 2))])
def test_words_are_no_operators(solids):
    a, b = solids
    for combine in (lambda: a and b, lambda: a or b, lambda: not a, lambda: bool(a)):
        with pytest.raises(TypeError, match=r"no truth value.*a & b .*a \| b .*a - b .*~a"):
            combine()
    for add in (lambda: a + b, lambda: a + 1):
        with pytest.raises(TypeError, match=r"no sum.*Write a \| b"):
            add()
    # comparisons and searches need no truth value
    assert a != b and a == a and a in [b, a]
