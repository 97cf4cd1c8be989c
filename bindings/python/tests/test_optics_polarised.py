"""Polarised light: computed where it matters, and invalid states are rejected."""

import math
from pathlib import Path

import numpy as np
import pytest
from rayweave import RayweaveError, optics

D_NM = 587.5618
START, WAY = [0, 0, -5], [0, 0, 1]


def behind(system: optics.System, stokes: object, **settings: object) -> float:
    return system.trace_rays(START, WAY, D_NM, stokes=stokes, **settings).balance.escaped  # type: ignore[arg-type]


def test_stokes_vectors_are_checked_ray_by_ray() -> None:
    system = optics.System(optics.polariser(0, aperture=10))
    good = [1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]
    for k, value in ((0, math.nan), (0, -1.0), (0, 0.0), (0, math.inf), (2, 0.5), (3, math.nan), (1, 1.5)):
        bad = list(good)
        bad[k] = value
        with pytest.raises(RayweaveError, match=r"stokes\[1\] is .*i > 0 and q\^2"):
            system.trace_rays([START] * 3, WAY, D_NM, stokes=[good, bad, good])
    for axis in ([0, 0, 0], [0, 0, 2], [math.nan, 0, 0], [math.inf, 0, 0]):
        with pytest.raises(RayweaveError, match=r"stokes\[0\] is .*the axis of q > 0"):
            behind(system, [[1, 1, 0, 0, *axis]])
    with pytest.raises(TypeError, match="stokes is 'x'"):
        behind(system, "x")


def test_axes_of_stokes_vectors_need_not_be_normalised_or_perpendicular() -> None:
    system = optics.System(optics.polariser(30, aperture=10))
    expected = math.cos(math.radians(30)) ** 2
    for axis in ([1, 0, 0], [7, 0, 0], [1e-200, 0, 0], [1, 0, 5]):
        assert behind(system, [[3, 3, 0, 0, *axis]]) == pytest.approx(expected, abs=1e-12)


def crossed() -> optics.System:
    second = optics.polariser(90, aperture=10, name="second").translate([0, 0, 2])
    return optics.System([optics.polariser(0, aperture=10), second])


def test_polarisation_is_computed_if_an_element_affects_it(tmp_path: Path) -> None:
    system, light = crossed(), optics.beam(1, 10).translate([0, 0, -5])
    assert system.trace(light).balance.escaped == pytest.approx(0.0, abs=1e-15)
    assert system.trace(light, polarised=True).balance.escaped == pytest.approx(0.0, abs=1e-15)
    assert system.trace(light, polarised=False).balance.escaped == pytest.approx(0.25)
    with system.stream(light) as stream:
        list(stream)
        assert stream.balance.escaped == pytest.approx(0.0, abs=1e-15)
    assert system.trace_to(tmp_path / "rows.csv", light).escaped == pytest.approx(0.0, abs=1e-15)
    assert system.trace_rays(START, WAY, D_NM).balance.escaped == pytest.approx(0.0, abs=1e-15)
    # a quarter-wave plate at 45 degrees between them
    plate = optics.wave_plate(90, 45, aperture=10).translate([0, 0, 1])
    assert optics.System([*system.elements, plate]).trace(light).balance.escaped == pytest.approx(0.25)


def test_polarisation_is_computed_if_a_source_is_polarised() -> None:
    """At Brewster's angle, light polarised in the plane of incidence is transmitted completely; unpolarised light is
    not."""
    angle = math.degrees(math.atan(1.5))
    plate = optics.element(optics.lens(math.inf, math.inf, 1, aperture=50).body, 1.5, name="plate").rotate_y(angle)  # type: ignore[arg-type]
    system, light = optics.System(plate), optics.beam(1, 10).translate([0, 0, -50])

    def through(source: optics.Source, polarised: bool | None = None) -> float:
        trace = system.trace(source, branches="both", generation_limit=3, polarised=polarised)
        return float(trace["intensity"][(trace["event"] == 0) & (trace["z_tilt"] > 0.9)].sum())

    in_plane = light.polarised(2, 2, 0, 0)
    assert through(in_plane) == pytest.approx(1.0, abs=1e-9)
    assert through(in_plane.translate([0, 0, 1]), True) == pytest.approx(1.0, abs=1e-9)
    assert through(in_plane, False) < 0.95 and through(light) < 0.95
    rays = system.trace_rays([0, 0, -50], WAY, 633.0, stokes=[1, 1, 0, 0, 1, 0, 0], branches="both", generation_limit=3)
    assert rays["intensity"][(rays["event"] == 0)].max() == pytest.approx(1.0, abs=1e-9)
    assert light.is_polarised is False and in_plane.is_polarised and in_plane.translate([0, 0, 1]).is_polarised
    np.testing.assert_array_equal(len(in_plane), len(light))
