"""Models built in Python, and the comfort of results: tables, short texts, files by their endings."""

import inspect
import math
import pickle

import numpy as np
import pytest

import rayweave as rw

START, X = np.array([-5.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0])


@pytest.fixture
def model():
    return rw.Model(
        regions=[
            rw.Region("tank", rw.box(4), medium="water", colour="red"),
            rw.Region("ball", rw.sphere(1), medium="glass"),
        ],
        media={"water": {"index": 1.33, "density": 1.0}, "glass": rw.Medium("any", 1.5, colour="#00ff0080")},
    )


def test_a_built_model_answers_like_one_from_text(model):
    text = """
    rayweave = 1
    [solid.tank]
    box = { size = 4 }
    [solid.ball]
    sphere = { radius = 1 }
    [[region]]
    solid = "tank"
    medium = "water"
    colour = "red"
    [[region]]
    solid = "ball"
    medium = "glass"
    [medium.water]
    index = 1.33
    density = 1.0
    [medium.glass]
    index = 1.5
    colour = "#00ff0080"
    """
    assert model == rw.loads(text)
    assert rw.loads(model.to_toml()) == model
    assert np.array_equal(model.crossings(START, X).t, [3, 4, 6, 7])
    assert model.regions[0].colour == "#ff0000" and model.regions[1].colour == "#00ff0080"
    assert [medium.name for medium in model.media] == ["world", "water", "glass"]
    assert model.media[1].numbers == {"density": 1.0} and model.unit == "mm"


@pytest.mark.parametrize("unit", ["mm", "in"])
def test_parts_of_a_model_build_an_equal_one(model, unit):
    same = rw.Model(model.regions, model.media, unit=unit)
    assert (same == model) == (unit == "mm") and same.media == model.media
    assert rw.Model({region.name: region for region in model}, model.media) == model


def test_regions_are_found_by_name_and_number(model):
    assert len(model) == 2 and [region.name for region in model] == ["tank", "ball"]
    assert model["ball"] == model[1] == model[-1]
    with pytest.raises(KeyError, match="no region is called `bal`.*Did you mean `ball`"):
        model["bal"]
    assert repr(model) == "<Model in mm, 2 regions: tank (water), ball (glass)>"


def test_regions_get_names():
    model = rw.Model([rw.sphere(1), rw.box(1).named("die"), rw.sphere(2)])
    assert [(region.name, region.medium) for region in model] == [("solid", "solid"), ("die", "die"), ("solid2", "solid2")]
    model = rw.Model({"a": rw.sphere(1), "b": rw.Region("c", rw.box(1), "m")}, unit="cm")
    assert [(region.name, region.medium) for region in model] == [("a", "a"), ("b", "m")] and model.unit == "cm"
    assert len(rw.Model(rw.sphere(1))) == 1 and len(rw.Model([])) == 0


@pytest.mark.parametrize(
    ("regions", "media", "error", "message"),
    [
        (3, None, TypeError, "must be a list or a dict of solids"),
        ([1], None, TypeError, r"regions\[0\] is of type int"),
        ({"a": "b"}, None, TypeError, r"regions\['a'\] is of type str"),
        ([rw.Region("a", rw.sphere(1), "watr")], {"water": 1.3}, rw.RayweaveError, "Did you mean 'water'"),
        ([rw.Region("a", rw.sphere(1)), rw.Region("a", rw.box(1))], None, rw.RayweaveError, r"regions\[1\] has the name 'a'"),
        ([rw.Region("a", rw.sphere(1), colour="redish")], None, rw.RayweaveError, "colour of the region 'a' is 'redish'"),
        ([rw.sphere(1)], {"m": -1}, rw.RayweaveError, "index of the medium 'm' is -1"),
        ([rw.sphere(1)], {"m": {"density": math.nan}}, rw.RayweaveError, "density of the medium 'm' is nan"),
        ([rw.sphere(1)], {"m": "x"}, TypeError, r"media\['m'\] is of type str"),
        ([rw.sphere(1)], {"m": {"index": "1.5"}}, TypeError, "the index of the medium 'm' is '1.5': it must be a number"),
        ([rw.sphere(1)], {"m": {"color": "red"}}, TypeError, "color of the medium 'm' is 'red': .* The key of the colour is 'colour'"),
        ({1: rw.sphere(1)}, None, TypeError, "regions has the key 1: keys are the names of regions"),
        # the medium of the world has no boundary to the outside
        ({"world": rw.box(10), "ball": rw.sphere(1)}, None, rw.RayweaveError, "the region 'world' has no medium"),
        ([rw.sphere(1)], [1.5], TypeError, r"media\[0\] is of type float"),
        ([rw.sphere(1)], [rw.Medium("m"), rw.Medium("m")], rw.RayweaveError, r"media\[1\] has the name 'm'"),
    ],
)
def test_bad_parts_are_rejected(regions, media, error, message):
    with pytest.raises(error, match=message):
        rw.Model(regions, media)


