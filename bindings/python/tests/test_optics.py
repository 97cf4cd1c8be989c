"""Light through lenses and mirrors, compared with closed forms."""

import csv
import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from rayweave import RayweaveError, box, optics, sphere
from rayweave import _core as core

D_NM = 587.5618


def focus(trace: optics.Trace) -> NDArray[np.float64]:
    """The points where the last segments of rays cross the axis."""
    last = trace.columns["event"] == 0
    x, z = trace["x0"][last], trace["z0"][last]
    crossings: NDArray[np.float64] = z - x * trace["z_tilt"][last] / trace["x_tilt"][last]
    return crossings


def near_axis(system: optics.System, height: float = 1e-3) -> float:
    return float(focus(system.trace_rays([height, 0, -100], [0, 0, 1], D_NM))[0])


def test_glasses() -> None:
    crown = optics.glass("N-BK7")
    # Schott's data sheet: n_d = 1.51680, n_F = 1.52238, n_C = 1.51432, V_d = 64.17
    expected = [1.51680, 1.52238, 1.51432]
    np.testing.assert_allclose(crown.index([D_NM, 486.1327, 656.2725]), expected, atol=5e-6)
    assert crown.abbe_number() == pytest.approx(64.17, abs=0.005)
    assert isinstance(crown.index(500.0), float) and crown == optics.glass("n bk7")
    terms = [1.03961212, 0.231792344, 1.01046945], [0.00600069867, 0.0200179144, 103.560653]
    own = optics.Glass.sellmeier("own", *terms)
    assert own.index(600.0) == pytest.approx(crown.index(600.0), abs=1e-12)
    with pytest.raises(RayweaveError, match="N-BK7"):
        optics.glass("BK7")
    with pytest.raises(RayweaveError, match="300 nm to 2500 nm"):
        crown.index([500.0, 200.0])


def test_thick_lenses_focus_according_to_the_lensmakers_equation() -> None:
    r1, r2, d, n = 60.0, -80.0, 6.0, 1.5
    system = optics.System([optics.lens(r1, r2, d, aperture=30, material=n)])
    f = optics.lensmaker(r1, r2, n, d)
    assert 1 / f == pytest.approx((n - 1) * (1 / r1 - 1 / r2 + (n - 1) * d / (n * r1 * r2)))
    # the back focal distance f (1 - (n - 1) d / (n r1)) is counted from the back vertex
    back = f * (1 - (n - 1) * d / (n * r1))
    first = float(system.trace_rays([0, 0, -100], [0, 0, 1], D_NM).at("lens")["z1"][0])
    assert near_axis(system) == pytest.approx(first + d + back, abs=1e-6)


def test_components_are_where_they_should_be() -> None:
    mirror = optics.parabolic_mirror(50.0, 5.0, aperture=20).translate([0, 0, 100])
    screen = optics.detector(4.0, name="focus").translate([0, 0, 50])
    ring = optics.circle_of_rays(12.0, 64).translate([0, 0, -5])
    hits = optics.System([mirror, screen]).trace(ring).at("focus")
    assert hits.rows == 64
    np.testing.assert_allclose(hits.points(), np.tile([0, 0, 50], (64, 1)), atol=1e-12)
    # 105 to the mirror at z = 100 - r^2 / 200, and back: all paths are equal
    np.testing.assert_allclose(hits["path"], 155.0, atol=1e-11)


def test_conic_mirrors_image_one_focus_onto_the_other() -> None:
    mirror = optics.elliptic_mirror(30, 50, 3, aperture=20)
    target = optics.detector(1e-9, name="far").translate([0, 0, -50])
    cone = optics.cone_of_rays(15, 32).translate([0, 0, -30])
    assert optics.System([mirror, target]).trace(cone).at("far").rows == 32
    secondary = optics.hyperbolic_mirror(20, 60, 3, aperture=20)
    back = optics.detector(1e-9, name="back").translate([0, 0, -60])
    angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    origins = np.stack([8 * np.cos(angle), 8 * np.sin(angle), np.full(16, -15.0)], axis=1)
    system = optics.System([secondary, back])
    assert system.trace_rays(origins, np.array([0, 0, 20.0]) - origins, D_NM).at("back").rows == 16


