"""Technical drawings, thickness by region, bounds of regions."""

import numpy as np
import pytest

import rayweave as rw


def test_thickness_by_region():
    parts = {"left": rw.box(1), "right": rw.box(2).translate([3, 0, 0])}
    found = rw.thickness(parts, view="right", size=(9, 9), by="region")
    assert found.media == ("world", "left", "right")
    assert found["left"].max() == pytest.approx(1) and found["right"].max() == pytest.approx(2)
    media = [rw.Region(name, part, medium="steel") for name, part in parts.items()]
    whole = rw.thickness(rw.Model(media), view="right", size=(9, 9))
    own = rw.thickness(rw.Model(media), view="right", size=(9, 9), by="region")
    assert own.lengths[..., 1:].sum(-1) == pytest.approx(whole["steel"])
    assert own.radiograph == pytest.approx(whole.radiograph)
    with pytest.raises(rw.RayweaveError, match="by is 'solid'"):
        rw.thickness(rw.box(1), by="solid")


def test_technical_drawings():
    plate = rw.box([60, 40, 8]) - rw.cylinder(3)
    drawing = rw.sheet(plate, dimensions=True, projection="first")
    assert ">\u23006 through</text>" in drawing.svg and "first-angle projection" in drawing.svg
    with pytest.raises(TypeError, match=r"cut is given with dimensions: .* Use section\(subject, "):
        rw.sheet(plate, dimensions=True, cut="x>0")
    with pytest.raises(rw.RayweaveError, match="third or first"):
        rw.sheet(plate, dimensions=True, projection="second")


def test_bounds_of_regions():
    ball = rw.sphere(5)
    found = rw.measure({"lens": ball & ball.translate([8, 0, 0]), "die": rw.box(2).translate([20, 0, 0])})
    assert found.bounds.shape == (2, 2, 3)
    assert found.bounds[0] == pytest.approx(np.array([[3, -3, -3], [5, 3, 3]]), abs=1e-8)
    assert found.bounds[1].tolist() == [[19, -1, -1], [21, 1, 1]]