@pytest.mark.parametrize("several", [[rw.sphere(1), rw.box(1).translate([4, 0, 0])], {"a": rw.sphere(1), "b": rw.box(1)}])
def test_questions_take_several_solids(several):
    assert rw.render(several, size=(24, 16)).shape == (16, 24, 4)
    assert len(rw.measure(several, most_rays=4096)) == 2
    assert len(rw.section(several, "z=0.1")) >= 1
    assert rw.thickness(several, view="front", size=(8, 6)).lengths.shape == (6, 8, 3)
    assert rw.diff(several, several, cells=8).is_same
    assert rw.sheet(several, size=(320, 240)).svg.startswith("<svg")
    assert isinstance(rw.check(several, cells=8).to_pandas().size, int)
    with pytest.raises(TypeError, match="subject is 3: it must be a Solid, a Model, or a list or dict"):
        rw.render(3)


def test_tables_have_rows_and_columns(model):
    found = model.crossings(np.stack([START, START + [0, 1.5, 0]]), X)
    assert len(found) == 6 and found["t"] is found.t
    row = found[1]
    assert row["region_after"] == "ball" and row["medium_before"] == "water" and row["t"] == 4
    assert [entry["ray"] for entry in found] == [0, 0, 0, 0, 1, 1]
    chosen = found[found.ray == 1]
    assert len(chosen) == 2 and chosen["t"].tolist() == [3, 7] and chosen[0]["region_after"] == "tank"
    assert len(chosen[:1]) == 1
    with pytest.raises(KeyError, match="there is no column 'time': the columns are ray, t, point"):
        found["time"]
    with pytest.raises(IndexError, match="there is no row 6"):
        found[6]
    assert {"leaf", "placement", "occurrence", "to_pandas"} <= set(dir(found))


@pytest.mark.parametrize("count", [1, 1000])
def test_texts_of_results_are_short(model, count):
    starts = START + np.linspace(0, 0.9, count)[:, None] * [0, 1, 0]
    results = [model.crossings(starts, X), model.partition(starts, X), model.nearest(starts, X), rw.sphere(1).crossings(starts, X)]
    for result in [*results, rw.measure(model, most_rays=4096)]:
        assert len(repr(result)) < 1500 and repr(result).startswith("<") and repr(result).endswith(">")
        assert all(len(line) <= 116 for line in repr(result).splitlines()[:-1])
        assert result._repr_html_().count("<tr>") <= 13
    assert "ball" in repr(results[0]) and "6 columns" not in repr(results[0])


def test_data_frames_have_names(model):
    frame = model.crossings(START, X).to_pandas()
    assert list(frame["medium_after"]) == ["water", "glass", "water", "world"]
    assert list(frame["point_x"]) == [-2, -1, 1, 2]
    table = model.partition(START, X, -10, 10).to_arrow()
    assert table["region"].to_pylist() == ["world", "tank", "ball", "tank", "world"]
    assert table.num_rows == 5
    miss = rw.sphere(1).nearest([[0, 5, 0]], X)
    assert miss.to_arrow()["surface"].to_pylist() == [None] and miss.to_pandas()["surface"].isna().all()
    assert rw.measure(model).to_pandas()["volume"][1] == pytest.approx(4 / 3 * math.pi, rel=2e-3)
    assert rw.section(model, "z=0").to_pandas()["area"][1] == pytest.approx(math.pi, rel=1e-3)


def test_surfaces_with_equal_names_make_a_data_frame():
    twice = rw.sphere(1).translate([-2, 0, 0]) | rw.sphere(1).translate([2, 0, 0])
    found = twice.crossings([-9, 0, 0], X)
    assert len(found.to_pandas()) == 4 and len(found.to_arrow()) == 4


