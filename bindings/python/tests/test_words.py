"""Texts that people read and write: representations that are valid Python, suggestions, and names of arguments."""

import math
import pickle

import numpy as np
import pytest

import rayweave as rw

TETRAHEDRON = rw.mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
A, B, C = rw.sphere(1), rw.box([1, 2, 3]), rw.cylinder(0.5)


def everything():
    """`from rayweave import *`."""
    names = {}
    exec("from rayweave import *", names)
    return names


@pytest.mark.parametrize(
    "solid",
    [
        A,
        B - C,
        (A | B) & ~C,
        A | (B | C),
        A | B | C,
        A - (B - C),
        ~(A | B),
        ~~A,
        (~A).translate([1, 2, 3]),
        (A ^ B) ^ C,
        A ^ (B ^ C),
        A & (B & C),
        rw.union([A]),
        rw.union([A, B, C]),
        rw.union([]),
        rw.intersection([A, B, C]),
        rw.empty() | rw.universe(),
        rw.cylinder(2, height=0.1 + 0.2),
        rw.cylinder(1e-50, 1e50),
        rw.torus(3, 1).rotate_z(30).rotate_x(-12.5).rotate_y(90),
        B.rotate([1, 2, 3], 40),
        B.scale(2).scale([1, -2, 3]).mirror([1, 1, 0]).scale(-1),
        B.transform([[1, 0.5, 0, 1], [0, 1, 0, 2], [0, 0, 1, -0.0], [0, 0, 0, 1]]),
        B.rotate_z(1e-9),
        A.translate([math.pi, -0.0, 1e-20]),
        A.named("it's a \\ \"name\"\n\u00e4\u6f22"),
        (A.named("a") | B.named("b")).named("c"),
        rw.place(A, [[1, 2, 3], [4, 5, 6]]),
        rw.place(A | B, np.stack([np.eye(4), np.diag([1.0, 2.0, 3.0, 1.0])])),
        rw.place(A, np.zeros((0, 3))),
        TETRAHEDRON,
        rw.asphere(10, 0.02, even=[0, 1e-5], height=5),
        rw.half_space([0, 0.6, 0.8], 2),
        rw.prism(6, 2, 1),
        rw.wedge(10, 80),
        rw.convex([[1, 0, 0, 1], [-1, 0, 0, 1], [0, 1, 1, 2], [0, -1, 0, 1], [0, 0, -1, 1]]),
    ],
)
def test_the_representation_of_a_solid_is_the_solid(solid):
    twin = eval(repr(solid), everything())
    assert twin == solid and pickle.dumps(twin) == pickle.dumps(solid)


def test_representations_read_well():
    assert repr(rw.box(2) - rw.cylinder(0.5)) == "box(size=[2, 2, 2]) - cylinder(radius=0.5)"
    assert repr(rw.sphere(1.5).rotate_z(30).named("ball")) == "sphere(radius=1.5).rotate_z(30).named('ball')"
    assert repr((A | C).translate([1, 0, 0])) == "(sphere(radius=1) | cylinder(radius=0.5)).translate([1, 0, 0])"


def test_long_representations_are_short():
    many = rw.union([A.translate([k, 0, 0]) for k in range(1000)])
    assert repr(many).startswith("<Solid: union([sphere(radius=1).translate([0, 0, 0])") and len(repr(many)) < 150


