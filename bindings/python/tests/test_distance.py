"""Signed distances and nearest points: closed forms, meshes by an independent search, bounds, and shapes of arrays."""

import numpy as np
import pytest

import rayweave as rw


def random_points(count, half, seed=0):
    return np.random.default_rng(seed).uniform(-half, half, (count, 3))


def box_distance(points, half):
    q = np.abs(points) - half
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0)


def test_a_box_has_its_closed_form():
    points = random_points(200, 3)
    found = rw.box([2, 3, 1]).distance(points)
    expected = box_distance(points, [1, 1.5, 0.5])
    assert found.is_exact.all() and len(found) == 200
    np.testing.assert_allclose(found.distance, expected, rtol=3e-9, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(found.nearest - points, axis=1), np.abs(expected), rtol=3e-9, atol=1e-12)
    # the nearest points are on the box
    np.testing.assert_allclose(box_distance(found.nearest, [1, 1.5, 0.5]), 0, atol=1e-8)
    assert (found.lower <= np.abs(expected) + 1e-12).all() and (np.abs(expected) <= found.upper + 1e-12).all()


def test_signs_are_those_of_contains():
    solid = (rw.box(2) - rw.cylinder(0.5)) | rw.torus(1.5, 0.3).rotate_x(40)
    points = random_points(300, 2.5, seed=1)
    found = solid.distance(points)
    assert ((found.distance < 0) == solid.contains(points)).all()
    # no boundary point is nearer than the lower bound: dense crossings of random rays
    rays = np.random.default_rng(2)
    surface = solid.crossings(rays.uniform(-2.5, 2.5, (20_000, 3)), rays.normal(size=(20_000, 3))).point
    for point, row in zip(points[:60], found):
        nearest = np.linalg.norm(surface - point, axis=1).min()
        assert row["lower"] <= nearest + 1e-12
        # 60,000 crossings on an area of about 40 are within 0.1 of any point of the boundary
        assert nearest <= row["upper"] + 0.1


def triangle_distance(point, a, b, c):
    """The distance of a triangle, the minimum over its plane, edges and corners."""
    normal = np.cross(b - a, c - a)
    best = min(segment_distance(point, *ends) for ends in ((a, b), (b, c), (c, a)))
    foot = point - normal * ((point - a) @ normal) / (normal @ normal)
    inside = all(np.cross(end - start, foot - start) @ normal >= 0 for start, end in ((a, b), (b, c), (c, a)))
    return min(best, np.linalg.norm(foot - point)) if inside else best


def segment_distance(point, a, b):
    t = np.clip((point - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return np.linalg.norm(a + t * (b - a) - point)


def test_meshes_by_all_triangles():
    mesh = (rw.sphere(1) - rw.box(0.8).translate([0.6, 0, 0])).to_mesh(0.05)
    corners = mesh.vertices[mesh.triangles]
    points = random_points(25, 1.5, seed=3)
    found = mesh.to_solid().distance(points)
    expected = [min(triangle_distance(point, *triangle) for triangle in corners) for point in points]
    assert (found.lower <= np.multiply(expected, 1 + 1e-12)).all() and (expected <= found.upper * (1 + 1e-12)).all()
    exact = found.is_exact
    np.testing.assert_allclose(np.abs(found.distance)[exact], np.array(expected)[exact], rtol=1e-8)
    # at an acute edge no point behind it may be found: the answer is then marked
    assert exact.sum() >= 20
    np.testing.assert_allclose(np.abs(found.distance), expected, rtol=1e-3)


def test_models_have_the_boundary_to_the_world():
    model = rw.Model({"shell": rw.sphere(2), "core": rw.sphere(1)})
    found = model.distance([[0, 0, 0.5], [0, 0, 3]])
    np.testing.assert_allclose(found.distance, [-1.5, 1], rtol=1e-12)


def test_distances_from_some_regions():
    # both of the same medium: the surface between them counts for a choice of regions only
    model = rw.Model([rw.Region("shell", rw.sphere(2), medium="glass"), rw.Region("core", rw.sphere(1), medium="glass")])
    radii = np.array([0.5, 1.25, 1.75, 2.5])
    points = np.outer(radii, [0.6, 0, 0.8])
    shell = np.maximum(radii - 2, 1 - radii)
    for regions, expected in (("shell", shell), (["core"], radii - 1), (("shell", "core"), radii - 2), (None, radii - 2)):
        found = model.distance(points, regions=regions)
        np.testing.assert_allclose(found.distance, expected, rtol=1e-9)
        assert found.is_exact.all()
    assert np.isposinf(model.distance([0, 0, 0], regions=[]).distance).all()
    with pytest.raises(rw.RayweaveError, match="no region is called `cor`: .*Did you mean `core`?"):
        model.distance(points, regions="cor")
    with pytest.raises(TypeError, match=r"unexpected keyword argument 'by'.*Did you mean regions=\[...\]"):
        model.distance(points, by="region")
    with pytest.raises(TypeError, match="regions is 3: it must be the name of a region or a list of names"):
        model.distance(points, regions=3)


def test_grids_and_tables():
    grid = np.stack(np.meshgrid(*[np.linspace(-2, 2, 4)] * 3), axis=-1)
    found = rw.sphere(1).distance(grid)
    assert len(found) == 64
    np.testing.assert_allclose(found.distance.reshape(grid.shape[:-1]), np.linalg.norm(grid, axis=-1) - 1, atol=1e-12)
    assert found.to_pandas().shape == (64, 10) and "Distances" in repr(found)
    assert rw.sphere(1).distance([2, 0, 0]).distance.tolist() == [1]
    assert len(rw.sphere(1).distance(np.zeros((0, 3)))) == 0


def test_unbounded_and_empty_solids():
    assert rw.half_space([0, 0, 1], 2).distance([0, 0, 5]).distance[0] == pytest.approx(3)
    nothing = rw.empty().distance([1, 2, 3])
    assert nothing.distance[0] == np.inf and nothing.is_exact[0] and np.isnan(nothing.nearest).all()
    assert rw.universe().distance([1, 2, 3]).distance[0] == -np.inf


def test_bad_arguments():
    with pytest.raises(rw.RayweaveError, match=r"points has shape \(2,\)"):
        rw.sphere(1).distance([1, 2])
    with pytest.raises(rw.RayweaveError, match=r"points\[1\]"):
        rw.sphere(1).distance([[0, 0, 0], [np.nan, 0, 0]])
    with pytest.raises(rw.RayweaveError, match="the precision is 0: it must be from 1e-15 to 1"):
        rw.sphere(1).distance([1, 2, 3], precision=0)
    with pytest.raises(rw.RayweaveError, match="threads is 0"):
        rw.sphere(1).distance([1, 2, 3], threads=0)


def test_threads_do_not_change_the_answer():
    points = random_points(600, 2, seed=4)
    solid = rw.box(2) - rw.sphere(1.2)
    one, three = (solid.distance(points, threads=threads) for threads in (1, 3))
    assert all(np.array_equal(one[name], three[name]) for name in ("distance", "lower", "upper", "nearest"))
