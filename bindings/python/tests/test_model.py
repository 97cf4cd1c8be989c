"""Models: files, regions, media, partitions, saving and pickling."""

import copy
import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest

import rayweave as rw

TEXT = """
rayweave = 1
unit = "mm"

[parameters]
R = 2.0

[solid.body]
box = { size = "2 * R" }

[solid.core]
sphere = { radius = "R / 2" }

[[region]]
solid = "body"
medium = "glass"

[[region]]
solid = "core"
medium = "water"

[medium.glass]
index = 1.5

[medium.water]
index = 1.33
"""

MODELS = sorted((Path(__file__).parents[3] / "models").glob("*.toml"))

X = np.array([1.0, 0.0, 0.0])
START = np.array([-5.0, 0.0, 0.0])


@pytest.fixture
def model():
    return rw.loads(TEXT)


def test_parts(model):
    assert list(model.solids) == ["body", "core"]
    assert [region.name for region in model.regions] == ["body", "core"]
    assert [medium.name for medium in model.media] == ["world", "glass", "water"]
    assert model.media[1].index == 1.5
    assert model.parameters == {"R": 2.0} and model.unit == "mm"


def test_crossings_name_media(model):
    found = model.crossings(START, X)
    assert np.array_equal(found.t, [3, 4, 6, 7])
    names = np.array(found.medium_names)
    assert list(names[found.medium_before]) == ["world", "glass", "water", "glass"]
    assert list(names[found.medium_after]) == ["glass", "water", "glass", "world"]
    assert list(found.enters) == [True, True, True, False]
    first = model.nearest(START, X)
    assert first.t == 3 and first.medium_after == 1


def test_hits_are_where_any_medium_begins_and_ends(model):
    assert np.array_equal(model.hits(START, X)[:, 0], [3, 7])
    assert bool(model.contains([1.5, 0, 0])) and not model.contains([5.0, 0, 0])
    assert np.array_equal(model.bounds, [[-2, -2, -2], [2, 2, 2]])


def test_partition_has_a_piece_for_each_medium(model):
    pieces = model.partition(np.stack([START, START + [0, 9, 0]]), X)
    first, last = pieces.offsets[0], pieces.offsets[1]
    names = np.array(pieces.medium_names)
    assert list(names[pieces.medium[first:last]]) == ["world", "glass", "water", "glass", "world"]
    assert pieces.offsets[2] - last == 1


@pytest.mark.parametrize("evaluator", ["packets", "weave", "reference", "single_hit"])
def test_every_evaluator_gives_the_same(model, evaluator):
    rng = np.random.default_rng(3)
    origins, directions = rng.normal(size=(50, 3)) * 4, rng.normal(size=(50, 3))
    ours = model.crossings(origins, directions, evaluator=evaluator)
    weave = model.crossings(origins, directions)
    assert np.array_equal(ours.t, weave.t) and np.array_equal(ours.surface, weave.surface)


def test_unknown_evaluators_are_refused(model):
    with pytest.raises(rw.RayweaveError, match="must be one of 'packets'"):
        model.hits(START, X, evaluator="wave")


def test_parameters_can_be_replaced():
    assert rw.loads(TEXT, {"R": 4}).hits(START, X)[0, 0] == 1
    assert rw.loads(TEXT, {"R": "1 + 2"}).parameters == {"R": 3.0}
    with pytest.raises(rw.RayweaveError, match="R"):
        rw.loads(TEXT, {"Q": 4})


@pytest.mark.parametrize("parameters", [None, {"R": 3}])
def test_models_pickle_copy_and_compare(parameters):
    model = rw.loads(TEXT, parameters)
    again = pickle.loads(pickle.dumps(model))
    assert again == model and hash(again) == hash(model)
    assert copy.deepcopy(model) == model and copy.copy(model) == model
    assert np.array_equal(again.hits(START, X), model.hits(START, X))
    assert model != rw.loads(TEXT, {"R": 5})
    assert model != 3


def test_pickling_keeps_parameters(model):
    assert pickle.loads(pickle.dumps(model)).parameters == {"R": 2.0}


def test_saving_round_trips(model, tmp_path):
    model.save(tmp_path / "model.toml")
    assert rw.load(tmp_path / "model.toml") == model
    assert [path.name for path in tmp_path.iterdir()] == ["model.toml"]


