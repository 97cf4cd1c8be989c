"""This project from Python, on one thread, into arrays that are given: what the way through Python costs."""

import importlib.metadata

import numpy as np
import rayweave as rw
from driver import rays, serve


def die():
    solid = rw.box(2) & rw.sphere(1.35)
    bore = rw.cylinder(0.5)
    return solid - bore.rotate_y(90) - bore.rotate_x(90) - bore


def lens():
    return rw.sphere(50).translate((0, 0, 48)) & rw.sphere(50).translate((0, 0, -48)) & rw.cylinder(10)


def tasks(name, solid):
    def prepare(array, count):
        origins, directions = rays(array, count)
        # as many rows as are needed: the answer itself tells
        out = solid.hits(origins, directions, return_surfaces=True, threads=1)
        return origins, directions, out

    def full(prepared):
        origins, directions, out = prepared
        return solid.hits(origins, directions, return_surfaces=True, out=out, threads=1)[0]

    def first(prepared):
        origins, directions, _ = prepared
        return solid.nearest(origins, directions, threads=1)

    def first_times(prepared):
        return first(prepared).t[None, :]

    return {name + ".full": (prepare, full, full), name + ".first": (prepare, first, first_times)}


def arrays(array, count):
    first, second = (np.ascontiguousarray(half[:, :count]) for half in array)
    return first, second, np.empty((first.shape[0] + second.shape[0], count), dtype=array.dtype)


def union(arguments):
    first, second, out = arguments
    return rw.array_csg(first, second, rw.Operation.UNION, out=out, threads=1)


serve(
    "Rayweave",
    importlib.metadata.version("rayweave"),
    tasks("die", die()) | tasks("lens", lens()) | {"array_csg": (arrays, union, union)},
)
