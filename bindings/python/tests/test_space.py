"""Solids in R^d: closed forms, and invalid arguments."""

import copy
import math
import operator
import pickle

import numpy as np
import pytest

import rayweave as rw
import rayweave.space as rs
from rayweave import RayweaveError

SHAPES = [
    rs.half_space(1, 2, offset=0.5),
    rs.half_space_below([1, 2, 2], 3),
    rs.slab(2, -1, 1, 4),
    rs.box([0, 0, 0], [1, 2, 3]),
    rs.quadric(3, 2, -1),
    rs.quadric(2, 2, -1, 4),
    rs.ball(2, 4),
    rs.cylinder(2, 1, 3),
    rs.cone(2, 1, 3),
    rs.prism([[0, 0], [4, 0], [1, 1], [0, 4]], 2),
    rs.empty(2),
    rs.universe(3),
    rw.from_polygons([[[0, 0], [9, 0], [0, 9]], [[1, 1], [1, 2], [2, 1]]]).solid(3),
    rs.ball(1, 2).translate([1, 2]).scale([2, 3]).rotate(0, 1, 30).affine([[1, 2], [0, 1]], [3, 4]),
    rs.union([rs.ball(1, 3), rs.box([0] * 3, [1] * 3)]) ^ ~rs.ball(2, 2).extrude(3).named("tower"),
]


@pytest.mark.parametrize("solid", SHAPES, ids=repr)
def test_solids_are_values(solid):
    for twin in (copy.copy(solid), copy.deepcopy(solid), pickle.loads(pickle.dumps(solid))):
        assert twin == solid and hash(twin) == hash(solid) and repr(twin) == repr(solid)
    assert solid != ~solid and solid != "solid" and solid is not None
    with pytest.raises(AttributeError):
        solid.dimension = 3
    points = np.random.default_rng(1).uniform(-3, 3, (200, solid.dimension))
    again = pickle.loads(pickle.dumps(solid))
    np.testing.assert_array_equal(again.contains(points), solid.contains(points))


def test_equality_is_by_structure_and_not_by_sharing():
    a, b = rs.ball(1, 2), rs.ball(1, 2)
    assert (a | a) == (a | b) and (a | b) != (b | rs.ball(2, 2))
    assert rs.ball(1, 2) != rs.ball(1, 3)
    assert rs.box([-0.0, 0], [1, 1]) == rs.box([0, 0], [1, 1])
    assert repr(a - b.named("core")) == "<Solid of dimension 2: (ball(1) - core)>"
    assert len({a, b}) == 1


def test_what_is_inside(rng):
    for d in (2, 3, 4):
        p = rng.uniform(-3, 3, (2000, d))
        square = (p**2).sum(axis=1)
        first = p[:, 0] ** 2
        for solid, expected in [
            (rs.ball(2, d), square < 4),
            (rs.box([-1] * d, [2] * d), ((p > -1) & (p < 2)).all(axis=1)),
            (rs.half_space(d - 1, d, offset=0.5), p[:, -1] < 0.5),
            (rs.half_space_below([2] * d, 1), p.sum(axis=1) < 0.5),
            (rs.slab(1, -1, 0.5, d), (p[:, 1] > -1) & (p[:, 1] < 0.5)),
            (rs.quadric(d, 1, 1), 2 * first - square + 1 < 0),
            (rs.cylinder(1, 1.5, d), first < 2.25),
            (rs.cone(d - 1, 0.5, d), square - p[:, -1] ** 2 < p[:, -1] ** 2 / 4),
            (rs.empty(d), np.zeros(2000, bool)),
            (~rs.empty(d), np.ones(2000, bool)),
            (rs.prism([[0, 0], [0, 2], [2, 0]], d), (p[:, 0] > 0) & (p[:, 1] > 0) & (p[:, 0] + p[:, 1] < 2)),
        ]:
            np.testing.assert_array_equal(solid.contains(p), expected, err_msg=repr(solid))
        a, b = rs.ball(2, d), rs.box([0] * d, [3] * d)
        in_a, in_b = a.contains(p), b.contains(p)
        for sign in (operator.or_, operator.and_, operator.xor):
            np.testing.assert_array_equal(sign(a, b).contains(p), sign(in_a, in_b))
        np.testing.assert_array_equal((a - b).contains(p), in_a & ~in_b)
        np.testing.assert_array_equal(rs.union([a, b]).contains(p), in_a | in_b)
        np.testing.assert_array_equal(rs.intersection(iter([a, b])).contains(p), in_a & in_b)


