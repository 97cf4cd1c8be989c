"""Curves through solids and models: closed forms, equivalent computations, and curves that violate their bound."""

import copy
import math
import pickle

import numpy as np
import pytest

import rayweave as rw
import rayweave.space as rs
from rayweave import RayweaveError

MODEL = """
rayweave = 1
[solid.outer]
sphere = { radius = 3 }
[solid.inner]
sphere = { radius = 1 }
[[region]]
solid = "outer"
medium = "glass"
[[region]]
solid = "inner"
medium = "water"
[medium.glass]
[medium.water]
"""

CURVES = [
    rs.Line([1, 2], [3, 4]),
    rs.Parabola([0, 0, 1], [1, 0, 5], [0, 0, -9.81]),
    rs.Arc([0, 0, 0, 0], [[1, 0, 0, 0], [0, 2, 0, 0]], speed=2),
    rs.Arc.about([0, 0, 1], [0, 0, 2], [2, 0, 5]),
    rs.Helix([1, 0, 0], [0, 1, 1], [0, 0, 1], radius=-2),
    rs.Helix([1, 0, 0], [0, 1, 1], [0, 0, 1], radius=math.inf),
    rs.Helix.with_frequency([1, 0, 0], [0, 1, 1], [0, 0, 1], 30),
    rs.Helix.about([0, 0, 0], [0, 0, 1], [2, 0, 0], pitch=1),
    rs.Spline([0, 1, 3], [[0, 0], [1, 2], [3, 1]]),
    rs.Spline([0, 1, 3], [[0, 0], [1, 2], [0, 0]], "periodic"),
    rs.Spline([0, 1, 3], [[0, 0], [1, 2], [3, 1]], ends="clamped", velocities=[[1, 0], [0, 1]]),
]


class Circle:
    """A circle about z, with t in radians; counts its calls."""

    def __init__(self, radius, dimension=3):
        self.radius, self.rest, self.calls = radius, [0.0] * (dimension - 2), 0

    def position(self, t):
        self.calls += 1
        return [self.radius * math.cos(t), self.radius * math.sin(t), *self.rest]

    def velocity(self, t):
        return np.array([-self.radius * math.sin(t), self.radius * math.cos(t), *self.rest])

    def acceleration_bound(self, t0, t1):
        assert t0 < t1
        return self.radius


class Broken(Circle):
    """A circle of which one method is another function."""

    def __init__(self, **methods):
        super().__init__(1.0)
        self.__dict__.update(methods)


@pytest.mark.parametrize("curve", CURVES, ids=repr)
def test_curves_are_values(curve):
    for twin in (copy.copy(curve), copy.deepcopy(curve), pickle.loads(pickle.dumps(curve))):
        assert twin == curve and hash(twin) == hash(curve) and repr(twin) == repr(curve)
        assert twin.position(0.5).tolist() == curve.position(0.5).tolist()
    assert sum(curve == other for other in CURVES) == 1 and curve != 3
    first, last = curve.domain
    assert (first, last) == ((0, 3) if isinstance(curve, rs.Spline) else (-math.inf, math.inf))


@pytest.mark.parametrize("curve", CURVES, ids=repr)
def test_velocity_and_bound_are_those_of_the_position(curve):
    t = np.linspace(0.01, 2.99, 150)
    step = 1e-4
    position, velocity = curve.position(t), curve.velocity(t)
    assert position.shape == velocity.shape == (150, curve.dimension)
    assert np.array_equal(position[7], curve.position(t[7]))
    difference = (curve.position(t + step) - curve.position(t - step)) / (2 * step)
    np.testing.assert_allclose(velocity, difference, atol=1e-6)
    second = (curve.velocity(t + step) - curve.velocity(t - step)) / (2 * step)
    assert np.linalg.norm(second, axis=1).max() <= curve.acceleration_bound(0, 3) * (1 + 1e-6) + 1e-6


