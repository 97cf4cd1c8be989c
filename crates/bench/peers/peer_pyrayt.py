"""The die and the lens in PyRayT: whole arrays of rays at a time, every hit with its surface; light through a lens."""

import importlib.metadata

import numpy as np
import pyrayt
from driver import serve, units
from pyrayt import materials
from pyrayt.components import Source, baffle, biconvex_lens
from tinygfx import g3d as cg


def die():
    solid = cg.csg.intersect(cg.Cuboid.from_length(2), cg.Sphere(1.35))
    for turned in (cg.Cylinder(0.5, -2, 2).rotate_y(90), cg.Cylinder(0.5, -2, 2).rotate_x(90), cg.Cylinder(0.5, -2, 2)):
        solid = cg.csg.difference(solid, turned)
    return solid


def lens():
    caps = cg.csg.intersect(cg.Sphere(50).move_z(48), cg.Sphere(50).move_z(-48))
    return cg.csg.intersect(caps, cg.Cylinder(10, -5, 5))


def prepare(array, count):
    origins, directions, lengths = units(array, count)
    rays = np.zeros((2, 4, count))
    rays[0, :3], rays[0, 3], rays[1, :3] = origins.T, 1, directions.T
    return rays, lengths


def tasks(name, solid):
    def work(prepared):
        return solid.intersect(prepared[0])

    def answer(prepared):
        return work(prepared)[0] / prepared[1]

    return {name + ".full": (prepare, work, answer)}


class Given(Source):
    """The given rays, rotated so that the optical axis z becomes x, the axis of PyRayT's components."""

    def __init__(self, origins, directions):
        super().__init__()
        self.given = (origins, directions)

    def _local_ray_generation(self, n_rays):
        rays = pyrayt.RaySet(n_rays)
        for part, vectors in zip(rays.rays, self.given):
            part[:3] = vectors[:, [2, 0, 1]].T
        return rays


def prepare_light(array, count):
    origins, directions, _ = units(array, count)
    lens = biconvex_lens(50, 50, 4, aperture=20, material=materials.BasicRefractor(1.5))
    return pyrayt.RayTracer(Given(origins, directions), [lens, baffle((40, 40)).move_x(50)], rays_per_source=count)


def ends(tracer):
    table = tracer.trace()
    return table[table.generation == table.generation.max()].sort_values("id")[["y1", "z1", "x1"]].to_numpy().T


version = importlib.metadata.version("pyrayt")
serve("PyRayT", version, {
    **tasks("die", die()),
    **tasks("lens", lens()),
    "optics.trace": (prepare_light, pyrayt.RayTracer.trace, ends),
})
