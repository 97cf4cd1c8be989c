"""Parts of optical systems that are made in Python: that each can be used, and does what it says."""

import pytest
from rayweave import optics

D_NM = 587.5618


def test_a_beam_splitter_cube_halves_the_power() -> None:
    for share in (0.5, 0.25):
        system = optics.System(optics.beam_splitter_cube(2, reflectance=share, material=1.5))
        for start, way in (([0.1, 0.2, -5], [0, 0, 1]), ([0.1, 5, 0.2], [0, -1, 0])):
            trace = system.trace_rays(start, way, D_NM, branches="ideal", generation_limit=20)
            along = {}
            for axis in "yz":
                for sign in (1, -1):
                    out = (trace["event"] == 0) & (sign * trace[f"{axis}_tilt"] > 0.5)
                    along[sign, axis] = trace["intensity"][out].sum()
            # light that comes along +z is reflected to +y, light that comes along -y to -z
            through, turned = ((1, "z"), (1, "y")) if way[2] else ((-1, "y"), (-1, "z"))
            assert along[through] == pytest.approx(1 - share, abs=1e-12)
            assert along[turned] == pytest.approx(share, abs=1e-12)


def test_every_material_makes_a_part() -> None:
    for name in optics.glass_names():
        ball = optics.ball_lens(1, material=name)
        low, high = optics.glass(name).range_nm
        line = 0.5 * (low + high)
        trace = optics.System(ball).trace_rays([0, 0, -5], [0, 0, 1], line)
        assert abs(trace.balance.error) < 1e-12, name
    # transparent in the infrared alone, opaque, and a metal
    for name, line, segments in (("Si", 4000.0, 3), ("Ge", 8000.0, 3), ("Ag", 550.0, 2)):
        trace = optics.System(optics.ball_lens(1, material=name)).trace_rays([0, 0, -5], [0, 0, 1], line)
        assert trace.rows == segments, name


def test_prescriptions_of_the_infrared() -> None:
    pytest.importorskip("matplotlib").use("Agg")
    n = optics.glass("Ge").index(8000.0)
    surfaces = [optics.Surface(200.0, 3.0, "Ge"), optics.Surface(-200.0, 30.0)]
    lens = optics.Prescription(surfaces, entrance_pupil_diameter=10.0, wavelengths_nm=[8000.0])
    names = {part.name for part in lens.elements()}
    assert lens.system().element_names and names
    assert lens.first_order().focal_length == pytest.approx(optics.lensmaker(200, -200, n, 3), rel=1e-9)
    lens.show()
