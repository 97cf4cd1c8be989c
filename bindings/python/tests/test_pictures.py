"""Pictures and time lines as arrays and texts."""

import numpy as np
import pytest

import rayweave as rw


def test_colour_is_rgba():
    picture = rw.render(rw.sphere(1), size=(64, 48))
    assert picture.shape == (48, 64, 4) and picture.dtype == np.uint8
    # the ball in the middle, the background in the corner
    assert not np.array_equal(picture[24, 32], picture[0, 0])


def test_depth_and_normal_of_a_sphere_by_hand():
    camera = rw.Camera(position=(0, -5, 0), target=(0, 0, 0), height=4.0)
    options = dict(size=(40, 40), camera=camera)
    depth = rw.render(rw.sphere(1), kind="depth", **options)
    normal = rw.render(rw.sphere(1), kind="normal", **options)
    ids = rw.render(rw.sphere(1), kind="id", **options)
    # pixel centres: x to the right, z up, 0.1 apart
    centres = (np.arange(40) + 0.5) * 0.1 - 2
    x, z = np.meshgrid(centres, -centres)
    inside = x**2 + z**2 < 1
    y = -np.sqrt(np.where(inside, 1 - x**2 - z**2, 0))
    assert np.array_equal(np.isfinite(depth), inside)
    assert np.allclose(depth[inside], 5 + y[inside], atol=1e-12)
    assert np.allclose(normal[inside], np.stack([x, y, z], axis=-1)[inside], atol=1e-12)
    assert np.all(np.isnan(normal[~inside]))
    assert ids.dtype == np.int32 and np.array_equal(ids == 1, inside)


def test_threads_change_nothing():
    solid = rw.box(2) - rw.sphere(1.3)
    one = rw.render(solid, size=(80, 60), threads=1)
    assert np.array_equal(one, rw.render(solid, size=(80, 60), threads=3))


def test_notebooks_see_a_png():
    assert rw.torus(2, 0.5)._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "options, words",
    [
        (dict(size=(0, 5)), "0 x 5"),
        (dict(camera=rw.Camera(position=(0, 0, 0))), "same point"),
        (dict(camera=rw.Camera(position=(1, 0, 0)), view="top"), "together"),
        (dict(view="above"), "above"),
        (dict(kind="colours"), "colours"),
        (dict(samples=0), "sample"),
        (dict(cut="x=1"), "neither < nor >"),
        (dict(explode="up"), "such as z:0.2"),
        (dict(opacity=1.5), "from 0 to 1"),
        (dict(opacity={"glass": 0.5}), "no region or medium is called `glass`"),
    ],
)
def test_invalid_options_are_rejected(options, words):
    with pytest.raises(rw.RayweaveError, match=words):
        rw.render(rw.sphere(1), **options)


def test_a_cut_opens_a_ball():
    camera = rw.Camera(position=(0, -5, 0), target=(0, 0, 0), height=4.0)
    depth = rw.render(rw.sphere(1), kind="depth", size=(41, 41), camera=camera, cut="y<0.5")
    # the plane y = 0.5 cuts the ball in a disc of radius sqrt(3)/2, 5.5 from the camera
    assert depth[20, 20] == 5.5
    across = np.isfinite(depth[20]).sum() * 4 / 41
    assert abs(across - np.sqrt(3)) < 0.1


NEST = """
rayweave = 1
[solid.shell]
sphere = { radius = 2 }
[solid.core]
sphere = { radius = 1 }
[[region]]
solid = "shell"
[[region]]
solid = "core"
"""


def test_transparent_regions():
    ball = rw.render(rw.sphere(1), size=(21, 21), view="front", opacity=0.0, kind="id")
    assert np.all(ball[10, 10] == 1)  # ids ignore opacity
    core = rw.render(rw.loads(NEST), size=(21, 21), view="front", opacity={"shell": 0.0}, kind="id")
    assert set(np.unique(core)) == {0, 1}


def test_regions_are_drawn_apart():
    camera = rw.Camera(position=(0, -20, 0), target=(0, 0, 0), height=20.0)
    ids = rw.render(rw.loads(NEST), kind="id", size=(101, 101), camera=camera, explode="x:0.25")
    # shell from -2 to 2, a gap of 1, core from 3 to 5
    row = ids[50]
    edges = np.flatnonzero(np.diff(row)) + 1
    assert np.allclose((edges - 50.5) * 20 / 101, [-2, 2, 3, 5], atol=0.2)


def test_sheets():
    model = rw.loads(NEST)
    drawing = rw.sheet(model, size=(400, 300), title="a & b")
    assert drawing.svg.count("<image ") == 4 and "a &amp; b" in drawing.svg and ">shell</text>" in drawing.svg
    assert rw.sheet(model, size=(100, 90), view="top")._repr_svg_().count("<image ") == 1
    with pytest.raises(rw.RayweaveError, match="leave no room"):
        rw.sheet(model, size=(30, 30))


def test_time_lines_of_root_rays_and_hits():
    drawing = rw.timeline(
        {"A": (1, 4, 5, 10), "B": rw.RootRay(-1, [2.0]), "C": (+1, [3.0, 4.0])}, {"all": np.array([1.0, 2.0])}
    )
    assert drawing.svg.lstrip().startswith("<svg") and drawing._repr_svg_() == drawing.svg
    for name in ("A", "B", "C", "all", "count"):
        assert f">{name}<" in drawing.svg
    with pytest.raises(rw.RayweaveError, match=r"operands\['A'\]"):
        rw.timeline({"A": (4, 1)})


def test_time_line_of_a_ray(tmp_path):
    lens = rw.sphere(5).translate([0, 0, 4]).named("front") & rw.sphere(5).translate([0, 0, -4]).named("back")
    drawing = rw.ray_timeline(lens, [0, 0, -10], [0, 0, 1])
    assert ">front<" in drawing.svg and ">back<" in drawing.svg
    drawing.save(tmp_path / "lens.svg")
    assert (tmp_path / "lens.svg").read_text() == drawing.svg
