"""Tasks of lens designers: ghosts beside the image, drawings for the workshop, goals of transfer functions, ranges, summaries."""

import math
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray

import rayweave.optics as ro
from rayweave import RayweaveError

D_NM = 587.5618


def doublet(**options: Any) -> ro.Prescription:
    surfaces = [ro.Surface(61.4, 6.0, "N-BK7"), ro.Surface(-44.35, 2.5, "N-SF5"), ro.Surface(-129.6, 95.9)]
    return ro.Prescription(surfaces, entrance_pupil_diameter=20, fields=[0, 0.7, 1], **options)


def ghosts(lens: ro.Prescription) -> ro.Trace:
    origins, directions = lens.rays(0, wavelength_nm=D_NM, rings=10)
    return lens.system().trace_rays(origins, directions, D_NM, 1 / len(origins), branches="both", threshold=1e-9)


def reflected(trace: ro.Trace) -> NDArray[np.bool_]:
    """The rows that arrive at the image after reflections: the direct light has hit three surfaces."""
    return trace.at("image")["generation"] > 3


def test_ghosts_beside_the_image_are_counted() -> None:
    narrow, wide = ghosts(doublet()), ghosts(doublet(image_semi_diameter=600))
    beside = narrow.ghosts_beside("image")
    assert beside.rows > 500
    # a wider image catches exactly these, except a few that are nearly parallel to it
    missed = wide.ghosts_beside("image")
    assert missed.rows < 0.1 * beside.rows
    assert beside.rows + reflected(narrow).sum() == missed.rows + reflected(wide).sum()
    powers = [trace.at("image")["intensity"][reflected(trace)].sum() for trace in (narrow, wide)]
    assert beside["intensity"].sum() + powers[0] == pytest.approx(missed["intensity"].sum() + powers[1], rel=1e-12)
    found = narrow.paths()
    (note,) = found.notes
    assert note.startswith(f"{beside.rows} rays of ghosts with a power of") and "image_semi_diameter" in note
    assert str(found).endswith(note)
    with pytest.raises(RayweaveError, match="earlier rows are missing"):
        narrow.at("image").ghosts_beside("image")


def test_paths_name_the_surfaces_of_reflections() -> None:
    # rays near the axis
    trace = ghosts(doublet(image_semi_diameter=600).replace(entrance_pupil_diameter=2))
    direct = trace.paths()[0]
    assert direct.reflected_at == ()
    # the reflectances of the three surfaces for light along the axis
    n = [1.0, ro.Glass("N-BK7").index(D_NM), ro.Glass("N-SF5").index(D_NM), 1.0]
    r = [((a - b) / (a + b)) ** 2 for a, b in zip(n[:-1], n[1:], strict=True)]
    front, inner, back = "lens 1-2.front.side", ("lens 1-2.back.side", "lens 2-3.front.side"), "lens 2-3.back.side"
    for path in trace.paths():
        if len(path.reflected_at) != 2 or " image" not in path.text:
            continue
        at = [0 if name == front else 1 if name in inner else 2 for name in path.reflected_at]
        assert {name for name in path.reflected_at} <= {front, *inner, back}
        expected = direct.power * r[at[0]] * r[at[1]] * (path.rays / direct.rays)
        # light passes each surface between the reflections three times instead of once
        between = math.prod((1 - r[k]) ** 2 for k in range(at[1] + 1, at[0]))
        assert path.power == pytest.approx(expected * between, rel=0.02)


def test_the_image_of_a_prescription_has_a_place() -> None:
    image = doublet().elements()[-1]
    assert image.name == "image" and image.place[:3, 3].tolist() == pytest.approx([0, 0, 6 + 2.5 + 95.9])


def test_drawings_of_ghosts_show_a_few_rays() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    trace = ghosts(doublet())
    shown = trace.show()
    lines = max((collection for collection in shown.collections), key=lambda own: own.get_zorder())
    assert 20 < len(lines.get_paths()) <= 1500
    # rays in the plane of the picture represent all
    plane = np.isin(trace["id"], np.unique(trace["id"][np.abs(trace["x0"]) > 1e-9]))
    assert len(lines.get_paths()) <= (~plane).sum()
    every = trace.show(rays=len(np.unique(trace["id"])))
    assert len(max(every.collections, key=lambda own: own.get_zorder()).get_paths()) > 5000


def test_drawings_have_indications_and_cemented_groups() -> None:
    lens = doublet()
    one = lens.drawing(1, indications={"left 3/": "2(0.5)", "diameter": "+0/-0.05", "0/": "10"}).svg
    assert ">3/ 2(0.5)<" in one and "+0/-0.05<" in one and ">0/ 10<" in one
    both = lens.drawing((1, 2), title="objective", indications={"cement": "NOA 61"}).svg
    # the overall thickness, all radii and both glasses
    for text in (">8.5<", "R1: R 61.4 CX", "R2: R 44.35 CC", "R3: R 129.6 CX", "N-BK7", "N-SF5", "Cement NOA 61", ">objective<"):
        assert text in both, text
    with pytest.raises(RayweaveError, match="there is no field \"left 9/\" on this drawing: its fields are thickness,"):
        lens.drawing(1, indications={"left 9/": "x"})
    with pytest.raises(RayweaveError, match="there is no lens 3"):
        lens.drawing((1, 3))
    apart = ro.Prescription([*lens.surfaces, ro.Surface(50, 4, "N-BK7"), ro.Surface(-50, 40)], entrance_pupil_diameter=10)
    with pytest.raises(RayweaveError, match="lens 2-3 and lens 4-5 are not cemented"):
        apart.drawing((2, 3))
    with pytest.raises(TypeError, match="lens is"):
        lens.drawing((1, 2, 3))  # type: ignore[arg-type]