def test_a_helix_in_a_slab():
    helix = rs.Helix.about([0, 0, 0], [0, 0, 1], [2, 0, 0], pitch=3)
    # one turn of 360 units of t rises by 3
    slab = rw.slab([0, 0, 1], 1, 4)
    found = slab.crossings_along(helix, 0, 1000)
    np.testing.assert_allclose(found.t, [120, 480], rtol=1e-14)
    np.testing.assert_allclose(found.point, [[-1, math.sqrt(3), 1], [-1, math.sqrt(3), 4]], atol=1e-12)
    assert found.enters.tolist() == [True, False] and found.start_inside.tolist() == [False]
    assert [found.surface_names[k] for k in found.surface] == ["slab.lo", "slab.hi"]
    assert np.array_equal(found.normal, [[0, 0, -1], [0, 0, 1]])
    np.testing.assert_allclose(rs.trace_along(helix, rs.slab(2, 1, 4, 3), 0, 1000).roots, [120, 480], rtol=1e-14)


def test_a_helix_through_a_wall():
    # x = cos t < 1/2, t in degrees: a closed form for many turns
    helix = rs.Helix.with_frequency([1, 0, 0], [0, math.radians(1), 0.01], [0, 0, 1], -1)
    found = rw.half_space([1, 0, 0], 0.5).crossings_along(helix, 0, 36_000)
    turns = 360 * np.arange(100)[:, None]
    np.testing.assert_allclose(found.t, (turns + [60, 300]).ravel(), rtol=1e-13)


def test_a_projectile_in_a_ball():
    path = rs.Parabola([-3, 0, 0], [4, 0, 5], [0, 0, -10])
    ball = rw.sphere(2)
    # |p + v t + a t^2 / 2|^2 = 4, expanded
    roots = np.roots([25, -50, 16 + 25, -24, 9 - 4])
    times = sorted(roots[np.isreal(roots)].real)
    found = ball.crossings_along(path, -10, 10)
    np.testing.assert_allclose(found.t, times, rtol=1e-12)
    np.testing.assert_allclose(found.normal, found.point / 2, atol=1e-12)


def test_the_line_of_a_ray_is_the_ray(rng):
    solid = rw.box(2) - rw.cylinder(0.5) | rw.torus(2, 0.5)
    origins, directions = rng.uniform(-3, 3, (60, 3)), rng.normal(size=(60, 3))
    rays = solid.crossings(origins, directions, -50, 50)
    curves = solid.crossings_along([rs.Line(o, d) for o, d in zip(origins, directions)], -50, 50, threads=2)
    assert np.array_equal(rays.offsets, curves.offsets) and np.array_equal(rays.ray, curves.ray)
    np.testing.assert_allclose(curves.t, rays.t, atol=1e-11)
    for name in ("point", "normal"):
        np.testing.assert_allclose(getattr(curves, name), getattr(rays, name), atol=1e-9)
    for name in ("enters", "surface", "leaf", "placement", "start_inside"):
        np.testing.assert_array_equal(getattr(curves, name), getattr(rays, name))
    assert curves.surface_names == rays.surface_names


def test_a_users_circle():
    # a circle of radius 2 and a wall at x = 1, for three turns
    times = (2 * math.pi * np.arange(3)[:, None] + [math.pi / 3, 5 * math.pi / 3]).ravel()
    circle = Circle(2.0)
    found = rw.half_space([1, 0, 0], 1).crossings_along(circle, 0, 6 * math.pi)
    np.testing.assert_allclose(found.t, times, rtol=1e-14)
    np.testing.assert_allclose(found.point[:, 0], 1, atol=1e-14)
    assert 0 < circle.calls < 3000
    flat = rs.half_space(0, 2, offset=1)
    np.testing.assert_allclose(rs.trace_along(Circle(2.0, 2), flat, 0, 6 * math.pi).roots, times, rtol=1e-14)
    assert rs.trace_along(Circle(2.0, 2), rs.ball(1, 2), 0, 9).roots == []
    # in the surface: nothing is crossed, as if the curve were moved aside
    assert rs.trace_along(Circle(2.0, 2), rs.ball(2, 2), 0, 9).roots == []