def test_lenslets_and_fresnel_lenses_focus() -> None:
    array = optics.lenslet_array(20, 3, 4, 3, 3, material=1.5)
    origins = np.array([[x + 1e-3, y, -20.0] for x in (-4, 0, 4) for y in (-4, 0, 4)])
    trace = optics.System([array]).trace_rays(origins, [0, 0, 1], D_NM)
    last = trace["event"] == 0
    x, tilt = trace["x0"][last] - np.round(trace["x0"][last] / 4) * 4, trace["x_tilt"][last]
    # the focal length of a plano-convex lens is r / (n - 1)
    np.testing.assert_allclose(-x / tilt, 40.0, rtol=1e-6)
    fresnel = optics.System([optics.fresnel_lens(50, 1, 2, 40, material=1.5)])
    rays = fresnel.trace_rays([[0.01, 0, -10], [10.4, 0, -10]], [0, 0, 1], D_NM)
    last = rays["event"] == 0
    slopes = rays["x_tilt"][last] / rays["z_tilt"][last]
    heights = np.array([0.01, 10.4])
    # refraction at the slope of the sphere, regardless of the steps
    tilt = np.arcsin(heights / 50)
    np.testing.assert_allclose(slopes, -np.tan(np.arcsin(1.5 * np.sin(tilt)) - tilt), rtol=1e-9)


def test_a_cemented_doublet_has_no_gap() -> None:
    pair = optics.cemented([60, -40, -150], [6, 3], [1.5168, 1.62], aperture=20)
    system = optics.System(pair, world=1.333)
    trace = system.trace(optics.beam(18.0, 5000).translate([0, 0, -20]))
    order = np.lexsort((trace["generation"], trace["id"]))
    np.testing.assert_array_equal(trace["index"][order].reshape(-1, 4), [[1.333, 1.5168, 1.62, 1.333]] * 5000)


def test_power_is_shared_by_fresnel() -> None:
    plate = optics.element(sphere(10.0), 1.5, name="ball").with_finish(optics.polished())
    system = optics.System([plate])
    trace = system.trace_rays([0, 0, -20], [0, 0, 1], D_NM, branches="both", threshold=1e-12)
    reflected = 0.04
    out = trace["intensity"][(trace["event"] == 0) & (trace["z_tilt"] > 0)]
    assert out.sum() == pytest.approx((1 - reflected) / (1 + reflected), abs=1e-10)
    assert abs(trace.balance.error) < 1e-12 and trace.balance.emitted == 1.0


def test_coatings_and_metals() -> None:
    film = optics.coated((1.38, D_NM / 4 / 1.38))
    # as in model files
    assert optics.coated([[1.38, 0, D_NM / 4 / 1.38]]) == film == optics.coated((1.38, 0, D_NM / 4 / 1.38))
    assert optics.coated([(1.38, 100.0), (2.1, 60.0)]) == optics.coated((1.38, 100.0), (2.1, 60.0))
    coated = optics.element(sphere(10.0), 1.52, name="ball").with_finish(film, "side")
    rows = optics.System([coated]).trace_rays([0, 0, -20], [0, 0, 1], D_NM, branches="both", generation_limit=1)
    share = 1 - ((1.52 - 1.38**2) / (1.52 + 1.38**2)) ** 2
    # both branches end at the limit: their power is dropped
    assert rows.balance.dropped == pytest.approx(1.0, abs=1e-14)
    split = optics.System([coated]).trace_rays([0, 0, -20], [0, 0, 1], D_NM, branches="both", generation_limit=2)
    inside = split["intensity"][(split["generation"] == 1) & (split["z_tilt"] > 0)]
    assert inside == pytest.approx([share], abs=1e-12)
    silver = optics.element(sphere(10.0), 0.13 + 3.6j, name="silver")
    found = optics.System([silver]).trace_rays([0, 0, -20], [0, 0, 1], D_NM).balance
    assert found.escaped == pytest.approx(abs((0.13 + 3.6j - 1) / (0.13 + 3.6j + 1)) ** 2, abs=1e-12)


def test_polarisers_obey_malus() -> None:
    first, second = optics.polariser(0, aperture=10), optics.polariser(30, aperture=10, name="second")
    system = optics.System([first, second.translate([0, 0, 5])])
    found = system.trace_rays([0, 0, -5], [0, 0, 1], D_NM, polarised=True).balance
    assert found.escaped == pytest.approx(0.5 * math.cos(math.radians(30)) ** 2, abs=1e-14)


