"""The functions that create shapes: manual pages, signatures, and membership of points."""

import inspect
import math

import numpy as np
import pytest

import rayweave
from rayweave import RayweaveError, _core

INF = math.inf
NAMES = [page["name"] for page in _core.manuals()]
EXAMPLES = {
    "sphere": (2,),
    "ellipsoid": ([1, 2, 3],),
    "box": ([1, 2, 3],),
    "box_from_corners": ([-1, -2, 0], [1, 2, 5]),
    "cylinder": (1, 3),
    "cone": (2, 1, 3),
    "half_space": ([1, 2, 2], 3),
    "slab": ([0, 0, 2], -2, 3),
    "torus": (3, 1),
    "paraboloid": (0.5, 3),
    "quadric": (np.diag([1, 1, -1, -1]),),
    "tube": (2, 1, 3),
    "wedge": (30, 100),
    "prism": (6, 2, 3),
    "convex": ([[1, 0, 0, 1], [-1, 0, 0, 1], [0, 1, 0, 2]],),
    "mesh": ([[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
    "asphere": (3, 0.2, -1, [0, 0.02], (), 4),
    "biconic": (3, 0.2, -0.1, -1, -1, 4),
    "freeform": (3, 0.2, -1, [0, 0, 0, 1], [0, 0, 0, 0.5], 0, 4),
}


def inside(name, x, y, z):
    """The documented conditions for inside, in NumPy."""
    r = np.hypot(x, y)
    azimuth = np.degrees(np.arctan2(y, x)) % 360
    match name:
        case "sphere":
            return x**2 + y**2 + z**2 < 4
        case "ellipsoid":
            return x**2 + (y / 2) ** 2 + (z / 3) ** 2 < 1
        case "box":
            return (abs(x) < 0.5) & (abs(y) < 1) & (abs(z) < 1.5)
        case "box_from_corners":
            return (abs(x) < 1) & (abs(y) < 2) & (z > 0) & (z < 5)
        case "cylinder":
            return (r < 1) & (abs(z) < 1.5)
        case "cone":
            return (r < 1.5 - z / 3) & (abs(z) < 1.5)
        case "half_space":
            return x + 2 * y + 2 * z < 3
        case "slab":
            return (2 * z > -2) & (2 * z < 3)
        case "torus":
            return (r - 3) ** 2 + z**2 < 1
        case "paraboloid":
            return (r**2 < 2 * z) & (z < 3)
        case "quadric":
            return x**2 + y**2 - z**2 - 1 < 0
        case "tube":
            return (r < 2) & (r > 1) & (abs(z) < 1.5)
        case "wedge":
            return (azimuth > 30) & (azimuth < 130)
        case "prism":
            apothem = 2 * math.cos(math.pi / 6)
            angles = np.radians(30 + 60 * np.arange(6))
            sides = [x * math.cos(a) + y * math.sin(a) < apothem for a in angles]
            return np.logical_and.reduce(sides) & (abs(z) < 1.5)
        case "convex":
            return (abs(x) < 1) & (y < 2)
        case "mesh":
            return (x > 0) & (y > 0) & (z > 0) & (x + y + z < 3)
        case "asphere":
            return (r < 3) & (0.1 * r**2 + 0.02 * r**4 < z) & (z < 4)
        case "biconic":
            return (r < 3) & (0.1 * x**2 - 0.05 * y**2 < z) & (z < 4)
        case "freeform":
            defocus = 0.5 * math.sqrt(3) * (2 * r**2 / 9 - 1)
            return (r < 3) & (0.1 * r**2 + x * y / 9 + defocus < z) & (z < 4)


def test_every_shape_of_the_engine_is_a_function():
    assert set(NAMES) <= set(rayweave.__all__)
    assert set(NAMES) == set(EXAMPLES)


@pytest.mark.parametrize("name", NAMES)
def test_points_are_inside_as_documented(name, rng):
    points = rng.uniform(-5, 5, (4000, 3))
    solid = getattr(rayweave, name)(*EXAMPLES[name])
    expected = inside(name, *points.T)
    np.testing.assert_array_equal(solid.contains(points), expected)
    assert expected.any() and not expected.all()
    lo, hi = solid.bounds
    assert ((points[expected] >= lo) & (points[expected] <= hi)).all()


@pytest.mark.parametrize("name", NAMES)
def test_manual_pages(name):
    function = getattr(rayweave, name)
    page = _core.manuals()[NAMES.index(name)]
    assert list(inspect.signature(function).parameters) == [p["name"] for p in page["parameters"]]
    for parameter in page["parameters"]:
        assert f"\n{parameter['name']} : " in function.__doc__
        assert parameter["summary"].split()[0] in function.__doc__
    assert function.__doc__.startswith(page["text"].splitlines()[0])
    assert "| ---" not in function.__doc__
    assert function.__module__ == "rayweave._shapes" and function.__qualname__ == name


def test_defaults_and_keywords():
    assert rayweave.cylinder(1) == rayweave.cylinder(radius=1, height=INF)
    assert rayweave.box(2) == rayweave.box(size=[2, 2, 2]) == rayweave.box(np.array([2, 2, 2]))
    assert rayweave.cylinder(1).contains([0, 0, 1e9])
    assert rayweave.prism(np.int64(6), np.float32(2), 3) == rayweave.prism(6, 2.0, 3)
    with pytest.raises(TypeError, match=r"sphere\(\) missing 1 required positional argument: 'radius'"):
        rayweave.sphere()
    with pytest.raises(TypeError, match="unexpected keyword argument 'radious'"):
        rayweave.sphere(radious=1)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rayweave.sphere(-1), r"sphere: radius is -1: .* Did you mean 1\?"),
        (lambda: rayweave.sphere(0), "radius is 0"),
        (lambda: rayweave.sphere(math.nan), "radius is nan"),
        (lambda: rayweave.sphere(INF), "radius is inf"),
        (lambda: rayweave.sphere(1e200), "radius"),
        (lambda: rayweave.box([1, 2]), "size is a list of 2 numbers"),
        (lambda: rayweave.box([1, -2, 3]), r"size\[1\] is -2"),
        (lambda: rayweave.box_from_corners([0, 0, 0], [1, 1, 0]), r"lo\[2\]"),
        (lambda: rayweave.half_space([0, 0, 0], 1), "has length zero"),
        (lambda: rayweave.convex([[0, 0, 1, 1], [0, 0, 0, 1]]), r"planes\[1\] has length zero"),
        (lambda: rayweave.convex([]), "planes"),
        (lambda: rayweave.convex(np.zeros((2, 0))), "planes"),
        (lambda: rayweave.quadric([[1, 2, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, -1]]), r"matrix\[0\]\[1\]"),
        (lambda: rayweave.quadric(np.zeros((4, 3))), "matrix"),
        (lambda: rayweave.mesh(np.eye(3), [[0, 1, 2]]), "the mesh is not closed: 3 edges"),
        (lambda: rayweave.mesh(np.eye(3), [[0, 1, 3]]), "triangle 0 refers to vertex 3"),
        (lambda: rayweave.mesh(np.eye(4), [[0, 1, 3]]), r"vertices\[0\] is a list of 4 numbers"),
        (lambda: rayweave.prism(6.5, 1, 1), "sides is 6.5"),
        (lambda: rayweave.prism(10**9, 1, 1), "sides is"),
        (lambda: rayweave.prism(2, 1, 1), "sides is 2"),
        (lambda: rayweave.wedge(0, 360), "sweep_degrees is 360"),
        (lambda: rayweave.cone(0, 0, 1), "are both 0"),
        (lambda: rayweave.tube(1, 2, 1), "inner_radius"),
        (lambda: rayweave.ellipsoid(np.ones((2, 2, 2))), r"radii has shape \(2, 2, 2\)"),
    ],
)
def test_bad_values_are_refused_at_once(make, message):
    with pytest.raises(RayweaveError, match=message):
        make()


@pytest.mark.parametrize(
    "make",
    [
        lambda: rayweave.sphere("1"),
        lambda: rayweave.sphere(None),
        lambda: rayweave.sphere([1, 2, 3]),
        lambda: rayweave.sphere(True),
        lambda: rayweave.sphere(1j),
        lambda: rayweave.box("big"),
        lambda: rayweave.box(["a", "b", "c"]),
        lambda: rayweave.box([True, False, True]),
        lambda: rayweave.ellipsoid(None),
    ],
)
def test_wrong_types_are_type_errors(make):
    with pytest.raises(TypeError, match="it must be|its numbers must be"):
        make()
