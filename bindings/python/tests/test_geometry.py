"""Cross-sections, differences, checks and path lengths, compared with closed forms."""

import signal
import threading

import numpy as np
import pytest

import rayweave
from rayweave import RayweaveError

TWO = (
    'rayweave = 1\nunit = "cm"\n[solid.block]\nbox = { size = 4 }\n[solid.ball]\nsphere = { radius = 1 }\n'
    '[[region]]\nsolid = "block"\nmedium = "glass"\n[[region]]\nsolid = "ball"\nmedium = "air"\n'
    "[medium.glass]\nattenuation = 0.5\n[medium.air]"
)


def signed(contour):
    x, y = contour.T
    return 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))


def test_a_torus_cut_along_its_plane():
    found = rayweave.section(rayweave.torus(3, 1), "z=0.6")
    outer, inner = 3.8, 2.2
    assert found.names == ["solid"] and found.plane == "z = 0.6"
    assert found.areas[0] == pytest.approx(np.pi * (outer**2 - inner**2), abs=found.tolerance * found.perimeters[0])
    contours = sorted(found.contours("solid"), key=signed)
    assert [np.sign(signed(contour)) for contour in contours] == [-1, 1]
    for contour, radius in zip(contours, [inner, outer], strict=True):
        assert contour.shape[1] == 2
        assert np.abs(np.hypot(*contour.T) - radius).max() <= found.tolerance
    assert "z = 0.6" in repr(found) and found._repr_svg_().startswith("<svg ")
    with pytest.raises(RayweaveError, match="no part 'ring'"):
        found.contours("ring")


def test_an_oblique_plane_and_its_frame():
    rod = rayweave.cylinder(2, 40)
    found = rayweave.section(rod, point=[0.1, 0.2, 0.3], normal=[1, 0, 1], tolerance=1e-3)
    assert found.areas[0] == pytest.approx(4 * np.pi * np.sqrt(2), abs=1e-3 * found.perimeters[0])
    origin, across, up = found.frame
    points = origin + found.contours("solid")[0] @ np.array([across, up])
    assert np.abs(np.hypot(points[:, 0], points[:, 1]) - 2).max() <= 1e-3
    assert np.abs(points @ [1, 0, 1] - 0.4).max() < 1e-9


def test_a_stack_and_its_files(tmp_path):
    at = np.linspace(-0.9, 0.9, 7)
    stack = rayweave.section(rayweave.sphere(1), "xy", at=at)
    areas = [section.areas[0] for section in stack]
    assert np.allclose(areas, np.pi * (1 - at**2), atol=2e-3)
    assert [section.offset for section in stack] == list(at)
    rayweave.save_section(stack, tmp_path / "stack.svg", title="a ball")
    rayweave.save_section(stack, tmp_path / "stack.dxf")
    assert (tmp_path / "stack.svg").read_text(encoding="utf-8").count('class="cut"') == 7
    assert (tmp_path / "stack.dxf").read_text(encoding="utf-8").count("CIRCLE") == 7
    with pytest.raises(RayweaveError, match=r"written as \.svg or \.dxf"):
        rayweave.save_section(stack, tmp_path / "stack.pdf")