def test_user_defined_and_built_in_curves_agree():
    solid = rw.torus(3, 1) - rw.box(3).translate([3, 0, 0])
    ours = rs.Arc.about([0, 0, 0], [0, 0, 1], [2.5, 0, 0])
    radians = solid.crossings_along(Circle(2.5), 0.1, 12)
    degrees = solid.crossings_along(ours, math.degrees(0.1), math.degrees(12))
    assert len(radians) > 0
    np.testing.assert_allclose(np.degrees(radians.t), degrees.t, rtol=1e-13)
    np.testing.assert_array_equal(radians.enters, degrees.enters)
    mixed = solid.crossings_along([ours, Circle(2.5)], [math.degrees(0.1), 0.1], [math.degrees(12), 12])
    assert mixed.t.tolist() == degrees.t.tolist() + radians.t.tolist()
    assert mixed.ray.tolist() == [0] * len(degrees) + [1] * len(radians)


def test_a_list_is_the_curves_one_by_one():
    solid = rw.sphere(2) - rw.box([9, 1, 1])
    curves = [rs.Helix([0.1 * k, 0, 0], [0, 1, 0.1], [0, 0, 1], 1 + 0.05 * k) for k in range(40)]
    ends = np.linspace(5, 60, 40)
    together = solid.crossings_along(curves, 0, ends)
    for k, curve in enumerate(curves):
        alone = solid.crossings_along(curve, 0, ends[k])
        rows = slice(together.offsets[k], together.offsets[k + 1])
        assert together.t[rows].tolist() == alone.t.tolist()
        assert together.start_inside[k] == alone.start_inside[0]
    for threads in (1, 3):
        assert solid.crossings_along(curves, 0, ends, threads=threads).t.tolist() == together.t.tolist()
    assert len(solid.crossings_along([], 0, 1)) == 0
    flat = rs.ball(1, 3).crossings_along(iter(curves), 0, 10)
    assert flat.offsets.shape == (41,) and flat.point.shape == (len(flat), 3)


def test_media_along_a_curve():
    model = rw.loads(MODEL)
    found = model.crossings_along(rs.Parabola([-4, 0, 0], [4, 0, 0], [0, 0, 0]), 0, 5)
    np.testing.assert_allclose(found.t, [0.25, 0.75, 1.25, 1.75], rtol=1e-14)
    names = found.medium_names
    assert [(names[a], names[b]) for a, b in zip(found.medium_before, found.medium_after)] == [
        ("world", "glass"),
        ("glass", "water"),
        ("water", "glass"),
        ("glass", "world"),
    ]
    rays = model.crossings([-4, 0, 0], [4, 0, 0])
    np.testing.assert_allclose(found.normal, rays.normal, atol=1e-14)
    assert np.array_equal(found.enters, rays.enters)
    assert np.array_equal(model.crossings_along([Circle(2.0), Circle(4.0)], 0, 6).start_inside, [True, False])


def test_placed_and_periodic():
    row = rw.place(rw.sphere(0.25), [[k, 0, 0] for k in range(10)])
    line = rs.Line([-1, 0, 0], [1, 0, 0])
    found = row.crossings_along(line, 0, 20)
    np.testing.assert_allclose(found.t, (np.arange(1, 11)[:, None] + [-0.25, 0.25]).ravel(), rtol=1e-14)
    assert len(set(found.placement)) == 10
    corners = np.array([[1, 0], [0, 1], [-1, 0], [0, -1], [1, 0.0]])
    loop = rs.Spline([0, 1, 2, 3, 4], corners, ends="periodic")
    quarter = rs.trace_along(loop, rs.half_space(1, 2), 0.5, 3.5).roots
    np.testing.assert_allclose(quarter, [2], atol=1e-12)


