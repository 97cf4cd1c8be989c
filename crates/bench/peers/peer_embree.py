"""The die as a mesh: made by manifold3d, whose spheres and cylinders have 512 sides, and traced by Embree (float32)."""

import importlib.metadata

import manifold3d as m
import numpy as np
from driver import serve, units
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

SIDES = 512


def die():
    solid = m.Manifold.cube((2, 2, 2), True) ^ m.Manifold.sphere(1.35, SIDES)
    for turn in ((0, 90, 0), (90, 0, 0), (0, 0, 0)):
        solid = solid - m.Manifold.cylinder(4, 0.5, 0.5, SIDES, True).rotate(turn)
    mesh = solid.to_mesh()
    scene = EmbreeScene()
    vertices = np.ascontiguousarray(mesh.vert_properties[:, :3], dtype=np.float32)
    triangles = TriangleMesh(scene, vertices, np.ascontiguousarray(mesh.tri_verts, dtype=np.int32))
    return scene, triangles


SCENE, _MESH = die()


def prepare(array, count):
    origins, directions, lengths = units(array, count)
    return origins.astype(np.float32), directions.astype(np.float32), lengths


def first(prepared):
    return SCENE.run(prepared[0], prepared[1], query="DISTANCE")


def first_times(prepared):
    t = np.asarray(first(prepared), dtype=float)
    return np.where(t < 1e30, t, np.inf)[None, :] / prepared[2]


serve("Embree", importlib.metadata.version("embreex"), {"die.first": (prepare, first, first_times)})