@pytest.mark.parametrize(
    "value",
    [
        rw.Region("ball", A.translate([1, 2, 3]), medium="glass", colour="red"),
        rw.Medium("glass", 1.5, "blue", {"density": 2.5}),
        rw.Camera(position=(1, 2, 3), height=5.0),
        rw.RootRay("inside", [1.0, 2.5]),
    ],
)
def test_representations_of_parts_are_python(value):
    assert eval(repr(value), everything()) == value


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: rw.cube, "write box"),
        (lambda: rw.signed_distance, r"solid.distance\(points\)"),
        (lambda: rw.spere, "did you mean sphere"),
        (lambda: A.union, r"a Solid has no attribute 'union': write a \| b"),
        (lambda: A.export, r"write solid.save\(path\)"),
        (lambda: A.radius, "a Solid has no attribute 'radius'$"),
        (lambda: rw.Model(A).trace, r"a Model has no attribute 'trace': write model.crossings\(origins, directions\)"),
        (lambda: rw.Model(A).radius, "a Model has no attribute 'radius'$"),
    ],
)
def test_words_of_other_programs_are_suggested(call, message):
    with pytest.raises(AttributeError, match=message):
        call()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: rw.cylinder(h=2, radius=1), "Did you mean height?"),
        (lambda: rw.sphere(diameter=2), "Did you mean radius, half the diameter?"),
        (lambda: rw.box(1, 2, 3), r"box\(\) got 3 arguments: it has 1: size. Write box\(\[x, y, z\]\)"),
        (lambda: rw.box(width=1), r"Did you mean box\(\[x, y, z\]\)"),
        (lambda: rw.cone(r1=1, r2=2, height=3), "Did you mean radius1, the radius at the bottom"),
        (lambda: rw.sphere(1, center=[0, 0, 1]), r"Did you mean sphere\(...\).translate\(center\)"),
        (lambda: rw.Region("a", A, color="red"), "Did you mean colour"),
        (lambda: rw.Medium("a", n=1.5), "Did you mean index"),
        (lambda: rw.render(A, width=100), r"Did you mean size=\(width, height\)"),
        (lambda: rw.section(A, z=0), "Did you mean plane="),
        (lambda: rw.render(A, camera=3), "camera is of type int: it must be a Camera"),
        (lambda: rw.from_trimesh(3), "source is of type int, without vertices"),
        (lambda: rw.section(rw.sphere(1), 2.0), "plane is 2.0: it must be a text"),
        (lambda: rw.measure(A, within="all"), "within is 'all': it must be"),
        (lambda: rw.sphere("2"), "sphere: radius is '2': it must be a number"),
        (lambda: A.hits([0, 0, 0], [1, 0, 0], threads=[1]), r"threads is \[1\]: it must be a whole number"),
        (lambda: rw.render("ball"), "subject is 'ball': it must be a Solid"),
        (lambda: A.translate(1, 2), "translate has two numbers: it needs a vector of three, or x, y and z."),
        (lambda: A.scale([1, 2, 3], 2, 3), r"x is \[1, 2, 3\]: scale needs a vector of three numbers, or x, y and z."),
        (lambda: A.rotate([0, 0, 90]), r"degrees is missing: .* use rotate_x\(degrees\)"),
    ],
)
def test_wrong_arguments_are_named(call, message):
    with pytest.raises(TypeError, match=message):
        call()


def test_vectors_may_be_given_as_three_numbers():
    assert repr(A.translate(1, 2, 3)) == repr(A.translate([1, 2, 3]))
    assert repr(A.scale(1, 2, 3)) == repr(A.scale([1, 2, 3]))
    lens = rw.optics.ball_lens(5)
    assert lens.translate(1, 2, 3).place[:3, 3].tolist() == lens.translate([1, 2, 3]).place[:3, 3].tolist() == [1, 2, 3]