def test_transfer_functions_are_goals_and_merits() -> None:
    lens = doublet(wavelengths_nm=[486.1, 587.6, 656.3], primary=1)
    frequency = 40.0
    diffraction, geometric = (ask([frequency]) for ask in (lens.diffraction_mtf, lens.geometric_mtf))
    names: tuple[Literal["diffraction mtf", "geometric mtf"], ...] = ("diffraction mtf", "geometric mtf")
    for name, found, tolerance in zip(names, (diffraction, geometric), (4e-3, 2e-3), strict=True):
        values = []
        for field in range(3):
            goals = [ro.goal(name, 1.0, field=field, frequency=frequency, lines=lines) for lines in ("tangential", "sagittal")]
            table = ro.optimise(lens, ["thickness 3"], goals, rings=12, patience=1).goals
            expected = [found.of_field(field, lines)[0] for lines in ("tangential", "sagittal")]
            assert table["value_before"] == pytest.approx(expected, abs=tolerance)
            assert table["goal"][1] == f"{name}, field {field}, 40, sagittal"
            values += expected
        merit = ro.tolerance(lens, {"thickness 3": 0.05}, (name, frequency), trials=5, rings=12)
        assert merit.nominal == pytest.approx(np.mean(values), abs=tolerance)
        assert merit.units["merit"] == "" and (merit["merit"] < 1).all()
    with pytest.raises(RayweaveError, match="the goal 'diffraction mtf' lacks frequency and lines"):
        ro.goal("diffraction mtf", field=0)
    with pytest.raises(RayweaveError, match="lines is 'radial'"):
        ro.goal("diffraction mtf", field=0, frequency=10, lines="radial")  # type: ignore[arg-type]
    with pytest.raises(RayweaveError, match=r"merit is \('mtf', 40\)"):
        ro.tolerance(lens, {"thickness 3": 0.05}, ("mtf", 40), trials=1)  # type: ignore[arg-type]
    with pytest.raises(RayweaveError, match="Did you mean 'diffraction mtf'"):
        ro.goal("mtf", field=0)


def test_vignetting_is_a_goal_and_a_merit() -> None:
    # a ring 20 in front of the stop
    front = ro.Surface(thickness=20, semi_diameter=7)
    lens = ro.Prescription(
        [front, ro.Surface(thickness=5, behind=1.5), ro.Surface(-60, 100)], entrance_pupil_diameter=10, fields=[0, 8], stop=2
    )
    goals = [ro.goal("clearance", at_least=0, field=field) for field in (0, 1)]
    with pytest.warns(UserWarning, match="clearance, field 1 is -0.8"):
        found = ro.optimise(lens, ["curvature 3"], goals, patience=1)
    height = 20 * math.tan(math.radians(8))
    assert found.goals["value_before"] == pytest.approx([2.0, 2.0 - height], abs=1e-9)
    # the part of a disk of radius 5 within a disk of radius 7 whose centre is `height` away
    grid = ro.pupil_grid("square", 801) * 5
    expected = (1 + (np.hypot(grid[:, 0], grid[:, 1] - height) < 7).mean()) / 2
    trials = ro.tolerance(lens, {"conic 3": 0.0}, "transmitted", trials=1, rings=40, mirror_fields=False)
    assert trials.nominal == pytest.approx(expected, abs=3e-3)


def test_goals_have_ranges() -> None:
    lens = ro.Prescription([ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)], entrance_pupil_diameter=10)
    bounds = ro.goal("thickness 1", at_least=2, at_most=4, weight=1000)
    assert (bounds.target, bounds.value, bounds.upper) == ("range", 2, 4)
    for wanted, expected in ((9, 4), (0.5, 2), (3, 3)):
        best = ro.optimise(lens, ["thickness 1"], [ro.goal("thickness 1", wanted), bounds])
        assert best.values["thickness 1"] == pytest.approx(expected, abs=1e-4)
    assert best.goals["wanted_to"][1] == 4 and math.isnan(best.goals["wanted_to"][0])
    weak = ro.goal("thickness 1", at_least=2, at_most=4)
    with pytest.warns(UserWarning, match="thickness 1 is 6.5 "):
        ro.optimise(lens, ["thickness 1"], [ro.goal("thickness 1", 9), weak])
    with pytest.raises(RayweaveError, match="at_least 4 above at_most 2: exchange them"):
        ro.goal("thickness 1", at_least=4, at_most=2)