@pytest.mark.parametrize("shape", [(4, 5), (2, 3, 4)])
def test_grids_of_pixels(shape, rng):
    origins, directions = rng.normal(size=(*shape, 3)) * 3, rng.normal(size=(*shape, 3))
    solid = rw.sphere(1) | rw.box(1.5)
    flat = solid.nearest(origins.reshape(-1, 3), directions.reshape(-1, 3))
    assert np.array_equal(solid.nearest(origins, directions).t, flat.t)
    # one direction for the grid, and axes that are broadcast
    assert np.array_equal(solid.hits(origins, X), solid.hits(origins.reshape(-1, 3), X))
    columns = solid.nearest(origins[..., :1, :], directions[..., :1, :, :])
    wide = np.broadcast_arrays(origins[..., :1, :], directions[..., :1, :, :])
    assert np.array_equal(columns.t, solid.nearest(*(array.reshape(-1, 3) for array in wide)).t)
    inside = solid.contains(origins)
    assert inside.shape == shape and np.array_equal(inside.ravel(), solid.contains(origins.reshape(-1, 3)))


def test_errors_in_grids_name_the_pixel():
    grid = np.ones((3, 4, 3))
    grid[2, 1, 0] = math.nan
    with pytest.raises(rw.RayweaveError, match=r"directions\[2, 1\] is \(NaN"):
        rw.sphere(1).hits(START, grid)
    with pytest.raises(rw.RayweaveError, match=r"origins has shape \(3, 4\): it must be .* grid"):
        rw.sphere(1).hits(np.ones((3, 4)), X)
    with pytest.raises(rw.RayweaveError, match="grids of origins and directions do not match"):
        rw.sphere(1).hits(np.ones((3, 4, 3)), np.ones((5, 4, 3)))


@pytest.mark.parametrize("ending", ["stl", "obj", "ply", "off", "3mf", "glb", "csg", "gdml", "toml"])
def test_solids_are_saved_in_the_format_of_the_ending(tmp_path, ending):
    path = tmp_path / f"part.{ending}"
    rw.box([1, 2, 3]).save(path)
    part = rw.load(path)
    # GDML has a world around the part; glTF is in metres, with y up
    box = part.regions[-1].solid.bounds * {"mm": 1, "m": 1000}[part.unit]
    assert np.sort(np.diff(box, axis=0)[0]) == pytest.approx([1, 2, 3], rel=1e-6)
    assert ending == "toml" or b"rayweave = 1" not in path.read_bytes()


def test_unknown_endings_are_rejected(tmp_path, model):
    for subject in (model, rw.sphere(1)):
        with pytest.raises(rw.RayweaveError, match=r"part.step: the ending names no format.*\.stl"):
            subject.save(tmp_path / "part.step")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(rw.RayweaveError, match="Python writes drawings as .svg"):
        rw.sheet(model, size=(320, 240)).save(tmp_path / "sheet.pdf")


def test_convert_takes_solids_and_models(tmp_path, model):
    for k, subject in enumerate([rw.sphere(1), model, [rw.sphere(1), rw.box(3)]]):
        rw.convert(subject, tmp_path / f"{k}.stl", tolerance=0.1)
        assert len(rw.load(tmp_path / f"{k}.stl")) == 1


def test_the_space_of_a_region():
    model = rw.Model({"post": rw.box([1, 1, 4]), "plate": rw.box([4, 4, 1]), "pin": rw.box([0.5, 0.5, 9])})
    for region, volume in (("post", 3 - 0.75), ("plate", 16 - 0.25), ("pin", 2.25), (0, 2.25), (-1, 2.25)):
        assert model.solid_of(region).volume == pytest.approx(volume, rel=1e-9)
        assert model.solid_of(region).to_mesh().volume == pytest.approx(volume, rel=1e-9)
    with pytest.raises(KeyError, match="no region is called `pots`.*Did you mean `post`?"):
        model.solid_of("pots")
    with pytest.raises(IndexError):
        model.solid_of(3)