def test_maps_move_points(rng):
    solid = rs.box([0, 0, 0], [1, 2, 3])
    matrix, offset = np.array([[1, 2, 0], [0, 1, 0], [1, 0, 3.0]]), np.array([1, -1, 2.0])
    turn = np.array([[math.cos(0.5), -math.sin(0.5)], [math.sin(0.5), math.cos(0.5)]])
    p = rng.uniform(-1, 4, (1000, 3))
    inside = solid.contains(p)
    turned = p.copy()
    turned[:, [2, 0]] = p[:, [2, 0]] @ turn.T
    np.testing.assert_array_equal(solid.affine(matrix, offset).contains(p @ matrix.T + offset), inside)
    np.testing.assert_array_equal(solid.translate(offset).contains(p + offset), inside)
    np.testing.assert_array_equal(solid.scale([1, -2, 3]).contains(p * [1, -2, 3]), inside)
    np.testing.assert_array_equal(solid.scale(-2).contains(-2 * p), inside)
    np.testing.assert_array_equal(solid.rotate(2, 0, math.degrees(0.5)).contains(turned), inside)
    high = np.column_stack([p, p[:, 0]])
    np.testing.assert_array_equal(solid.extrude(4).contains(high), inside)


def test_a_line_through_a_shell():
    shell = rs.ball(2, 3).named("outer") - rs.ball(1, 3).named("inner")
    p, q = [-4, 0, 0.5], [-2, 0, 0.5]
    outer, inner = math.sqrt(4 - 0.25), math.sqrt(1 - 0.25)
    times = [(4 + x) / 2 for x in (-outer, -inner, inner, outer)]
    ray = rs.trace(p, q, shell)
    assert not ray.starts_inside
    np.testing.assert_allclose(ray.roots, times, rtol=1e-15)
    found = shell.crossings(p, q)
    assert found.t.tolist() == ray.roots and repr(found).startswith("<PointCrossings: 4 rows of 1 rays\n")
    np.testing.assert_allclose(found.point, [[-4 + 2 * t, 0, 0.5] for t in times], atol=1e-15)
    # pointing out of the shell: away from the origin on the outer surface, towards it on the inner one
    np.testing.assert_allclose(found.normal, found.point / [[2], [-1], [-1], [2]], atol=1e-15)
    assert found.enters.tolist() == [True, False, True, False]
    assert [found.surface_names[k] for k in found.surface] == ["outer", "inner", "inner", "outer"]
    assert found.leaf.tolist() == [0, 1, 1, 0] and found.start_inside.tolist() == [False]


def test_many_lines_are_the_lines_one_by_one(rng):
    solid = (rs.ball(2, 4) | rs.box([0] * 4, [3] * 4)) - rs.cylinder(2, 0.5, 4)
    p, q = rng.normal(size=(700, 4)), rng.normal(size=(700, 4))
    found = solid.crossings(p, q, threads=2)
    for k in range(0, 700, 7):
        rows = slice(found.offsets[k], found.offsets[k + 1])
        ray = rs.trace(p[k], q[k], solid)
        assert found.t[rows].tolist() == ray.roots and set(found.ray[rows]) <= {k}
        assert found.start_inside[k] == ray.starts_inside
    np.testing.assert_allclose(found.point, p[found.ray] + found.t[:, None] * (q - p)[found.ray], atol=1e-12)
    along = ((q - p)[found.ray] * found.normal).sum(axis=1)
    assert np.array_equal(along < 0, found.enters)
    one = solid.crossings(p[0], q)
    assert one.t.tolist() == solid.crossings(np.broadcast_to(p[0], q.shape), q).t.tolist()
    assert len(solid.crossings(np.zeros((0, 4)), np.zeros((0, 4)))) == 0