def test_results_do_not_depend_on_threads_and_repeat() -> None:
    system = optics.System([optics.ball_lens(10).with_finish(optics.rough(0.1))])
    lamp = optics.lamp(2, 2, 6000, seed=7).translate([0, 0, -10])
    one = system.trace(lamp, branches="random", threads=1)
    two = system.trace(lamp, branches="random", threads=2)
    assert one.rows > 8_000
    for name in one:
        np.testing.assert_array_equal(one[name], two[name])


def test_tables() -> None:
    trace = optics.System([optics.ball_lens(10)]).trace(optics.line_of_rays(4, 5).translate([0, 0, -20]))
    assert trace.rows == 15 and set(trace) >= {"generation", "intensity", "wavelength_nm", "index", "id", "surface"}
    pandas, pyarrow = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    frame = trace.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == 15
    table = trace.to_arrow()
    assert isinstance(table, pyarrow.Table)
    assert table["x1"].chunk(0).buffers()[1].address == trace["x1"].ctypes.data


def test_spots_and_irradiance() -> None:
    screen = optics.detector(40, name="screen").rotate_y(20).translate([1, 2, 30])
    light = optics.beam(10, 20_000, power=("total", 2.0)).rotate_y(20).translate([1, 2, 0])
    system = optics.System([screen])
    trace = system.trace(light)
    spot = trace.spot("screen")
    # a uniform disc of radius 5 has a mean square radius of 25 / 2
    assert spot.total == pytest.approx(2.0) and spot.rms_radius == pytest.approx(5 / math.sqrt(2), rel=1e-3)
    assert spot.geometric_radius == pytest.approx(5.0, rel=1e-2) and spot.encircled(2.5) == pytest.approx(0.25, abs=1e-3)
    # the sheet is 30 above the source along z, the light is inclined by 20 degrees
    assert spot.centroid == pytest.approx([30 * math.sin(math.radians(20)), 0.0], abs=1e-3)
    cells, x, y = trace.irradiance("screen", 40, size=(40, 40))
    assert (cells * np.outer(np.diff(y), np.diff(x))).sum() == pytest.approx(2.0)
    middle = cells[20, np.searchsorted(x, spot.centroid[0]) - 1]
    assert middle == pytest.approx(2.0 / (25 * math.pi), rel=0.05)
    assert trace.angles("screen") == pytest.approx(np.zeros(20_000), abs=1e-6)
    dark = system.trace(light.translate([100, 0, 0]))
    with pytest.raises(RayweaveError, match="no light arrives"):
        dark.spot("screen")


def test_paths_identify_ghosts() -> None:
    plate = optics.element(box([40, 40, 4]), 1.5, name="plate")
    system = optics.System([plate, optics.detector(30, name="screen").translate([0, 0, 20])])
    trace = system.trace_rays([0, 0, -20], [0.1, 0, 1], D_NM, branches="both", threshold=1e-9)
    power = {path.text: path.power for path in trace.paths()}
    cosine = 1 / math.sqrt(1.01)
    inner = math.sqrt(1 - (1 - cosine**2) / 2.25)
    rs = ((cosine - 1.5 * inner) / (cosine + 1.5 * inner)) ** 2
    rp = ((1.5 * cosine - inner) / (1.5 * cosine + inner)) ** 2
    # light is treated as unpolarised at each face
    r = (rs + rp) / 2
    assert power["plate plate screen"] == pytest.approx((1 - r) ** 2, rel=1e-12)
    assert power["plate* -"] == pytest.approx(r, rel=1e-12)
    assert power["plate plate* plate* plate screen"] == pytest.approx((1 - r) ** 2 * r**2, rel=1e-12)
    assert sum(power.values()) == pytest.approx(1.0, abs=1e-8)
    with pytest.raises(RayweaveError, match="some segments are missing"):
        trace.at("screen").paths()