def test_sections_in_faces():
    above, below, middle = (rw.section(rw.box(2), plane) for plane in ("z=1", "z=-1", "z=0"))
    assert above.in_face and below.in_face and not middle.in_face
    assert above.areas.tolist() == [] and below.areas.tolist() == pytest.approx([4])
    assert "in a face, on its +z side" in repr(below) and "face" not in repr(middle)
    assert pickle.loads(pickle.dumps(below)).in_face


def test_a_mesh_for_each_region():
    model = rw.Model({"post": rw.box([1, 1, 4]), "plate": rw.box([4, 4, 1])})
    meshes = model.to_mesh(by="region")
    assert list(meshes) == ["post", "plate"] and all(mesh.is_closed for mesh in meshes.values())
    # the plate cuts the post into two pieces of 1.5
    assert meshes["post"].volume == pytest.approx(3, rel=1e-12) and meshes["post"].shells == 2
    assert meshes["plate"].volume == pytest.approx(16, rel=1e-12)
    assert len(model.to_mesh().triangles) == sum(len(mesh.triangles) for mesh in meshes.values())
    with pytest.raises(rw.RayweaveError, match="by is 'medium': it must be 'region' or None"):
        model.to_mesh(by="medium")


def test_mesh_files_in_numbers(tmp_path):
    outer, inner = rw.box(2).to_mesh(), rw.box(1).to_mesh()
    vertices = np.concatenate([outer.vertices, inner.vertices]) + 1e3
    hollow = rw.Mesh(vertices, np.concatenate([outer.triangles, inner.triangles + 8]))
    # the even-odd rule makes the inner shell a cavity
    solid = hollow.to_solid()
    assert solid.volume == pytest.approx(7, rel=1e-12)
    placed = solid.rotate_x(20).scale(2).translate([0, 0, 5])
    assert placed.volume == pytest.approx(56, rel=1e-12)
    solid.save(tmp_path / "hollow.ply")
    found = rw.load_mesh(tmp_path / "hollow.ply")
    assert (len(found.triangles), found.shells, found.open_edges, found.is_closed) == (24, 2, 0, True)
    assert np.allclose(found.bounds, [[999] * 3, [1001] * 3], rtol=1e-15)
    opened = rw.Mesh(outer.vertices, outer.triangles[:-1])
    assert (opened.is_closed, opened.open_edges) == (False, 3) and "holes: 1" in opened.describe()
    (tmp_path / "open.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    assert not rw.load_mesh(tmp_path / "open.off").is_closed
    with pytest.raises(rw.RayweaveError, match="load_mesh reads .stl"):
        rw.load_mesh(__file__)
    with pytest.raises(FileNotFoundError):
        rw.load_mesh(tmp_path / "none.stl")


def test_meshes(model):
    mesh = rw.box([1, 2, 3]).to_mesh()
    assert mesh.volume == pytest.approx(6) and mesh.area == pytest.approx(22)
    assert np.allclose(mesh.bounds, [[-0.5, -1, -1.5], [0.5, 1, 1.5]], rtol=1e-12)
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1) and mesh.faces is mesh.triangles
    fine = rw.sphere(1).to_mesh(1e-3)
    assert fine.volume == pytest.approx(4 / 3 * math.pi, rel=5e-3) and fine.volume < 4 / 3 * math.pi
    # a face between two regions belongs to both
    both = model.to_mesh(0.01)
    assert both.volume == pytest.approx(64, rel=1e-9)
    # a core that fills a part of a cavity
    ball = rw.sphere(8)
    with pytest.warns(UserWarning, match=r"^the mesh of 'solid' is not sound: .*regions of a model"):
        ((rw.sphere(10) - ball) | (ball & rw.half_space([0, 0, 1], -3))).to_mesh(0.05)
    again = rw.from_trimesh(mesh)
    a, b = rw.box(2).to_mesh(), rw.box(2).translate([1, 0, 0]).to_mesh()
    overlapping = rw.Mesh(np.concatenate([a.vertices, b.vertices]), np.concatenate([a.triangles, b.triangles + len(a.vertices)]))
    with pytest.warns(UserWarning, match=r"may be another than was meant .*overlapping pairs of triangles.*rw\.union"):
        rw.from_trimesh(overlapping)
    reversed_box = rw.Mesh(a.vertices, a.triangles[:, ::-1])
    with pytest.warns(UserWarning, match=r"whatever the orientation of the triangles\.$"):
        assert rw.from_trimesh(reversed_box).volume == pytest.approx(8)
    assert again.volume == pytest.approx(6, rel=2e-3) and again.contains([0, 0, 1.4]).all()
    with pytest.raises(rw.RayweaveError, match="unbounded"):
        rw.cylinder(1).to_mesh()