def test_data_sets_have_the_columns():
    xarray = pytest.importorskip("xarray")
    found = rw.Model({"shell": rw.sphere(2), "core": rw.sphere(1)}).crossings([-3, 0, 0], [1, 0, 0])
    table = found.to_xarray()
    assert isinstance(table, xarray.Dataset) and table.sizes == {"row": 4, "axis": 3}
    assert table.t.values.tolist() == [1, 2, 4, 5] and table.point.sel(axis="x").values.tolist() == [-2, -1, 1, 2]
    assert table.region_after.values.tolist() == ["shell", "core", "shell", "world"]
    light = rw.optics.Columns({"radius": [1, 2], "fraction": [0.5, 1]}, {"radius": "mm"}).to_xarray()
    assert light.radius.attrs == {"units": "mm"} and light.sizes == {"row": 2}
    maps = rw.thickness({"die": rw.box(2)}, view="front", size=(5, 3)).to_xarray()
    assert maps.lengths.dims == ("z", "x", "medium") and maps.lengths.sel(medium="die").max() == pytest.approx(2)
    plate = rw.thickness({"plate": rw.box([4, 1, 2]).translate([1, 0, 0.5])}, view="front", size=(400, 300)).to_xarray()
    inside = plate.lengths.sel(medium="plate") > 0.5
    # the coordinates are those of the model, which reaches from -1 to 3 along x and to 1.5 along z
    assert [float(plate.x[inside.any("z")].min()), float(plate.z[inside.any("x")].max())] == pytest.approx([-1, 1.5], abs=0.03)
    assert plate.x.attrs == {"units": "mm"} and plate.z[0] > plate.z[-1]
    block = rw.box([1, 2, 3]).translate([10, 20, 30])
    for view, right, up in (("back", "-x", "z"), ("left", "-y", "z"), ("right", "y", "z"), ("top", "x", "y"), ("bottom", "x", "-y")):
        maps = rw.thickness(rw.Region("block", block), view=view, size=(30, 30)).to_xarray()
        assert maps.radiograph.dims == (up[-1], right[-1]), view
        for axis, is_right in ((right, True), (up, False)):
            values = maps[axis[-1]].values
            assert values.mean() == pytest.approx({"x": 10, "y": 20, "z": 30}[axis[-1]])
            assert (values[0] < values[-1]) == (is_right == (len(axis) == 1)), view
    turned = rw.thickness(block, view="iso", size=(5, 5)).to_xarray()
    assert turned.radiograph.dims == ("y", "x") and turned.x.mean() == pytest.approx(0)
    assert rw.section(A, "z=0").to_xarray().area.values == pytest.approx(math.pi, rel=1e-3)
    assert rw.check({"a": A, "b": A.translate([0.5, 0, 0])}, cells=8).to_xarray().sizes["row"] >= 1
    assert rw.measure(B).to_xarray().sizes["row"] == 1


def test_maps_of_thickness_are_tables():
    found = rw.thickness({"die": rw.box(2)}, view="front", size=(5, 3))
    table = found.to_pandas()
    assert table.shape == (15, 3) and table["die"].max() == pytest.approx(2)
    assert found.to_arrow().num_rows == 15 and "<img" in found._repr_html_()


def test_sections_are_saved_and_shown(tmp_path, monkeypatch):
    cut = rw.section(A, "z=0")
    cut.save(tmp_path / "cut.svg", title="ball")
    cut.save(tmp_path / "cut.dxf")
    assert (tmp_path / "cut.svg").read_text().startswith("<svg") and (tmp_path / "cut.dxf").exists()
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    cut.show()
    assert len(opened) == 1 and opened[0].endswith(".svg")