def test_drawings(tmp_path: Path) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    colours = matplotlib.pyplot if hasattr(matplotlib, "pyplot") else pytest.importorskip("matplotlib.pyplot")
    system = optics.System([optics.ball_lens(10), optics.detector(12).translate([0, 0, 20])])
    trace = system.trace(optics.line_of_rays(4, 5, wavelength_nm=450.0).translate([0, 0, -20]))
    axis = trace.show()
    # a section of a ball of radius 5 between y = -5 and y = 5, and 15 segments of rays
    (lens, rays) = axis.collections
    heights = np.concatenate([path.vertices[:, 1] for path in lens.get_paths()])
    assert heights.max() == pytest.approx(5.0, abs=1e-2) and heights.min() == pytest.approx(-5.0, abs=1e-2)
    assert len(rays.get_paths()) == 15
    red, green, blue, _ = rays.get_colors()[0]
    assert blue > red and blue > green
    axis.get_figure().savefig(tmp_path / "layout.png")
    colours.close("all")
    with pytest.raises(RayweaveError, match="view is 'yz'"):
        trace.show("yz")  # type: ignore[arg-type]


def test_drawings_of_stray_light_are_faint_and_near_the_elements() -> None:
    pytest.importorskip("matplotlib").use("Agg")
    system = optics.System([optics.biconvex_lens(50, 50, 5, aperture=25), optics.detector(25.0).translate([0, 0, 49])])
    light = optics.source_of_rays([[0, y, -1000] for y in (-6, -2, 2, 6)], [[0, 0, 1]] * 4, wavelength_nm=550)
    trace = system.trace(light, branches="both", threshold=1e-7)
    axes = trace.show().axes[0]
    # 0.6 times the size of the elements, 49 + 2.5 mm, and margins
    assert -45 < axes.get_xlim()[0] < -2.5 and axes.get_xlim()[1] < 90
    (lines,) = [own for own in axes.collections if own.get_zorder() == 3]
    widths, opacities = np.asarray(lines.get_linewidths()), np.asarray(lines.get_alpha())
    # light as at the start, ghosts of about 4 % of it, and of 4 % squared; none below 1e-4 of it
    power = trace["intensity"] / trace["intensity"][trace["generation"] == 0].max()
    drawn = power[power >= 1e-4]
    assert len(drawn) == len(widths) < len(power)
    assert (opacities[drawn > 0.3] == 1.0).all() and (opacities[drawn < 0.3] < 1.0).all()
    assert (np.diff(widths[np.argsort(drawn)]) >= 0).all() and len(set(widths)) >= 3


def test_what_is_wrong_is_named() -> None:
    with pytest.raises(RayweaveError, match="aperture"):
        optics.lens(10, -10, 5, aperture=30)
    with pytest.raises(RayweaveError, match="thickness"):
        optics.lens(100, -100, -1, aperture=10)
    with pytest.raises(RayweaveError, match="two elements are called `ball`"):
        optics.System([optics.ball_lens(1), optics.ball_lens(2)])
    with pytest.raises(RayweaveError, match="has no face `frnt`"):
        optics.System([optics.ball_lens(1).with_finish(optics.black(), "frnt")])
    system = optics.System([optics.ball_lens(1)])
    with pytest.raises(RayweaveError, match="ray 1 has a wavelength of 200 nm"):
        system.trace_rays([[0, 0, -5]] * 2, [0, 0, 1], [500.0, 200.0])
    with pytest.raises(RayweaveError, match=r"power\[0\] is -1"):
        system.trace_rays([0, 0, -5], [0, 0, 1], D_NM, -1.0)
    with pytest.raises(RayweaveError, match="sources is empty"):
        system.trace([])
    with pytest.raises(RayweaveError, match='branches is "all"'):
        system.trace_rays([0, 0, -5], [0, 0, 1], branches="all")  # type: ignore[arg-type]
    with pytest.raises(RayweaveError, match=r"wavelength_nm has shape \(3,\): it must be \(2,\)\."):
        system.trace_rays([[0, 0, -5]] * 2, [0, 0, 1], [500.0] * 3)
    with pytest.raises(RayweaveError, match=r"directions has shape \(2,\)"):
        system.trace_rays([0, 0, -5], [0, 1])
    with pytest.raises(RayweaveError, match="origins has 2 rows and directions 3"):
        system.trace_rays([[0, 0, -5]] * 2, [[0, 0, 1]] * 3)
    with pytest.raises(RayweaveError, match="generation_limit is -1"):
        system.trace_rays([0, 0, -5], [0, 0, 1], generation_limit=-1)
    with pytest.raises(TypeError, match=r"elements\[0\] is of the type Solid: it must be an Element\. Make one of a solid with element\("):
        optics.System([sphere(1)])  # type: ignore[list-item]
    with pytest.raises(TypeError, match=r"sources\[0\]"):
        system.trace([optics.ball_lens(1)])  # type: ignore[list-item]
    with pytest.raises(RayweaveError, match="there is no element 'lens'"):
        system.trace_rays([0, 0, -5], [0, 0, 1]).at("lens")


