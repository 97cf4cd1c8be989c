"""Regions of the plane and the traces that fill them, compared with closed forms."""

import copy
import pickle

import numpy as np
import pytest

import rayweave
from rayweave import RayweaveError

SQUARE = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], float)
HOLE = [[3, 3], [3, 7], [7, 7], [7, 3]]


def lengths(traces):
    return np.hypot(traces["x1"] - traces["x0"], traces["y1"] - traces["y0"])


def test_a_region_has_its_area():
    frame = rayweave.from_polygons([SQUARE, HOLE, [[20.0, 20.0]], []])
    assert (frame.area, frame.outside, len(frame.contours)) == (84.0, 1, 2)
    assert np.array_equal(frame.contours[1], HOLE)
    traces = rayweave.infill(frame, 1, phase=0.5)
    assert traces.dtype.names == ("layer", "z", "scanline", "component", "x0", "y0", "x1", "y1")
    assert lengths(traces).sum() == 84.0
    assert set(traces["component"]) == {0} and set(traces["layer"]) == {0}
    assert list(traces["scanline"][:2]) == [0, 1] and traces["y0"][0] == 0.5
    ray = frame.trace([-5, 5], (2, 0))
    assert ray.roots == [2.5, 4.0, 6.0, 7.5] and not ray.starts_inside


def test_a_region_is_a_value():
    frame = rayweave.from_polygons([SQUARE, HOLE])
    again = pickle.loads(pickle.dumps(frame))
    assert again == frame and hash(again) == hash(frame) and copy.deepcopy(frame) == frame
    assert frame != rayweave.from_polygons([SQUARE])
    assert repr(frame) == "<Polygons of 2 contours, 8 edges>"
    void = rayweave.from_polygons([HOLE], outside=-1)
    assert void.outside == -1 and void.area == np.inf and void.trace([0, 5], [1, 0]).starts_inside


def test_a_prism_is_filled_like_its_base():
    frame = rayweave.from_polygons([SQUARE, HOLE])
    solid = frame.extrude(-1, 1)
    assert solid.contains([[1, 1, 0], [5, 5, 0], [1, 1, 2]]).tolist() == [True, False, False]
    plane = rayweave.infill(frame, 0.3, 20, 0.1)
    space = rayweave.infill(solid, 0.3, 20, 0.1, layers=[0.0], evaluator="reference", threads=2)
    assert np.array_equal(plane["scanline"], space["scanline"])
    for name in ("x0", "y0", "x1", "y1"):
        assert np.allclose(plane[name], space[name], rtol=0, atol=1e-12)


def test_a_ball_by_layers_has_its_volume():
    ball = rayweave.sphere(3)
    traces = rayweave.infill(ball, 0.05, layer_height=0.1, phase=0.5, turn=90, alternate=True)
    assert sorted(set(traces["layer"])) == list(range(60))
    # the variation of the area times the height, and that of the chords times the spacing
    bound = 0.1 * 18 * np.pi + 6 * 12 * 0.05
    assert abs(0.05 * 0.1 * lengths(traces).sum() - 36 * np.pi) < bound
    first = traces[traces["layer"] == 32]
    odd = first["scanline"] % 2 != 0
    assert np.all((first["x1"] < first["x0"]) == odd)


def test_what_is_wrong_is_said():
    frame = rayweave.from_polygons([SQUARE])
    for spacing in (0, -1, np.nan):
        with pytest.raises(RayweaveError, match="the spacing is"):
            rayweave.infill(frame, spacing)
    with pytest.raises(RayweaveError, match="one layer"):
        rayweave.infill(frame, 1, layers=[1])
    with pytest.raises(RayweaveError, match="layers or layer_height must be given, but not both"):
        rayweave.infill(rayweave.sphere(1), 1)
    with pytest.raises(RayweaveError, match="unbounded in x and y"):
        rayweave.infill(rayweave.universe(), 1, layers=[0])
    with pytest.raises(RayweaveError, match="is empty"):
        rayweave.infill(rayweave.empty(), 1, layers=[0])
    with pytest.raises(TypeError, match="Solid, a Model or Polygons"):
        rayweave.infill("ball", 1, layers=[0])
    with pytest.raises(RayweaveError, match="evaluator"):
        rayweave.infill(rayweave.sphere(1), 1, layers=[0], evaluator="none")
    with pytest.raises(RayweaveError, match="contour 0 is clockwise"):
        rayweave.from_polygons([SQUARE[::-1]])
    with pytest.raises(RayweaveError, match="contour 0, edge from vertex 1 to vertex 2 crosses"):
        rayweave.from_polygons([SQUARE[[0, 1, 3, 2]]])
    with pytest.raises(RayweaveError, match="contour 0, vertex 1: x is NaN"):
        rayweave.from_polygons([[[0, 0], [np.nan, 0], [1, 1]]])
    with pytest.raises(RayweaveError, match=r"contours\[0\] has shape \(4, 3\)"):
        rayweave.from_polygons([np.zeros((4, 3))])
    with pytest.raises(RayweaveError, match="it must be \\+1 or -1"):
        rayweave.from_polygons([SQUARE], outside=0)
    with pytest.raises(TypeError):
        rayweave.from_polygons(3)
