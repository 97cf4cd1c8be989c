"""Extrusions and solids of revolution against closed forms."""

import math

import numpy as np
import pytest

import rayweave as rw

PLATE = [[0, 0], [60, 0], [60, 40], [0, 40]]
HOLE = [[25, 20, 1], [35, 20, 1]]


def volume(solid: rw.Solid) -> tuple[float, float]:
    """The volume, and the half width of an interval that misses it once in a million seeds."""
    found = rw.measure(solid, precision=2e-3, confidence=1 - 1e-6)
    return found.volume[0], found.volume_half_width[0]


def test_a_plate_with_rounded_corners_and_a_hole() -> None:
    part = rw.extrude([PLATE, HOLE], 5, z=-1, fillet=6)
    area = 60 * 40 - (4 - math.pi) * 36 - math.pi * 25
    found, error = volume(part)
    assert abs(found - 5 * area) <= error
    np.testing.assert_array_equal(part.bounds, [[0, 0, -1], [60, 40, 4]])
    # the arc of a corner has its centre at (6, 6)
    edge = 6 - 6 * math.sqrt(0.5)
    times = part.hits([-10, -10, 0], [1, 1, 0]).ravel()
    np.testing.assert_allclose(times[0], edge + 10, rtol=1e-14)


def test_chamfers_of_rims_are_at_45_degrees() -> None:
    part = rw.extrude(PLATE, 5, top_chamfer=1, bottom_fillet=2)
    times = part.hits([-10, 20, 4.75], [1, 0, 0]).ravel()
    np.testing.assert_allclose(times, [10.75, 69.25], rtol=1e-14)
    times = part.hits([-10, 20, 1], [1, 0, 0]).ravel()
    inset = 2 - math.sqrt(3)
    np.testing.assert_allclose(times, [10 + inset, 70 - inset], rtol=1e-14)


def test_a_revolved_circle_is_a_torus() -> None:
    ring, torus = rw.revolve([[10, 0, 1], [6, 0, 1]]), rw.torus(8, 2)
    rng = np.random.default_rng(5)
    points = rng.uniform(-11, 11, (2000, 3)) * [1, 1, 0.25]
    np.testing.assert_array_equal(ring.contains(points), torus.contains(points))
    quarter = rw.revolve([[10, 0, 1], [6, 0, 1]], 90, start=45)
    angle = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
    expected = torus.contains(points) & (angle > 45) & (angle < 135)
    np.testing.assert_array_equal(quarter.contains(points), expected)


def test_a_revolved_polygon_has_the_volume_of_pappus() -> None:
    # a triangle with area 6 and centroid at x = 3
    found, error = volume(rw.revolve([[2, 0], [5, 0], [2, 4]]))
    assert abs(found - 2 * math.pi * 3 * 6) <= error


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rw.extrude([], 1), "outline is empty: it must have at least one contour."),
        (lambda: rw.extrude([[0, 0, 0, 0]], 1), r"outline has shape \(1, 4\): it must be \(N, 2\), or \(N, 3\) with a bulge."),
        (lambda: rw.extrude([PLATE, [["a", 1]]], 1), r"outline\[1\] is not an array of numbers"),
        (lambda: rw.extrude(PLATE, 0), "height is 0: it must be greater than 0."),
        (lambda: rw.extrude(PLATE, 1, z=math.nan), "z is nan: it must be finite."),
        (lambda: rw.extrude(PLATE, 1, fillet=-1), "fillet is -1: it must be at least 0."),
        (lambda: rw.extrude(PLATE, 1, top_fillet=0.1, top_chamfer=0.1), "top_fillet and top_chamfer are both given"),
        (lambda: rw.extrude(PLATE, 1, fillet=21), "contour 0, point .*: a fillet or chamfer of 21 takes"),
        (lambda: rw.extrude([PLATE, [[50, 20], [70, 20], [60, 30]]], 1), "the outline crosses or touches itself"),
        (lambda: rw.extrude([[0, 0], [1, 1], [2, 2]], 1), "contour 0 has no area"),
        (lambda: rw.extrude([[0, 0], [math.inf, 1], [2, 2]], 1), "contour 0, point 1: coordinates must be finite"),
        (lambda: rw.revolve([[-1, 0], [1, 0], [0, 1]]), "contour 0 reaches x = -1"),
        (lambda: rw.revolve(PLATE, 361), "angle is 361: it must be greater than 0 and at most 360 degrees."),
        (lambda: rw.revolve(PLATE, start=math.inf), "start is inf: it must be finite."),
    ],
)
def test_invalid_outlines_name_the_reason(make, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_arguments_of_other_types_are_named() -> None:
    with pytest.raises(TypeError, match="height is 'a': it must be a number."):
        rw.extrude(PLATE, "a")
    with pytest.raises(TypeError, match="outline is 5: it must be an array of points, or a list of such arrays."):
        rw.extrude(5, 1)
    with pytest.raises(TypeError, match="Did you mean fillet?"):
        rw.extrude(PLATE, 1, filet=1)


def test_points_of_different_lengths_are_named():
    for outline in ([[0, 0], [1, 0], [1, 1, 0.5]], [[[0, 0], [1, 0], [1, 1, 0.5]]]):
        with pytest.raises(ValueError, match="point 2 has 3 numbers, point 0 has 2: all must have as many"):
            rw.extrude(outline, 1)