def test_arguments_are_checked_where_they_are_passed() -> None:
    """The error names the argument, before anything is created from it or traced."""
    given: list[tuple[type[Exception], str, Callable[[], object]]] = [
        (TypeError, "the aperture is 'wide'", lambda: optics.baffle("wide")),  # type: ignore[arg-type]
        (TypeError, r"the aperture is \(1, 2, 3\)", lambda: optics.baffle((1, 2, 3))),  # type: ignore[arg-type]
        (TypeError, "a radius or size is None", lambda: optics.ball_lens(None)),  # type: ignore[arg-type]
        (TypeError, "the material is None", lambda: optics.ball_lens(1, material=None)),  # type: ignore[arg-type]
        (RayweaveError, "the material is -1.5", lambda: optics.ball_lens(1, material=-1.5)),
        (RayweaveError, "Did you mean N-BK7", lambda: optics.ball_lens(1, material="N-BK77")),
        (RayweaveError, "Did you mean 'mirror'", lambda: optics.ball_lens(1, material="mirorr")),
        (TypeError, "finish is 'black'", lambda: optics.ball_lens(1).with_finish("black")),  # type: ignore[arg-type]
        (TypeError, r"a film is \(1.38,\)", lambda: optics.coated((1.38,))),  # type: ignore[arg-type]
        (TypeError, r"wavelength_nm is \[500, 600\]", lambda: optics.beam(1, 5, wavelength_nm=[500, 600])),  # type: ignore[arg-type]
        (RayweaveError, "the number of rays is -1", lambda: optics.beam(1, -1)),
        (TypeError, "the number of rays is 1.5", lambda: optics.beam(1, 1.5)),  # type: ignore[arg-type]
        (RayweaveError, "seed is -1", lambda: optics.beam(1, 5, seed=-1)),
        (RayweaveError, "v has 2 numbers", lambda: optics.ball_lens(1).translate([0, 0])),
        (TypeError, "elements is None", lambda: optics.System(None)),  # type: ignore[arg-type]
    ]
    for kind, message, make in given:
        with pytest.raises(kind, match=message):
            make()
    system = optics.System([optics.ball_lens(1), optics.detector(5).translate([0, 0, 3])])
    light = optics.beam(0.5, 10).translate([0, 0, -3])
    with pytest.raises(TypeError, match="sources is 3"):
        system.trace(3)  # type: ignore[arg-type]
    trace = system.trace(light)
    with pytest.raises(KeyError, match="no column 'power'"):
        trace["power"]
    with pytest.raises(RayweaveError, match="Did you mean 'detector'"):
        trace.at("detecter")
    with pytest.raises(RayweaveError, match="bins is 0"):
        trace.irradiance("detector", 0)
    with pytest.raises(TypeError, match="size is 3"):
        trace.irradiance("detector", size=3)  # type: ignore[arg-type]
    for name in ("away.csv", "away.parquet"):
        if name.endswith("parquet"):
            pytest.importorskip("pyarrow")
        with pytest.raises(RayweaveError, match="folder .* does not exist"):
            system.trace_to(Path("no such folder") / name, light)


def test_missing_packages_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    trace = optics.System([optics.ball_lens(1)]).trace(optics.beam(0.5, 3))
    for name in ("pandas", "pyarrow", "polars", "matplotlib", "matplotlib.pyplot"):
        # Python treats this as a missing package
        monkeypatch.setitem(sys.modules, name, None)
    for use in (trace.to_pandas, trace.to_arrow, trace.to_polars, trace.show):
        with pytest.raises(ModuleNotFoundError, match="is not installed: .* pip install"):
            use()


