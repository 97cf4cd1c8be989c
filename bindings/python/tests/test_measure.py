"""Volumes, masses and moments, compared with closed forms."""

import numpy as np
import pytest

import rayweave
from rayweave import RayweaveError


def holds(value, half_width, expected):
    return np.all(np.abs(value - expected) <= half_width + 1e-9 * np.abs(expected))


def test_a_ball():
    found = rayweave.measure(rayweave.sphere(2).translate([5, 0, -1]))
    volume, area = 32 / 3 * np.pi, 16 * np.pi
    assert found.regions == ("solid",) and found.is_reached.all() and found.rays[0] > 1000
    assert holds(found.volume, found.volume_half_width, volume) and found.volume_half_width[0] < 1e-3 * volume
    assert found.volume_by_formula[0] == pytest.approx(volume, rel=1e-15)
    assert holds(found.area, found.area_half_width, area)
    assert found.centre.shape == (1, 3) and holds(found.centre[0], found.centre_half_width[0], [5, 0, -1])
    tensor = 0.4 * volume * 4 * np.eye(3)
    assert holds(found.inertia[0], found.inertia_half_width[0], tensor)
    assert np.isnan(found.mass[0])
    assert "solid 33.5" in repr(found)


def test_regions_with_a_density():
    model = rayweave.loads(
        'rayweave = 1\nunit = "cm"\n[solid.block]\nbox = { size = 2 }\n[solid.ball]\nsphere = { radius = 0.5 }\n'
        '[[region]]\nsolid = "block"\nmedium = "glass"\n[[region]]\nsolid = "ball"\nmedium = "air"\n'
        "[medium.glass]\ndensity = 2.5\n[medium.air]"
    )
    found = rayweave.measure(model, precision=3e-3)
    ball = np.pi / 6
    assert found.regions == ("block", "ball") and found.media == ("glass", "air")
    assert holds(found.volume, found.volume_half_width, [8 - ball, ball])
    assert holds(found.mass[0], found.mass_half_width[0], 2.5 * (8 - ball)) and np.isnan(found.mass[1])


def test_within_a_box():
    below = rayweave.half_space([0, 0, 1], 0)
    with pytest.raises(RayweaveError, match="Intersect it with a box, or measure the part within one"):
        rayweave.measure(below)
    found = rayweave.measure(below, within=[[0, 0, -1], [2, 3, 5]])
    assert found.volume[0] == pytest.approx(6, rel=1e-12)


def test_refusals():
    ball = rayweave.sphere(1)
    with pytest.raises(RayweaveError, match="the precision is -1"):
        rayweave.measure(ball, precision=-1)
    with pytest.raises(RayweaveError, match="the confidence is 2"):
        rayweave.measure(ball, confidence=2)
    with pytest.raises(RayweaveError, match=r"within has shape \(3,\)"):
        rayweave.measure(ball, within=[1, 2, 3])
    with pytest.raises(TypeError, match="it must be a Solid, a Model, or a list"):
        rayweave.measure("ball")
