"""Parts of optical systems created in Python: each can be used and behaves as documented."""

from importlib.metadata import version

import pytest
import rayweave
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


def test_penta_prisms_need_mirrors() -> None:
    """As documented: without the finish light passes through, with it light is deflected by 90 degrees."""
    plain = optics.prism("penta", 10, 10)
    finished = plain.with_finish(optics.reflecting(), "mirror1").with_finish(optics.reflecting(), "mirror2")
    for part, turned in ((plain, False), (finished, True)):
        trace = optics.System(part).trace_rays([0.3, 0.2, -20], [0, 0, 1], D_NM)
        assert bool((trace["y_tilt"][trace["event"] == 0] < -0.999).all()) == turned


def faces(*parts: optics.Element) -> list[set[str]]:
    names = [name.split(".") for name in optics.System(parts).surface_names]
    return [{name[1] for name in names if name[0] == part.name} - {"left", "right", "hull"} for part in parts]


def test_faces_have_the_documented_names() -> None:
    lens, aperture = {"front", "back", "edge"}, 10.0
    parts = {
        "lens": optics.lens(50, -50, 5, aperture=aperture),
        "mirror": optics.spherical_mirror(-50, 3, aperture=aperture),
        "array": optics.lenslet_array(20, 3, 4, 2, 2),
        "axicon": optics.axicon(10, 5, 5),
    }
    for name, part in parts.items():
        assert faces(part) == [lens], name
    assert faces(optics.fresnel_lens(50, 2, 2, 20)) == [lens | {"draft"}]
    assert faces(optics.ball_lens(1)) == [{"ball"}]
    assert faces(*optics.cemented([60, -40, -150], [6, 3], [1.5, 1.6], aperture=20)) == [lens, lens]
    split = faces(*optics.beam_splitter_cube(2))
    assert split == [{"front", "exit", "split"}, {"back", "bottom", "split"}]
    assert faces(optics.prism("dispersing", 60, 5, 5)) == [{"front", "back", "base"}]
    assert faces(optics.equilateral_prism(5, 5)) == [{"front", "back", "base"}]
    assert faces(optics.prism("right_angle", 5, 5)) == [{"front", "exit", "hypotenuse"}]
    assert faces(optics.prism("penta", 5, 5)) == [{"front", "exit", "mirror1", "mirror2", "roof"}]
    assert faces(optics.prism("dove", 5, 20, 5)) == [{"front", "back", "base", "top"}]
    assert faces(optics.prism("amici", 5)) == [{"front", "exit", "roof1", "roof2"}]
    assert faces(optics.corner_cube(5)) == [{"front", "mirror1", "mirror2", "mirror3"}]


def test_finishes_of_faces_that_touch() -> None:
    """The finish of the element that light enters applies or, if that is polished, that of the element it leaves."""
    first, second = (part.with_finish(optics.polished(), "split") for part in optics.beam_splitter_cube(2, material=1.5))
    mirror, black = optics.reflecting(), optics.black()

    def escaped(one: optics.Element, other: optics.Element) -> float:
        return optics.System([one, other]).trace_rays([0.1, 0.2, -5], [0, 0, 1], D_NM).balance.escaped

    assert escaped(first, second) == 1.0
    assert escaped(first.with_finish(black, "split"), second) == 0.0
    assert escaped(first, second.with_finish(black, "split")) == 0.0
    assert escaped(first.with_finish(black, "split"), second.with_finish(mirror, "split")) == 1.0
    assert escaped(first.with_finish(mirror, "split"), second.with_finish(black, "split")) == 0.0


def test_optimisation_states_why_it_ended() -> None:
    surfaces = [optics.Surface(50, 5, "N-BK7"), optics.Surface(-50, 45)]
    lens = optics.Prescription(surfaces, entrance_pupil_diameter=10.0)
    goals = [optics.goal("focal length", 60.0)]
    found = optics.optimise(lens, ["curvature 1"], goals)
    assert found.has_converged and not set(found.reason) & set("{}_:()"), found.reason
    short = optics.optimise(lens, ["curvature 1", "curvature 2"], [*goals, optics.goal("spherical", 5.0)], patience=1)
    assert short.has_converged or "patience" in short.reason, short.reason


def test_the_package_has_a_version() -> None:
    assert rayweave.__version__ == version("rayweave")