def cone(half_degrees: float, count: int, z: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """PyRayT's cone of rays, which begins at its +z, Rayweave's -x, and continues towards +y."""
    angle, half = 2 * np.pi * np.arange(count) / count, math.radians(half_degrees)
    along = np.full(count, math.cos(half))
    directions = np.stack([-math.sin(half) * np.cos(angle), math.sin(half) * np.sin(angle), along], axis=1)
    return np.tile([0.0, 0.0, z], (count, 1)), directions


def pyrayt(case: str) -> dict[tuple[int, int], dict[str, float]]:
    """The segments of PyRayT by ray and generation."""
    lines = (Path(__file__).parent / "reference/pyrayt.csv").read_text(encoding="utf-8").splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    chosen = [{k: float(v) for k, v in row.items() if k != "case"} for row in rows if row["case"] == case]
    return {(int(row["id"]), int(row["generation"])): row for row in chosen}


def compare_with_pyrayt(case: str, trace: optics.Trace) -> None:
    expected = pyrayt(case)
    assert trace.rows == len(expected)
    names = {"x1": ("z1", 1), "y1": ("y1", 1), "z1": ("x1", -1)}
    tilts = {"x_tilt": ("z_tilt", 1), "y_tilt": ("y_tilt", 1), "z_tilt": ("x_tilt", -1), "index": ("index", 1)}
    for k, key in enumerate(zip(trace["id"].tolist(), trace["generation"].tolist(), strict=True)):
        for theirs, (ours, sign) in (names | tilts).items():
            size = max(1.0, abs(expected[key][theirs]))
            assert abs(expected[key][theirs] - sign * trace[ours][k]) < 1e-9 * size, (case, key, theirs)


def test_pyrayts_tutorial_and_examples() -> None:
    lens, screen = optics.biconvex_lens(2, 2, 0.25, aperture=1, material=1.5), optics.baffle((1, 1))
    system = optics.System([lens, screen.translate([0, 0, 1])], unit="in")
    compare_with_pyrayt("tutorial", system.trace_rays(*cone(10, 10, -2.04), 633.0))
    focal_length = optics.lensmaker(2, -2, 1.5, 0.25)
    compare_with_pyrayt("collimator", system.trace_rays(*cone(6, 20, -focal_length), 633.0))
    crown = optics.glass("N-BK7")
    focal_length = optics.lensmaker(100, -100, crown.index(630.0), 10)
    lens = optics.biconvex_lens(100, 100, 10, aperture=50, material=crown)
    system = optics.System([lens, optics.baffle((50, 50)).translate([0, 0, 2 * focal_length])])
    origins, directions = cone(5, 10, -focal_length)
    wavelengths = np.repeat([405.0, 530.0, 650.0], 10)
    three = np.tile(origins, (3, 1)), np.tile(directions, (3, 1))
    compare_with_pyrayt("dispersion", system.trace_rays(*three, wavelengths))


def test_media_with_a_gradient() -> None:
    # a rod of a quarter pitch, pi / (2 g), focuses parallel light on its far end; along y, so that the gradient is
    # rotated
    quarter, turn = math.pi / 2 / 0.25, np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    medium = optics.graded("N-BK7", "selfoc", 0.25, world_from_local=turn)
    assert medium.index(D_NM, (0, 7, 1)) == pytest.approx(1.5168 * math.sqrt(1 - 0.25**2), abs=1e-5)
    rod = optics.element(box((2, quarter, 2)), medium, name="rod")
    trace = optics.System([rod]).trace_rays([[0.01, -20, 0], [0, -20, 0.01]], [0, 1, 0], D_NM)
    columns = trace.columns
    last = columns["event"] == core.event_names().index("escaped")
    np.testing.assert_allclose(trace["x0"][last], 0, atol=1e-6)
    np.testing.assert_allclose(trace["z0"][last], 0, atol=1e-6)
    assert (columns["event"] == core.event_names().index("curved")).any()
    with pytest.raises(RayweaveError, match="luneburg"):
        optics.graded(1.0, "luneburg", 1.0, 2.0)
    with pytest.raises(RayweaveError, match="radius of the gradient is -1"):
        optics.graded(1.0, "luneburg", -1.0)