def test_dxf_by_an_independent_reader(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    section = rayweave.section(rayweave.loads(TWO), "z=0.5")
    rayweave.save_section(section, tmp_path / "two.dxf")
    drawing = ezdxf.readfile(tmp_path / "two.dxf")
    assert not drawing.audit().has_errors
    assert {"GLASS", "AIR"} <= {layer.dxf.name for layer in drawing.layers}
    areas = {"GLASS": 0.0, "AIR": 0.0}
    for line in drawing.modelspace().query("POLYLINE"):
        points = np.array([vertex.dxf.location for vertex in line.vertices])
        assert line.is_closed and np.all(points[:, 2] == 0.5)
        areas[line.dxf.layer] += signed(points[:, :2])
    for circle in drawing.modelspace().query("CIRCLE"):
        assert circle.dxf.center.z == 0.5 and circle.dxf.radius == pytest.approx(np.sqrt(0.75), rel=1e-9)
        # the hole of the block and the outline of the ball
        areas[circle.dxf.layer] += np.pi * circle.dxf.radius**2 * (-1 if circle.dxf.layer == "GLASS" else 1)
    assert areas["AIR"] == pytest.approx(0.75 * np.pi, abs=5e-3)
    assert areas["GLASS"] == pytest.approx(16 - 0.75 * np.pi, abs=5e-3)


def test_by_region_and_within():
    model = rayweave.loads(TWO)
    assert rayweave.section(model).names == ["glass", "air"]
    found = rayweave.section(model, by="region", within=[[0, 0, -1], [5, 5, 1]])
    assert found.names == ["block", "ball"]
    assert found.areas[1] == pytest.approx(np.pi / 4, abs=1e-3)
    assert rayweave.section(model, "z=9").names == []


def test_refusals_of_sections():
    ball = rayweave.sphere(1)
    cases = [
        ({"plane": "w=1"}, "the plane `w=1` is invalid"),
        ({"normal": [0, 0, 0]}, "the normal must not be zero"),
        ({"normal": [0, 0, np.nan]}, "must be finite"),
        ({"point": [0, 0, 0]}, "point is given without normal"),
        ({"normal": [0, 1]}, r"normal has shape \(2,\)"),
        ({"by": "colour"}, "by is 'colour'"),
        ({"tolerance": 0.0}, "the tolerance is 0"),
        ({"at": [np.inf]}, "must be finite"),
        ({"within": [1, 2, 3]}, r"within has shape \(3,\)"),
    ]
    for arguments, message in cases:
        with pytest.raises(RayweaveError, match=message):
            rayweave.section(ball, **arguments)
    with pytest.raises(TypeError, match="it must be a Solid, a Model, or a list"):
        rayweave.section("ball")


def test_diff_of_the_same_and_of_others():
    ball = rayweave.sphere(1)
    same = rayweave.diff(ball, rayweave.sphere(2).scale(0.5), cells=32)
    assert same.is_same and same.a_only[0] == 0 and "the same" in repr(same)
    found = rayweave.diff(ball, ball.translate([1, 0, 0]), cells=32, most_rays=1 << 17)
    lens = 5 / 12 * np.pi
    assert not found.is_same and found.names == ("model",)
    assert abs(found.both[0] - lens) <= found.both_half_width[0]
    assert abs(found.a_only[0] - (4 / 3 * np.pi - lens)) <= found.a_only_half_width[0]
    assert 0.9 < found.thickness[0] <= 1 + 1e-9
    assert np.linalg.norm(found.ray[0, 1] - found.ray[0, 0]) >= found.thickness[0] - 1e-9
    assert found.place.shape == (1, 2, 3) and found.section.names == ["both", "A only", "B only"]
    assert "different in 1 of 1 parts" in repr(found) and "B only" in found._repr_svg_()
    assert rayweave.diff(ball, rayweave.sphere(1.01), cells=16, distance=0.05).is_same


def test_diff_region_by_region():
    a, b = rayweave.loads(TWO), rayweave.loads(TWO.replace("radius = 1", "radius = 1.1"))
    found = rayweave.diff(a, b, cells=32, most_rays=1 << 17)
    assert found.names == ("block", "ball") and list(found.same) == [False, False] and found.unit == "cm"
    assert list(found.is_a) == [True, False]
    assert rayweave.diff(a, b, by="whole", cells=16).is_same
    with pytest.raises(RayweaveError, match="by is 'name'"):
        rayweave.diff(a, b, by="name")
    with pytest.raises(RayweaveError, match="the distance is NaN"):
        rayweave.diff(a, b, distance=np.nan)


def test_check_of_planted_faults():
    text = (
        "rayweave = 1\n[solid.a]\nbox = { size = [8, 8, 2] }\n[solid.b]\nbox = { size = [4, 4, 2] }\n"
        'transform = [{ translate = [0, 0, 1.5] }]\n[[region]]\nsolid = "a"\n[[region]]\nsolid = "b"'
    )
    model = rayweave.loads(text)
    found = rayweave.check(model, cells=32, pictures=True)
    (overlap,) = found.of("overlap")
    assert overlap.regions == ("a", "b") and overlap.size == pytest.approx(0.5)
    assert overlap.volume == pytest.approx(8, abs=overlap.volume_half_width + 1e-9)
    assert overlap.ray.shape == (2, 3) and overlap.section.names == ["a", "b", "both"]
    assert overlap._repr_svg_().startswith("<svg ") and "overlap: a and b" in repr(found)
    assert len(found) == len(list(found)) == 1 and found.scope["pairs"] == 1
    thin = rayweave.check(model, cells=32, wall=1.6)
    assert [finding.regions for finding in thin.of("thin")] == [("a",)]
    assert len(rayweave.check(rayweave.sphere(1), cells=16)) == 0
    with pytest.raises(RayweaveError, match="the wall is -1"):
        rayweave.check(model, wall=-1)


def test_thickness_and_radiograph():
    with pytest.warns(UserWarning, match="medium 'air' has no attenuation beside media that have one"):
        found = rayweave.thickness(rayweave.loads(TWO), view="front", size=(41, 41))
    assert found.media == ("world", "glass", "air") and found.lengths.shape == (41, 41, 3)
    assert found.lengths[20, 20] == pytest.approx([0, 2, 2])
    assert found.radiograph[20, 20] == pytest.approx(np.exp(-1))
    assert list(found.attenuation) == [0, 0.5, 0] and "41 x 41" in repr(found)
    with pytest.raises(RayweaveError, match="view"):
        rayweave.thickness(rayweave.sphere(1), view="inside")


def test_thickness_of_a_cone_beam():
    """Chords of a cylinder along the rays of a point source, by their closed form."""
    media = {"water": {"attenuation": 0.2}, "world": {"attenuation": 0.0}}
    cone = rayweave.Camera(position=[0, -60, 0], target=[0, 0, 0], field_of_view=2 * np.degrees(np.arctan(0.2)))
    model = rayweave.Model({"water": rayweave.cylinder(10, 100)}, media, camera=cone)
    found = rayweave.thickness(model, size=(40, 40))
    u, v = (np.indices((40, 40))[::-1] + 0.5) / 20 - 1
    x, z = 0.2 * u, -0.2 * v
    half = np.sqrt(np.maximum(100 * (1 + x * x) - (60 * x) ** 2, 0)) / (1 + x * x)
    chords = 2 * half * np.sqrt(1 + x * x + z * z)
    np.testing.assert_allclose(found["water"], chords, rtol=1e-12)
    np.testing.assert_allclose(found.line_integral, 0.2 * chords, rtol=1e-12)
    np.testing.assert_allclose(found.radiograph, np.exp(-0.2 * chords), rtol=1e-12)
    np.testing.assert_array_equal(rayweave.thickness(model, camera=cone, size=(40, 40)).lengths, found.lengths)
    assert found.pixel_size is None
    with pytest.raises(ValueError, match="has no extent in lengths"):
        found.extent  # noqa: B018
    with pytest.raises(TypeError, match="camera and view are both given"):
        rayweave.thickness(model, camera=cone, view="front")
    with pytest.raises(RayweaveError, match="the attenuation of the medium 'water' is -1: it must be finite"):
        rayweave.thickness(rayweave.Model({"water": rayweave.sphere(1)}, {"water": {"attenuation": -1}}))


def test_the_pixels_of_parallel_rays_have_a_size():
    found = rayweave.thickness(rayweave.cylinder(10, 20), view="front", size=(100, 80))
    # the sum over the pixels is the volume, up to the pixels at the edge
    assert found.lengths[..., 1].sum() * found.pixel_size**2 == pytest.approx(2000 * np.pi, rel=0.02)
    left, right, bottom, top = found.extent
    assert (right - left, top - bottom) == pytest.approx((100 * found.pixel_size, 80 * found.pixel_size))


def test_path_lengths_of_a_partition():
    model = rayweave.Model({"shell": rayweave.sphere(2), "core": rayweave.sphere(1)})
    offsets = np.array([0, 0.5, 1.5, 3])
    origins = np.column_stack([np.full(4, -3.0), offsets, np.zeros(4)])
    pieces = model.partition(origins, [2, 0, 0], 0, 3)
    core, both = (np.sqrt(np.maximum(r * r - offsets**2, 0)) for r in (1, 2))
    np.testing.assert_allclose(2 * pieces.path_lengths()[:, 2], 2 * core, atol=1e-14)
    np.testing.assert_allclose(2 * pieces.path_lengths()[:, 1], 2 * (both - core), atol=1e-14)
    np.testing.assert_allclose(pieces.path_lengths().sum(axis=1), 3, rtol=1e-15)
    assert model.partition(np.zeros((0, 3)), [1, 0, 0]).path_lengths().shape == (0, 3)
    with pytest.raises(TypeError, match="each is one number for all rays"):
        model.partition(origins, [1, 0, 0], 0, np.ones(4))


@pytest.mark.skipif(not hasattr(signal, "raise_signal"), reason="signals are sent by raise_signal")
def test_ctrl_c_ends_a_long_question():
    a, b = rayweave.sphere(1), rayweave.sphere(1.1)
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            rayweave.diff(a, b, precision=1e-9, most_rays=1 << 40)
    finally:
        timer.join()
        signal.signal(signal.SIGINT, handler)
