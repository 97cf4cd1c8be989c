"""The die and the lens in PyRayT: whole arrays of rays at a time, every hit with its surface."""

import importlib.metadata

import numpy as np
from driver import serve, units
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


version = importlib.metadata.version("pyrayt")
serve("PyRayT", version, {**tasks("die", die()), **tasks("lens", lens())})