def test_centres_and_boxes():
    prism = rw.from_polygons([[[0, 0], [2, 0], [0, 4]]])
    assert prism.bounds.tolist() == [[0, 0], [2, 4]]
    np.testing.assert_allclose(TETRAHEDRON.to_mesh().centroid, [0.25] * 3, rtol=1e-12)
    assert rw.Model({"a": A}).bounds.tolist() == [[-1] * 3, [1] * 3]


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda m: m.crossings([0, 0, 0], [1, 0, 0])["surfce"], KeyError, "Did you mean surface\\?"),
        (lambda m: m.crossings([0, 0, 0], [1, 0, 0], evaluator="packet"), rw.RayweaveError, "Did you mean `packets`"),
        (lambda m: rw.render(m, view="frnt"), rw.RayweaveError, "Did you mean `front`"),
        (lambda m: rw.thickness(m, view="frnt"), rw.RayweaveError, "Did you mean `front`"),
        (lambda m: rw.Model({"a": rw.box(1)}, unit="milimeter"), rw.RayweaveError, "Did you mean 'mm'"),
        (lambda m: rw.Model({"a": rw.box(1)}, unit="Inch"), rw.RayweaveError, "Did you mean 'in'"),
        (lambda m: m["steel"], KeyError, "`steel` is the medium of the region `insert`"),
        (lambda m: m.partition(np.zeros((3, 7)), [1, 0, 0]), rw.RayweaveError, "Is it transposed"),
        (lambda m: m.partition(None, [1, 0, 0]), TypeError, "origins is None"),
        (lambda m: m.partition(np.ma.masked_array(np.zeros((2, 3)), mask=True), [1, 0, 0]), TypeError, "masked array"),
        (lambda m: rw.Model({"a": rw.box(1)}, {"a": {"attenuation": -0.2}}), rw.RayweaveError, "finite and at least 0"),
    ],
)
def test_mistakes_of_a_first_day(call, kind, message):
    model = rw.Model([rw.Region("insert", rw.box(2), medium="steel")])
    with pytest.raises(kind, match=message):
        call(model)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: s.hits([0, 0, -3], [0, 0, 1], tmax=5), "Did you mean t_max?"),
        (lambda s: s.nearest([0, 0, -3], [0, 0, 1], t_mx=5), "Did you mean t_max?"),
        (lambda s: s.crossings([0, 0, -3], [0, 0, 1], tmin=5), "Did you mean t_min?"),
        (lambda s: s.contains([0, 0, -3], thread=2), "Did you mean threads?"),
        (lambda s: s.distance([0, 0, -3], precison=2), "Did you mean precision?"),
        (lambda s: rw.Model({"a": s}).partition([0, 0, -3], [0, 0, 1], tmax=5), "Did you mean t_max?"),
    ],
)
def test_keywords_of_queries_are_suggested(call, message):
    with pytest.raises(TypeError) as raised:
        call(A)
    assert message in str(raised.value)


def test_queries_keep_their_texts_and_other_errors():
    assert rw.Solid.hits.__doc__ and rw.Solid.hits.__name__ == "hits"
    with pytest.raises(TypeError, match="missing 1 required positional argument"):
        A.hits([0, 0, -3])


def test_one_direction_belongs_to_all_origins():
    origins = np.array([[0.0, 0, 0], [0, 1, 0], [0, 2, 0]])
    found = rw.optics.source_of_rays(origins, [0, 0, 1]).rays()
    assert found[0].tolist() == origins.tolist() and found[1].tolist() == [[0, 0, 1]] * 3
    assert len(rw.optics.source_of_rays([0, 0, 0], [[0, 0, 1], [0, 1, 1]])) == 2
    with pytest.raises(rw.RayweaveError, match="directions"):
        rw.optics.source_of_rays(origins, [0, 1])


def test_meshes_of_touching_regions_are_described_one_by_one():
    both = rw.Model({"left": rw.box(2), "right": rw.box(2).translate(2, 0, 0)}).to_mesh()
    lines = both.describe().splitlines()
    assert lines[0] == '24 triangles, 16 vertices, 2 regions. to_mesh(by="region") returns a mesh for each.'
    assert lines[1:] == [f"{name}: 12 triangles, 8 vertices, 1 shell" for name in ("left", "right")]
    apart = rw.Model({"left": rw.box(2), "right": rw.box(2).translate(3, 0, 0)}).to_mesh()
    assert apart.describe() == "24 triangles, 16 vertices, 2 shells"


def test_weights_of_goals_are_named():
    with pytest.raises(TypeError, match=r"Did you mean weight\?"):
        rw.optics.goal("spot", field=0, weights=[1])