def test_results_print_summaries() -> None:
    lens = ro.Prescription([ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)], entrance_pupil_diameter=10)
    best = ro.optimise(lens, ["curvature 2"], [ro.goal("focal length", 60)])
    lines = str(best).splitlines()
    assert lines[0].startswith("merit 10.787 -> ") and any(line.startswith("curvature 2") for line in lines)
    assert any(line.split()[:2] == ["goal", "target"] for line in lines) and "wanted_to" not in str(best)
    trials = ro.tolerance(lens, {"thickness 1": 0.1}, "focal length", trials=200)
    rows = [line.rsplit(maxsplit=1) for line in str(trials).splitlines()]
    assert str(trials).startswith("200 trials, merit in mm")
    quantiles = {name.strip(): float(value) for name, value in rows[1:]}
    assert quantiles["90 % of the trials up to"] == pytest.approx(trials.quantile(0.9), rel=1e-5)
    assert quantiles["without errors"] == pytest.approx(trials.nominal, rel=1e-5)


def test_targets_of_spots_are_radii() -> None:
    lens = doublet()
    start = ro.optimise(lens, ["thickness 3"], [ro.goal("spot", field=1)], patience=1)
    radius = float(start.goals["value_before"][0])
    assert radius == pytest.approx(lens.spots()["rms"][1], rel=1e-4)
    goals = [
        ro.goal("spot", 0.5 * radius, field=1),
        ro.goal("spot", at_most=2 * radius, field=1),
        ro.goal("spot", at_most=0.8 * radius, field=1, weight=3),
        ro.goal("spot", field=1),
    ]
    table = ro.optimise(lens, ["thickness 3"], goals, patience=1).goals
    assert table["value_before"] == pytest.approx(radius)
    expected = np.square([0.5 * radius, 0.0, 3 * 0.2 * radius, radius])
    assert table["contribution_before"] == pytest.approx(expected, rel=1e-9, abs=1e-20)


def test_vignetted_fields_of_goals_are_stated() -> None:
    lens = doublet().with_surface(1, semi_diameter=8)
    best = ro.optimise(lens, ["thickness 3"], [ro.goal("spot", field=0)], rings=30)
    # a circle of 8 of one of 10
    assert best.vignetted == {0: pytest.approx(1 - 0.64, abs=0.02)}
    assert "field 0 is vignetted: 3" in str(best)
    assert ro.optimise(lens, ["thickness 3"], [ro.goal("focal length", 101)]).vignetted == {}


def test_mechanical_semi_diameters_widen_lenses(tmp_path: Any) -> None:
    lens = doublet()
    wide = lens.with_surface(1, mechanical_semi_diameter=14).with_surface(2, mechanical_semi_diameter=14)
    assert wide.surfaces[0].mechanical_semi_diameter == 14 and lens.surfaces[0].mechanical_semi_diameter is None
    wide.write_zmx(tmp_path / "wide.zmx")
    back = ro.Prescription.read_zmx(tmp_path / "wide.zmx")
    assert back.surfaces[1].mechanical_semi_diameter == 14
    assert "mechanical semi-diameter 14" in str(back)
    assert wide.spots()["rms"] == pytest.approx(lens.spots()["rms"], rel=1e-12)
    high = [elements[0].body.bounds[1][1] for elements in (wide.elements(), lens.elements())]
    assert high[0] == pytest.approx(14) and high[1] < 11


def test_spreads_have_two_ends() -> None:
    mirror = ro.Prescription([ro.Surface(-200, -100, "mirror")], entrance_pupil_diameter=10)
    found = ro.tolerance(mirror, {"radius 1": (-0.1, 0.5)}, "focal length", trials=200)
    assert found["radius 1"].min() >= -0.1 and 0.4 < found["radius 1"].max() <= 0.5
    assert found.sensitivities["spread"].tolist() == [0.5]
    assert found.sensitivities["change"] == pytest.approx([0.25])
    assert found.sensitivities.show().get_xlabel() == "change of the merit, um"
    with pytest.raises(RayweaveError, match="the upper end of the spread of radius 1 is 0.1: it has to be at least the lower end"):
        ro.tolerance(mirror, {"radius 1": (0.2, 0.1)}, trials=1)


def test_words_of_other_programs_have_hints() -> None:
    with pytest.raises(AttributeError, match="write optimise"):
        getattr(ro, "optimize")  # noqa: B009
    with pytest.raises(AttributeError, match="did you mean tolerance"):
        getattr(ro, "tolerence")  # noqa: B009
    assert not hasattr(ro, "optimize")
    with pytest.raises(RayweaveError, match="Did you mean `decentre y 1-2`"):
        ro.tolerance(doublet(), {"decenter y 1-2": 0.1}, trials=1)
    with pytest.raises(RayweaveError, match=r"is a Zemax lens file: .* Read it with Prescription.read_zmx"):
        ro.load("lens.zmx")
    with pytest.raises(RayweaveError, match="frequencies has a number that is not finite"):
        doublet().diffraction_mtf(math.nan)
    with pytest.raises(RayweaveError, match=r"stop is 0: it must be at least 1\.$"):
        doublet(stop=0)
