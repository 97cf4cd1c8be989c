"""Measures tasks that users of other Python packages have, in one run, for docs/comparison.md.

    pip install raysect trimesh embreex manifold3d optiland scipy bindings/python
    python crates/bench/peers/comparison.py

Processor times of one thread; the least of three runs. The script prints rates and the largest differences. A package that is
not installed is left out.
"""

import importlib.metadata
import os
import platform
from time import process_time

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import rayweave as rw

RAYS = 100_000


def least(work, repeats=3):
    """The least processor time of some runs, and the last result."""
    times = []
    for _ in range(repeats):
        started = process_time()
        result = work()
        times.append(process_time() - started)
    return min(times), result


def report(task, name, count, seconds, remark=""):
    print(f"{task:28} {name:44} {count / seconds:14,.0f} /s  {remark}", flush=True)


def version(name):
    return f"{name} {importlib.metadata.version(name)}"


def light():
    """Rays from a sphere of radius 5 to points of the box around the die."""
    rng = np.random.default_rng(1)
    start = rng.normal(size=(RAYS, 3))
    start *= 5 / np.linalg.norm(start, axis=1)[:, None]
    way = rng.uniform(-1, 1, (RAYS, 3)) - start
    return start, way / np.linalg.norm(way, axis=1)[:, None]


def die_rayweave():
    bore = rw.cylinder(0.5)
    return (rw.box(2) & rw.sphere(1.35)) - bore.rotate_y(90) - bore.rotate_x(90) - bore


def die_mesh(sides):
    """The die as triangles, by manifold3d."""
    import manifold3d as m
    import trimesh

    solid = m.Manifold.cube((2, 2, 2), True) ^ m.Manifold.sphere(1.35, sides)
    for turn in ((0, 90, 0), (90, 0, 0), (0, 0, 0)):
        solid = solid - m.Manifold.cylinder(4, 0.5, 0.5, sides, True).rotate(turn)
    mesh = solid.to_mesh()
    return trimesh.Trimesh(mesh.vert_properties[:, :3], mesh.tri_verts, process=False)


def first_hits(start, way):
    """The distance to the first crossing of each ray with the die."""
    task, die = "first crossing, die", die_rayweave()
    seconds, exact = least(lambda: die.nearest(start, way, threads=1).t)
    report(task, version("rayweave"), RAYS, seconds)
    both = np.isfinite(exact)

    try:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        mesh = die_mesh(512)
        scene = EmbreeScene()
        vertices, faces = mesh.vertices.astype(np.float32), mesh.faces.astype(np.int32)
        kept = TriangleMesh(scene, np.ascontiguousarray(vertices), np.ascontiguousarray(faces))
        single = start.astype(np.float32), way.astype(np.float32)
        seconds, found = least(lambda: scene.run(*single, query="DISTANCE"))
        seen = both & (found < 1e30)
        remark = f"{len(faces)} triangles, float32; largest difference {np.abs(found - exact)[seen].max():.1e}"
        report(task, f"Embree, {version('embreex')}", RAYS, seconds, remark)
        del kept

        mesh.ray.intersects_first(start[:10], way[:10])
        seconds, _ = least(lambda: mesh.ray.intersects_first(start, way))
        report(task, f"{version('trimesh')} with Embree, index of the triangle", RAYS, seconds)
    except ImportError as error:
        print(f"left out: {error}")

    try:
        from raysect.core import AffineMatrix3D, Point3D, Ray, Vector3D, rotate_x, rotate_y, translate
        from raysect.primitive import Box, Cylinder, Intersect, Sphere, Subtract

        core = Intersect(Box(Point3D(-1, -1, -1), Point3D(1, 1, 1)), Sphere(1.35))
        for turn in (rotate_y(90), rotate_x(90), AffineMatrix3D()):
            core = Subtract(core, Cylinder(0.5, 4.0, transform=turn * translate(0, 0, -2)))
        rays = [Ray(Point3D(*a), Vector3D(*b)) for a, b in zip(start.tolist(), way.tolist(), strict=True)]
        seconds, hits = least(lambda: [core.hit(ray) for ray in rays])
        found = np.array([np.inf if hit is None else hit.ray_distance for hit in hits])
        worst = np.abs(found - exact)[both].max()
        report(task, version("raysect"), RAYS, seconds, f"largest difference {worst:.1e}, misses {(np.isfinite(found) != both).sum()}")
    except ImportError as error:
        print(f"left out: {error}")


def all_hits(start, way):
    """All crossings with the die."""
    task, die = "all crossings, die", die_rayweave()
    seconds, exact = least(lambda: die.hits(start, way, threads=1))
    report(task, version("rayweave"), RAYS, seconds)
    total = np.isfinite(exact).sum()
    try:
        mesh = die_mesh(512)
        mesh.ray.intersects_location(start[:10], way[:10], multiple_hits=True)
        seconds, found = least(lambda: mesh.ray.intersects_location(start, way, multiple_hits=True), 1)
        remark = f"{len(found[0])} crossings; exact solid {total}"
        report(task, f"{version('trimesh')} with Embree", RAYS, seconds, remark)
    except ImportError as error:
        print(f"left out: {error}")


def volumes():
    """The volume of the die."""
    measured = rw.measure(die_rayweave(), precision=1e-4, threads=1)
    print(f"volume by Rayweave {measured.volume[0]:.6f} +- {measured.volume_half_width[0]:.6f}")
    try:
        for sides in (64, 512):
            mesh = die_mesh(sides)
            print(f"volume of the mesh of manifold3d with {sides} sides: {mesh.volume:.6f}, {len(mesh.faces)} triangles")
    except ImportError as error:
        print(f"left out: {error}")


def triplet():
    """A Cooke triplet, the field at 20 degrees, 550 nm."""
    from rayweave.optics import Prescription, Surface, pupil_grid

    lens = Prescription(
        [
            Surface(22.01359, 3.25896, "N-SK16"),
            Surface(-435.76044, 6.00755),
            Surface(-22.21328, 0.99997, "F2"),
            Surface(20.29192, 4.75041),
            Surface(79.68360, 2.95208, "N-SK16"),
            Surface(-18.39533, 42.20778),
        ],
        stop=4,
        entrance_pupil_diameter=10.0,
        fields=[0, 14, 20],
        wavelengths_nm=[550],
    )
    task = "rays through a triplet"
    rings = 182
    # points that are given count equally, as those of Optiland
    pupil = pupil_grid("hexapolar", rings)
    seconds, rays = least(lambda: lens.arrivals(2, pupil=pupil))
    report(task, version("rayweave"), len(rays["x"]), seconds, f"RMS radius {rays.spot().rms * 1e3:.4f} um")
    try:
        from optiland.samples.objectives import CookeTriplet

        other = CookeTriplet()
        work = lambda: other.trace(Hx=0, Hy=1, wavelength=0.55, num_rays=rings, distribution="hexapolar")
        seconds, rays = least(work)
        x, y = np.asarray(rays.x), np.asarray(rays.y)
        rms = np.sqrt(((x - x.mean()) ** 2 + (y - y.mean()) ** 2).mean())
        report(task, version("optiland"), len(x), seconds, f"RMS radius {rms * 1e3:.4f} um")
    except ImportError as error:
        print(f"left out: {error}")


if __name__ == "__main__":
    print(platform.platform(), platform.python_version())
    print(next((line.strip() for line in open("/proc/cpuinfo", encoding="utf-8") if "model name" in line), platform.processor()))
    print("load", os.getloadavg()[0])
    batch = light()
    first_hits(*batch)
    all_hits(*batch)
    volumes()
    triplet()