def test_a_ball_that_moves():
    # the centre is at (3 - t, 0, 0), the radius 1; an observer at rest is in it from t = 2 to 4
    worldline = np.eye(4)
    worldline[0, 3] = -1
    ball = rs.cylinder(3, 1, 4).affine(worldline, [3, 0, 0, 0])
    np.testing.assert_allclose(rs.trace([0, 0, 0, 0], [0, 0, 0, 1], ball).roots, [2, 4], rtol=1e-14)
    # a projectile with the speed of the ball hits it at half the time
    np.testing.assert_allclose(rs.trace([0, 0, 0, 0], [1, 0, 0, 1], ball).roots, [1, 2], rtol=1e-14)
    # x = a t^2 / 2 falls towards it: |t^2 / 2 - 3 + t| = 1
    fall = rs.Parabola([0, 0, 0, 0], [0, 0, 0, 1], [1, 0, 0, 0])
    times = rs.trace_along(fall, ball, 0, 10).roots
    np.testing.assert_allclose(times, [math.sqrt(5) - 1, 2], rtol=1e-14)


def test_polygons_are_solids():
    frame = rw.from_polygons([[[0, 0], [6, 0], [6, 4], [0, 4]], [[1, 1], [1, 3], [3, 3], [3, 1]]])
    solid = frame.solid()
    assert rs.trace([0, 2], [1, 2], solid).roots == frame.trace([0, 2], [1, 0]).roots == [0, 1, 3, 6]
    assert frame.contains([[0.5, 2], [2, 2]]).tolist() == solid.contains([[0.5, 2], [2, 2]]).tolist() == [True, False]
    wall = frame.solid(3) & rs.slab(2, 0, 1, 3)
    assert rs.trace([0.5, 2, -1], [0.5, 2, 0], wall).roots == [1, 2]
    names = wall.crossings([0, 2, 0.5], [1, 2, 0.5])
    assert [names.surface_names[k] for k in names.surface][0] == "contour0.edge3"
    with pytest.raises(RayweaveError, match=r"points has shape \(3,\)"):
        frame.contains([1, 2, 3])
    with pytest.raises(RayweaveError, match=r"points\[1\]: .*must be finite"):
        frame.contains([[0, 0], [math.nan, 0]])


def test_deep_trees_do_not_overflow_the_stack():
    solid = rs.ball(1, 2)
    for k in range(20_000):
        solid = solid | rs.ball(1 + k % 7, 2) if k % 2 else ~solid
    twin = pickle.loads(pickle.dumps(solid))
    assert twin == solid and hash(twin) == hash(solid) and len(repr(solid)) < 200
    del solid, twin