def test_meshes_of_pyvista_become_solids():
    class PolyData:
        """A box whose faces are rectangles, with the attributes of a mesh of PyVista."""

        points = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], dtype=np.float32)

        def triangulate(self):
            corners = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
            triangles = [[3, a, *pair] for a, b, c, d in corners for pair in ((b, c), (c, d))]
            made = PolyData()
            made.faces = np.ravel(triangles)
            return made

    assert rw.from_trimesh(PolyData()).volume == pytest.approx(6)


def test_properties_of_solids():
    assert rw.sphere(2).volume == pytest.approx(32 / 3 * math.pi, rel=1e-15)
    ring = (rw.cylinder(2, 1) - rw.cylinder(1, 3)).translate([5, 0, 0])
    assert ring.volume == pytest.approx(3 * math.pi, rel=2e-3)
    assert ring.area == pytest.approx(2 * 3 * math.pi + 2 * math.pi * 3, rel=2e-2)
    assert ring.centroid == pytest.approx([5, 0, 0], abs=0.01)
    assert ring.name is None and ring.named("ring").name == "ring"
    with pytest.raises(rw.RayweaveError, match="unbounded: it has no volume"):
        _ = rw.half_space([0, 0, 1], 0).volume
    assert rw.empty().volume == 0


def test_unions_take_solids_one_by_one():
    a, b = rw.sphere(1), rw.box(1)
    assert rw.union(a, b) == rw.union([a, b]) and rw.union() == rw.union([]) and rw.union(a) == rw.union([a])
    assert rw.intersection(a, b) == rw.intersection(iter([a, b]))
    with pytest.raises(TypeError, match=r"solids\[1\] is .*must be a Solid"):
        rw.union(a, 3)


def test_missing_files_are_named(tmp_path):
    path = tmp_path / "lens.toml"
    for read in (rw.load, rw.optics.load, rw.photons.load, lambda name: rw.convert(name, tmp_path / "x.stl")):
        with pytest.raises(FileNotFoundError, match="lens.toml") as caught:
            read(path)
        assert caught.value.filename == str(path) and caught.value.errno == 2


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: rw.sphere(diameter=3), "Did you mean radius, half the diameter"),
        (lambda: rw.cylinder(r=3, h=2), r"unexpected keyword argument 'r': .*Did you mean radius\?"),
        (lambda: rw.cylinder(3, h=2), r"Did you mean height\?"),
        (lambda: rw.box(sise=2), r"Did you mean size\?"),
        (lambda: rw.box(2, center=True), r"Did you mean box\(\.\.\.\)\.translate\(center\)\?"),
        (lambda: rw.render(rw.sphere(1), size="big"), "size is 'big': it must be two whole numbers"),
        (lambda: rw.render(rw.sphere(1), samples=1.5), "samples is 1.5: it must be a whole number"),
    ],
)
def test_words_of_other_programs_get_suggestions(call, message):
    with pytest.raises(TypeError, match=message):
        call()


def test_names_of_other_programs_get_suggestions():
    with pytest.raises(AttributeError, match=r"no attribute 'cube': write box\(size\)"):
        _ = rw.cube
    with pytest.raises(AttributeError, match="did you mean sphere"):
        _ = rw.spere
    with pytest.raises(rw.RayweaveError, match="Did you mean `box`"):
        rw.loads("rayweave = 1\n[solid.a]\ncube = { size = 1 }")
    with pytest.raises(rw.RayweaveError, match=r"rotate.*axis = \[0, 0, 1\], degrees = 90"):
        rw.loads("rayweave = 1\n[solid.a]\nbox = { size = 1 }\ntransform = [{ rotate = [0, 0, 90] }]")
    with pytest.raises(rw.RayweaveError, match=r"Write `transform = \[\{ translate"):
        rw.loads("rayweave = 1\n[solid.a]\nbox = { size = 1 }\ntranslate = [0, 0, 90]")