def test_exceptions_propagate_unchanged():
    class Mine(Exception):
        pass

    problem = Mine("here")

    def fail(*_):
        raise problem

    for method in ("position", "velocity", "acceleration_bound"):
        for ask in (
            lambda curve: rw.sphere(0.5).crossings_along(curve, 0, 1),
            lambda curve: rs.trace_along(curve, rs.ball(0.5, 3), 0, 1),
        ):
            with pytest.raises(Mine) as caught:
                ask(Broken(**{method: fail}))
            assert caught.value is problem
    with pytest.raises(Mine) as caught:
        rw.sphere(0.5).crossings_along([Circle(1.0), Broken(velocity=fail)], 0, 1)
    assert caught.value is problem and caught.value.__notes__ == ["while tracing curves[1]"]

    def stop(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rw.sphere(0.5).crossings_along(Broken(position=stop), 0, 1)


@pytest.mark.parametrize(
    ("methods", "message"),
    [
        ({"position": lambda t: [1.0, 2.0]}, r"position\(0.0\) of the curve has 2 numbers: it must have 3"),
        ({"velocity": lambda t: np.zeros((3, 1))}, r"velocity\(0.0\) of the curve has shape \(3, 1\)"),
        ({"position": lambda t: [1.0, 2.0, math.nan]}, "curve at t = 0 .*NaN or infinite"),
        ({"velocity": lambda t: [math.inf, 0.0, 0.0]}, "curve at t = 0 .*NaN or infinite"),
        ({"acceleration_bound": lambda a, b: math.nan}, "acceleration bound between t = .* is NaN"),
        ({"acceleration_bound": lambda a, b: -1.0}, "acceleration bound between t = .* is -1"),
        ({"acceleration_bound": lambda a, b: 0.01}, "curve between t = .* and t = .*differ by more"),
        ({"velocity": lambda t: [1.0, 1.0, 1.0]}, "velocity is the derivative"),
    ],
)
def test_violated_bounds_are_reported_with_their_times(methods, message):
    solid = rw.box([0.4, 3, 3])
    with pytest.raises(RayweaveError, match=message):
        solid.crossings_along(Broken(**methods), 0, 3)
    with pytest.raises(RayweaveError, match=message):
        rs.trace_along(Broken(**methods), rs.box([-0.2, -3, -3], [0.2, 3, 3]), 0, 3)


@pytest.mark.parametrize("methods", [{"position": lambda t: None}, {"acceleration_bound": lambda a, b: "much"}])
def test_answers_of_the_wrong_type(methods):
    with pytest.raises(TypeError, match="of the curve"):
        rw.sphere(0.9).crossings_along(Broken(**methods), 0, 3)


def test_the_domain_of_a_user_defined_curve_is_respected():
    half = Broken(domain=(0.0, math.pi))
    assert len(rw.half_space([1, 0, 0], 0.5).crossings_along(half, 0, 3)) == 1
    with pytest.raises(RayweaveError, match="defined from 0 to 3.14"):
        rw.sphere(0.5).crossings_along(half, 0, 4)
    with pytest.raises(TypeError, match="domain"):
        rw.sphere(0.5).crossings_along(Broken(domain="always"), 0, 4)


def test_bad_questions():
    ball, helix = rw.sphere(1), CURVES[4]
    for window in [(0, math.inf), (-math.inf, 0), (1, 0), (1, 1), (math.nan, 1)]:
        with pytest.raises(RayweaveError, match="window"):
            ball.crossings_along(helix, *window)
        with pytest.raises(RayweaveError, match=r"curves\[0\]: the window"):
            rs.ball(1, 3).crossings_along([helix], *window)
    with pytest.raises(RayweaveError, match=r"curves\[2\]: the window from 5 to 1"):
        ball.crossings_along([helix] * 3, [0, 0, 5], 1)
    with pytest.raises(RayweaveError, match=r"t_max has shape \(2,\): .*\(3,\)"):
        ball.crossings_along([helix] * 3, 0, [1, 2])
    with pytest.raises(RayweaveError, match=r"curves\[1\]: the curve is of dimension 2 and the solid of dimension 3"):
        ball.crossings_along([helix, CURVES[0]], 0, 1)
    with pytest.raises(RayweaveError, match="dimension 2 and the solid of dimension 3"):
        rs.trace_along(CURVES[0], rs.ball(1, 3), 0, 1)
    with pytest.raises(RayweaveError, match="defined from 0 to 3"):
        rs.trace_along(CURVES[8], rs.ball(1, 2), 0, 4)
    with pytest.raises(RayweaveError, match="threads is 0"):
        ball.crossings_along(helix, 0, 1, threads=0)

    class Half:
        def position(self, t): ...

    with pytest.raises(TypeError, match="without velocity"):
        ball.crossings_along(Half(), 0, 1)
    with pytest.raises(TypeError, match=r"curves\[1\]: .*without position"):
        ball.crossings_along([helix, 3], 0, 1)
    with pytest.raises(TypeError, match="list of curves"):
        ball.crossings_along(3, 0, 1)
    with pytest.raises(TypeError, match="pass one curve"):
        rs.trace_along([helix, helix], rs.ball(1, 3), 0, 1)
    with pytest.raises(TypeError):
        ball.crossings_along(helix, "now", "then")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rs.Line([0, 0], [1, 0, 0]), "origin has 2 numbers and direction has 3"),
        (lambda: rs.Line([0], [1]), "dimension is 1"),
        (lambda: rs.Line([0, math.nan], [1, 0]), r"origin\[1\] is NaN"),
        (lambda: rs.Parabola([0, 0], [0, 0], [0, math.inf]), r"acceleration\[1\] is inf"),
        (lambda: rs.Arc([0, 0], [[1, 0]]), "axes has 1 rows"),
        (lambda: rs.Arc([0, 0], [1, 0]), r"axes has shape \(2,\)"),
        (lambda: rs.Arc([0, 0], [[1, 0], [0, 1]], math.nan), "speed"),
        (lambda: rs.Arc.about([0, 0, 0], [0, 0, 1], [0, 0, 5]), "start .*axis of the circle"),
        (lambda: rs.Arc.about([0, 0, 0], [0, 0, 0], [1, 0, 5]), "normal .*length 0"),
        (lambda: rs.Helix([0, 0], [1, 0, 0], [0, 0, 1], 1), "position has 2 numbers"),
        (lambda: rs.Helix([0, 0, 0], [1, 0, 0], [0, 0, 0], 1), "axis .*length 0"),
        (lambda: rs.Helix([0, 0, 0], [1, 0, 0], [0, 0, 1], 0), "radius .*must not be 0"),
        (lambda: rs.Helix.with_frequency([0, 0, 0], [1, 0, 0], [0, 0, 1], math.nan), "frequency"),
        (lambda: rs.Helix.about([0, 0, 0], [0, 0, 1], [1, 0, 0], math.inf), "pitch"),
        (lambda: rs.Spline([0], [[0, 0]]), "at least two"),
        (lambda: rs.Spline([0, 1], [[0, 0]]), "one for each point"),
        (lambda: rs.Spline([0, 0], [[0, 0], [1, 1]]), r"knots\[1\]"),
        (lambda: rs.Spline([0, 1], [[0, 0], [1, math.nan]]), r"points\[1\]"),
        (lambda: rs.Spline([0, 1], [[0, 0], [1, 1]], "periodic"), r"points\[1\]"),
        (lambda: rs.Spline([0, 1], [[0, 0], [1, 1]], "loose"), "ends is 'loose'"),
        (lambda: rs.Spline([0, 1], [[0, 0], [1, 1]], "clamped"), "velocities is missing"),
        (lambda: rs.Spline([0, 1], [[0, 0], [1, 1]], "clamped", [[0, 0]]), r"velocities has shape \(1, 2\)"),
        (lambda: rs.Spline([0, 1], [[0, 0], [1, 1]], "natural", [[0, 0], [1, 1]]), "velocities are given"),
        (lambda: rs.Line([0, 0], [1, 0]).position([0, math.nan]), r"t\[1\] is NaN"),
        (lambda: rs.Line([0, 0], [1, 0]).velocity([[0]]), r"t has shape \(1, 1\)"),
        (lambda: rs.Line([0, 0], [1, 0]).acceleration_bound(1, 0), "t0 must be less"),
    ],
)
def test_invalid_curves_are_rejected(make, message):
    with pytest.raises(RayweaveError, match=message):
        make()