def test_solids_of_different_dimension_do_not_combine():
    flat, solid = rs.ball(1, 2), rs.ball(1, 3)
    for sign in (operator.or_, operator.and_, operator.sub, operator.xor):
        with pytest.raises(RayweaveError, match="dimension 2 and the other of dimension 3"):
            sign(flat, solid)
    for join in (rs.union, rs.intersection):
        with pytest.raises(RayweaveError, match=r"solids\[0\] is of dimension 2 and solids\[1\] of dimension 3"):
            join([flat, solid])
        with pytest.raises(RayweaveError, match="solids is empty"):
            join([])
        with pytest.raises(TypeError, match=r"solids\[1\] is 3"):
            join([flat, 3])
        with pytest.raises(TypeError, match="iterable of solids"):
            join(3)
    with pytest.raises(TypeError):
        flat | rw.sphere(1)
    with pytest.raises(RayweaveError, match="of dimension 3"):
        solid.extrude(2)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rs.ball(1, 5), "dimension is 5"),
        (lambda: rs.ball(1, 1), "dimension is 1"),
        (lambda: rs.half_space(0, 5), "dimension is 5"),
        (lambda: rs.half_space(3, 3), "axis 3 is out of range"),
        (lambda: rs.half_space(-1, 3), "axis -1 is out of range"),
        (lambda: rs.half_space_below([0, 0], 1), "normal is zero"),
        (lambda: rs.slab(2, 0, 1, 2), "axis 2 is out of range"),
        (lambda: rs.slab(-1, 0, 1, 2), "axis is -1"),
        (lambda: rs.slab(0, 1, 1, 2), "lo must be less than hi"),
        (lambda: rs.box([0, 0], [1, 0]), r"lo\[1\] is 0 and hi\[1\] is 0"),
        (lambda: rs.box([0, 0], [1, 1, 1]), "lo has 2 numbers and hi has 3"),
        (lambda: rs.box([0, math.nan], [1, 1]), r"lo\[1\] is NaN"),
        (lambda: rs.box(0, 1), r"lo has shape \(\)"),
        (lambda: rs.quadric(2, 3, 0), "n is 2 and m is 3"),
        (lambda: rs.quadric(1, 1, 0), "dimension is 1"),
        (lambda: rs.ball(-1, 2), "radius is -1"),
        (lambda: rs.ball(1e61, 2), "Check the unit"),
        (lambda: rs.ball(math.inf, 2), "radius is inf"),
        (lambda: rs.cylinder(0, 1, 2), "m is 0"),
        (lambda: rs.cone(3, 1, 3), "m is 3"),
        (lambda: rs.prism([[0, 0], [1, 1], [1, 0], [0, 1]], 2), "crosses"),
        (lambda: rs.prism([0, 1, 2], 2), r"points has shape \(3,\)"),
        (lambda: rs.ball(1, 2).translate([1]), "v has 1 numbers"),
        (lambda: rs.ball(1, 2).translate([1, math.inf]), r"translation\[1\] is inf"),
        (lambda: rs.ball(1, 2).scale(0), "singular"),
        (lambda: rs.ball(1, 2).rotate(0, 0, 9), "both 0"),
        (lambda: rs.ball(1, 2).rotate(0, 2, 9), "axis 2 is out of range"),
        (lambda: rs.ball(1, 2).rotate(0, 1, math.nan), "degrees is NaN"),
        (lambda: rs.ball(1, 2).affine(np.eye(3)), r"matrix has shape \(3, 3\)"),
        (lambda: rs.ball(1, 2).affine([[1, 2], [2, 4]]), "singular"),
        (lambda: rs.ball(1, 2).named(""), "name is empty"),
        (lambda: rs.ball(1, 2).contains([1, 2, 3]), r"it must be \(N, 2\) or \(2,\)"),
        (lambda: rs.ball(1, 2).contains([[0, 0], [math.nan, 2]]), r"points\[1\]"),
        (lambda: rs.trace([0, 0], [0, 0], rs.ball(1, 2)), "same point"),
        (lambda: rs.trace([0, 0, 0], [1, 0], rs.ball(1, 2)), "p has 3 numbers"),
        (lambda: rs.ball(1, 2).crossings([[0, 0], [1, 1]], [1, 1]), "line 1: .*same point"),
        (lambda: rs.ball(1, 2).crossings(np.zeros((2, 2)), np.ones((3, 2))), "2 points p and 3 points q"),
        (lambda: rs.ball(1, 2).crossings([0, 0], [1, 1], threads=0), "threads is 0"),
    ],
)
def test_what_is_wrong_is_said(make, message):
    with pytest.raises(RayweaveError, match=message):
        make()


def test_wrong_types():
    for make in [
        lambda: rs.ball("1", 2),
        lambda: rs.ball(1, "2"),
        lambda: rs.ball(1, True),
        lambda: rs.half_space(0.5, 2),
        lambda: rs.slab("x", 0, 1, 2),
        lambda: rs.box(["a"], ["b"]),
        lambda: rs.trace([0, 0], [1, 1], rw.sphere(1)),
        lambda: rs.Solid(),
    ]:
        with pytest.raises(TypeError):
            make()


def test_damaged_pickles_are_refused():
    from rayweave import _core

    step = ("ball", 2, [1.0], None, [])
    assert _core.space_solid_from_steps([step]) == rs.ball(1, 2)
    for steps in [
        [],
        [("bowl", 2, [1.0], None, [])],
        [("ball", 2, [1.0, 2.0], None, [])],
        [("complement", 2, [], None, [0])],
        [step, ("complement", 3, [], None, [0])],
        [step, ("named", 2, [], None, [0])],
        [("polygons", 2, [1.0, 5.0], None, [])],
        [("extrude", 3, [], None, [])],
    ]:
        with pytest.raises(RayweaveError, match="pickled|numbers"):
            _core.space_solid_from_steps(steps)