def test_signatures_show_values():
    assert str(inspect.signature(rw.sphere)) == "(radius)"
    assert "t_min=-inf, t_max=inf" in str(inspect.signature(rw.Solid.hits))
    assert "t_min=0.0, t_max=inf" in str(inspect.signature(rw.Model.nearest))


def test_pictures_are_saved(tmp_path):
    picture = rw.render(rw.sphere(1), size=(32, 24))
    picture.save(tmp_path / "ball.png")
    read = pytest.importorskip("matplotlib.image").imread(tmp_path / "ball.png")
    assert np.array_equal(np.round(read * 255).astype(np.uint8), picture)
    with pytest.raises(rw.RayweaveError, match=r"a file needs \(h, w, 4\)"):
        picture[..., 0].save(tmp_path / "red.png")


def test_light_and_columns_are_tables_in_notebooks():
    lens = rw.optics.biconvex_lens(50, 50, 6, aperture=25, material="N-BK7")
    screen = rw.optics.detector(10, name="screen").translate([0, 0, 47])
    light = rw.optics.beam(20, 10, wavelength_nm=587.6).translate([0, 0, -20])
    trace = rw.optics.System([lens, screen]).trace(light)
    html = trace._repr_html_()
    assert "<td>screen</td>" in html or "<td>lens</td>" in html
    assert html.count("<tr>") == 13 and "more rows" in html
    columns = rw.optics.Columns({"radius": [1.0, 2.0]}, {"radius": "mm"})
    assert "<th>radius [mm]</th>" in columns._repr_html_()


def test_parts_and_data_of_lenses_have_html():
    ro = rw.optics
    surfaces = [ro.Surface(50, 5, "N-BK7"), ro.Surface(-50, 46)]
    lens = ro.Prescription(surfaces, entrance_pupil_diameter=10, fields=[0, 5])
    assert "<td>focal length</td><td>49.2" in lens.first_order()._repr_html_()
    best = ro.optimise(lens, ["curvature 2"], [ro.goal("focal length", 60)])
    assert "<td>curvature 2</td>" in best._repr_html_()
    element = ro.biconvex_lens(50, 50, 5, aperture=25.0)
    assert "<td>material</td><td>N-BK7</td>" in element._repr_html_()
    assert "<td>triangles</td><td>12</td>" in rw.box([1, 2, 3]).to_mesh()._repr_html_()


def test_systems_become_models(tmp_path):
    lens = rw.optics.biconvex_lens(50, 50, 6, aperture=25, material="N-BK7").translate([0, 0, 10])
    flat = rw.optics.element(rw.box([4, 4, 1]), 1.5, name="plate")
    system = rw.optics.System([lens, flat, rw.optics.detector(10, name="screen").translate([0, 0, 47])])
    model = system.to_model()
    assert [region.name for region in model] == ["lens", "plate"]
    assert model["lens"].solid.contains([0, 0, 12.9]).all() and not model["lens"].solid.contains([0, 0, 13.1]).any()
    assert model.media[1].index == pytest.approx(1.5168, abs=1e-4) and model.media[2].index == 1.5
    rw.convert(system, tmp_path / "system.stl", tolerance=0.1)
    assert rw.load(tmp_path / "system.stl").bounds[1, 2] == pytest.approx(13)


def test_changes_to_tables_leave_the_result(model):
    pieces = model.partition(START, X, t_min=0, t_max=9)
    found = model.crossings(START, X)
    map_ = rw.thickness(model, view="front", size=(8, 8))
    before = pieces.path_lengths().copy(), found["t"].copy(), found["medium_before"].copy(), map_.radiograph.copy()
    for result in (pieces, found, map_):
        frame = result.to_pandas()
        for name in frame.select_dtypes("number"):
            frame.loc[:, name] = -7
        for name in frame.select_dtypes("category"):
            frame.loc[:, name] = frame[name].cat.categories[0]
        # in place, below the frame
        again = result.to_pandas()
        for name in again.select_dtypes("number"):
            array = again[name].to_numpy()
            if array.flags.writeable:
                array[:] = -7
        table = result.to_xarray()
        for name in table:
            if table[name].dtype.kind == "f":
                table[name].values[:] = -7
    after = pieces.path_lengths(), found["t"], found["medium_before"], map_.radiograph
    for old, new in zip(before, after, strict=True):
        np.testing.assert_array_equal(old, new)