def test_solids_save(tmp_path):
    solid = (rw.box(2) - rw.sphere(1.2)).translate([1, 2, 3]).named("part")
    solid.save(tmp_path / "part.toml")
    again = rw.load(tmp_path / "part.toml")
    rays = np.random.default_rng(1).normal(size=(40, 3))
    assert np.array_equal(again.hits(rays + [1, 2, 3], X), solid.hits(rays + [1, 2, 3], X))


def test_problems_are_reported_with_their_places(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text('rayweave = 1\n[solid.a]\nsphere = { radius = -1 }\n[solid.b]\nexpr = "a & c"\n')
    with pytest.raises(rw.RayweaveError) as caught:
        rw.load(path)
    text = str(caught.value)
    assert "bad.toml:3" in text and "bad.toml:5" in text
    with pytest.raises(FileNotFoundError, match="no such file"):
        rw.load(tmp_path / "missing.toml")
    with pytest.raises(TypeError):
        rw.load(3)


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_models_of_the_repository(path, tmp_path):
    model = rw.load(path)
    assert not model.warnings and model.regions
    again = pickle.loads(pickle.dumps(model))
    assert again == model and again.parameters == model.parameters
    rng = np.random.default_rng(5)
    lo, hi = np.nan_to_num(model.bounds, posinf=10, neginf=-10)
    origins, directions = rng.uniform(lo, hi, (200, 3)), rng.normal(size=(200, 3))
    found = model.crossings(origins, directions)
    np.testing.assert_array_equal(again.crossings(origins, directions).t, found.t)
    # the pieces tile each ray, in the media that the crossings name
    pieces = model.partition(origins, directions)
    np.testing.assert_array_equal(pieces.t_end[np.isfinite(pieces.t_end)], found.t)
    np.testing.assert_array_equal(pieces.t_start[np.isfinite(pieces.t_start)], found.t)
    np.testing.assert_array_equal(pieces.medium[np.isfinite(pieces.t_start)], found.medium_after)
    np.testing.assert_array_equal(pieces.medium[np.isfinite(pieces.t_end)], found.medium_before)
    np.testing.assert_array_equal(np.diff(pieces.offsets), np.diff(found.offsets) + 1)
    # the middle of a piece has the side that contains returns
    ends = np.nan_to_num(np.stack([pieces.t_start, pieces.t_end]), posinf=1e3, neginf=-1e3)
    finite = ends[1] - ends[0] > 1e-9
    rays = pieces.ray[finite]
    points = origins[rays] + ends[:, finite].mean(axis=0)[:, None] * directions[rays]
    np.testing.assert_array_equal(model.contains(points), pieces.medium[finite] != 0)
    for solid in model.solids.values():
        assert pickle.loads(pickle.dumps(solid)) == solid
    model.save(tmp_path / "copy.toml")
    assert rw.load(tmp_path / "copy.toml") == model


def test_there_are_models():
    assert len(MODELS) >= 10


def test_the_preparation_is_reported():
    toml = """
rayweave = 1
[solid.plate]
box = { size = [4, 4, 1] }
[solid.hole]
cylinder = { radius = 1, height = 2 }
transform = [{ translate = [9, 0, 0] }]
[solid.pin]
cylinder = { radius = 1, height = 2 }
[solid.part]
expr = "plate - (hole | pin)"
"""
    text = rw.loads(toml).preparation()
    assert "as written  plate - (hole | pin)\nas kept     plate & ~pin\n" in text
    assert "  hole: it lies outside plate: A - B with disjoint bounds.\n" in text
    assert "... and 1 more" in rw.loads(toml).preparation(lines=0)


DUMP = "difference() { cube(size = [4, 4, 4], center = true); sphere($fn = 12, r = 1); }\n"


def test_openscad_models_are_read_by_ending_or_by_name(tmp_path: Path) -> None:
    dump, text = tmp_path / "part.csg", tmp_path / "part.txt"
    dump.write_text(DUMP)
    text.write_text(DUMP)
    for model in (rw.load(dump), rw.load(text, format="openscad")):
        assert [region.name for region in model.regions] == ["model"]
        np.testing.assert_allclose(model.bounds, [[-2, -2, -2], [2, 2, 2]], rtol=1e-12)
        assert model.warnings == []
        # exactly round: the chord of a ball
        hits = model.hits([-4, 0, 0.6], [1, 0, 0])
        np.testing.assert_allclose(hits[:, 0], [2, 3.2, 4.8, 6], rtol=1e-14)
    faceted = rw.load(dump, facets=True).hits([-4, 0, 0.6], [1, 0, 0])
    assert faceted.shape == (4, 1) and 3.2 < faceted[1, 0] < 3.4
    again = pickle.loads(pickle.dumps(rw.load(dump)))
    np.testing.assert_allclose(again.hits([-4, 0, 0.6], [1, 0, 0])[:, 0], [2, 3.2, 4.8, 6], rtol=1e-14)
    with pytest.raises(rw.RayweaveError, match="unknown format 'scad'"):
        rw.load(dump, format="scad")


def test_losses_of_other_formats_are_reported(tmp_path: Path) -> None:
    path = tmp_path / "part.csg"
    path.write_text(DUMP + 'import(file = "gone.stl");\n')
    (warning,) = rw.load(path).warnings
    assert "part.csg:2:1" in warning and "no file `gone.stl`" in warning
    path.write_text(DUMP[:30])
    with pytest.raises(rw.RayweaveError, match="is missing"):
        rw.load(path)


def test_names_and_numbers_of_copies():
    text = """
    rayweave = 1
    [solid.bulb]
    sphere = { radius = 1 }
    [solid.wall]
    place = { solid = "bulb", at = [[0, 0, 0], [5, 0, 0]], name = "PMT", numbers = [17, 4] }
    """
    model = rw.loads(text)
    found = model.nearest([[0, 0, -5], [5, 0, -5]], [0, 0, 1])
    assert model.occurrence_paths(found.occurrence) == ["wall/PMT[17]/bulb", "wall/PMT[4]/bulb"]
    wall, other = model.solids["wall"], rw.loads(text.replace("17", "3")).solids["wall"]
    again = pickle.loads(pickle.dumps(wall))
    assert again == wall and hash(again) == hash(wall) and other != wall
    assert again.occurrence_paths(again.nearest([0, 0, -5], [0, 0, 1]).occurrence) == ["wall/PMT[17]/bulb"]


def test_files_elsewhere_need_permission(tmp_path: Path) -> None:
    (tmp_path / "model").mkdir()
    ball = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
    (tmp_path / "part.off").write_text(ball)
    path = tmp_path / "model" / "part.toml"
    for name in ("../part.off", str(tmp_path / "part.off")):
        text = f"rayweave = 1\n[solid.a]\nmesh = {{ file = '{name}' }}\n"
        path.write_text(text)
        with pytest.raises(rw.RayweaveError, match="outside the folder of the model.*`allow`"):
            rw.load(path)
        assert list(rw.load(path, allow=[tmp_path]).solids) == ["a"]
    with pytest.raises(rw.RayweaveError, match="outside the folder of the model"):
        rw.loads(text)
    assert list(rw.loads(text, allow=[tmp_path / "part.off"]).solids) == ["a"]


def test_warnings_are_errors_if_asked(tmp_path: Path) -> None:
    (warning,) = rw.loads("rayweave = 1").warnings
    assert "the model is empty" in warning
    with pytest.raises(rw.RayweaveError, match="the model is empty"):
        rw.loads("rayweave = 1", strict=True)
    path = tmp_path / "part.csg"
    path.write_text(DUMP + 'import(file = "gone.stl");\n')
    with pytest.raises(rw.RayweaveError, match=r"import\(\) is left out"):
        rw.load(path, strict=True)
    with pytest.raises(rw.RayweaveError, match="unknown parameter `heavy`"):
        rw.loads(TEXT.replace("index = 1.5", "index = 1.5\ndensity = 'heavy'"))


def two_boxes():
    a, b = rw.box([1, 1, 1]).translate([0.5, 0, 0]), rw.box([2, 1, 1]).translate([2, 0, 0])
    hole = rw.sphere(0.25).translate([2, 0, 0])
    regions = [rw.Region("a", a, "steel"), rw.Region("b", b, "steel"), rw.Region("hole", hole, "world")]
    return rw.Model(regions, {"steel": {"density": 7.85}})


def test_queries_by_region_separate_regions_of_one_medium():
    model = two_boxes()
    ray = [-1, 0, 0], [1, 0, 0]
    by_medium, by_region = model.crossings(*ray), model.crossings(*ray, by="region")
    assert by_medium.t.tolist() == [1, 2.75, 3.25, 4] and by_region.t.tolist() == [1, 2, 2.75, 3.25, 4]
    names = np.array(by_region.region_names)
    assert names[by_region.region_before].tolist() == ["world", "a", "b", "hole", "b"]
    assert names[by_region.region_after].tolist() == ["a", "b", "hole", "b", "world"]
    media = np.array(by_region.medium_names)
    assert media[by_region.medium_after].tolist() == ["steel", "steel", "world", "steel", "world"]
    assert by_region.enters.tolist() == [True, True, False, True, False]
    # normals point out of the solid, against the ray between two media
    assert by_region.normal[:, 0].tolist() == [-1, -1, 1, -1, 1]
    nearest = model.nearest([0.5, 0, 0], [1, 0, 0], by="region")
    assert nearest.t.tolist() == [0.5] and nearest.start_inside.tolist() == [True] and nearest.enters.tolist() == [True]
    pieces = model.partition(*ray, t_min=0, t_max=5, by="region")
    assert pieces.path_lengths("region").tolist() == [[2, 1, 1.5, 0.5]]
    assert pieces.path_lengths().tolist() == [[2.5, 2.5]]
    merged = model.partition(*ray, t_min=0, t_max=5)
    assert (pieces.by, merged.by) == ("region", "medium") and merged.path_lengths().tolist() == [[2.5, 2.5]]
    with pytest.raises(rw.RayweaveError, match=r"share a piece. Call partition\(..., by='region'\)"):
        merged.path_lengths("region")
    with pytest.raises(rw.RayweaveError, match="by is 'solid': it must be 'medium' or 'region'."):
        model.crossings(*ray, by="solid")
    with pytest.raises(rw.RayweaveError, match="by is 'solid': it must be 'medium' or 'region'."):
        pieces.path_lengths("solid")


def test_regions_at_points():
    model = two_boxes()
    points = np.array([[-1, 0, 0], [0.5, 0, 0], [1.5, 0.3, 0], [2, 0, 0.1]])
    regions = model.regions_at(points)
    assert regions.dtype == np.int32 and regions.tolist() == [0, 1, 2, 3]
    assert model.contains(points).tolist() == [False, True, True, False]
    assert model.regions_at(points.reshape(2, 2, 3)).tolist() == [[0, 1], [2, 3]]
    assert model.regions_at([2, 0, 0.1]).shape == model.contains([2, 0, 0.1]).shape


def test_models_of_booleans_equal_their_files():
    shell = rw.sphere(2).named("out") - rw.sphere(1)
    model = rw.Model([rw.Region("shell", shell, "glass")], {"glass": 1.5})
    assert rw.loads(model.to_toml()) == model
    assert pickle.loads(pickle.dumps(model)) == model
    other = rw.Model([rw.Region("shell", rw.sphere(2).named("out") - rw.sphere(1.5), "glass")], {"glass": 1.5})
    assert rw.loads(other.to_toml()) != model


def test_names_are_categories_even_if_faces_share_one():
    shell = (rw.sphere(2) - rw.sphere(1)).named("shell")
    table = shell.crossings([[-3, 0, 0], [0, 5, 0]], [1, 0, 0])
    assert len(set(table.surface_names)) < len(table.surface_names)
    column = table.to_pandas()["surface"]
    assert column.dtype == "category" and column.tolist() == ["shell.sphere.side"] * 4
    misses = shell.nearest([[-3, 0, 0], [0, 5, 0]], [1, 0, 0]).to_pandas()["surface"]
    assert misses.isna().tolist() == [False, True]


def test_parameters_are_finite():
    for value in (float("nan"), float("inf")):
        with pytest.raises(ValueError, match=r"parameters\['R'\] is (NaN|inf): it must be finite"):
            rw.loads("rayweave = 1\n[parameters]\nR = 1\n[solid.s]\nsphere = { radius = 'R' }\n", {"R": value})


def test_misspelt_numbers_of_media_warn():
    with pytest.warns(UserWarning, match="the key 'densty' of the medium 'steel' is not used. Did you mean 'density'?") as warned:
        rw.Model({"a": rw.sphere(1)}, media={"steel": {"densty": 7.85}})
    assert warned[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rw.Model({"a": rw.sphere(1)}, media={"steel": {"density": 7.85, "hardness": 3}})


def test_a_region_may_have_the_name_of_the_world():
    # volumes of GDML files are often called so
    model = rw.Model([rw.Region("world", rw.sphere(1), "x"), rw.Region("outside", rw.sphere(0.5), "x")], {"x": {}})
    pieces = model.partition([-3, 0, 0], [1, 0, 0], 0, 6, by="region")
    assert pieces.region_names == ("space outside", "world", "outside")
    table = pieces.to_pandas()
    lengths = (table["t_end"] - table["t_start"]).groupby(table["region"], observed=True).sum()
    assert lengths.to_dict() == {"space outside": 4, "world": 1, "outside": 1}
