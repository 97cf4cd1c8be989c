"""This project from Python: measures the overhead of calls from Python."""

import importlib.metadata

import numpy as np
import rayweave as rw
from driver import padded, rays, serve


def die():
    solid = rw.box(2) & rw.sphere(1.35)
    bore = rw.cylinder(0.5)
    return solid - bore.rotate_y(90) - bore.rotate_x(90) - bore


def lens():
    return rw.sphere(50).translate((0, 0, 48)) & rw.sphere(50).translate((0, 0, -48)) & rw.cylinder(10)


def tasks(name, solid):
    def full(prepared):
        origins, directions, out = prepared
        return solid.hits(origins, directions, return_surfaces=True, out=out, threads=1)[0]

    def first(prepared):
        origins, directions, _ = prepared
        return solid.nearest(origins, directions, threads=1)

    def first_times(prepared):
        return first(prepared).t[None, :]

    prepare = with_room(solid)
    return {name + ".full": (prepare, full, full), name + ".first": (prepare, first, first_times)}


def with_room(solid):
    """Prepares rays, and arrays for their hits."""

    def prepare(array, count):
        origins, directions = rays(array, count)
        # a first call determines the number of rows
        return origins, directions, solid.hits(origins, directions, return_surfaces=True, threads=1)

    return prepare


def calls(solid):
    """For each query one call for many rays: its preparation, its work, and its answer as a hit array."""

    def points(array, count):
        return (rays(array, count)[0],)

    def hits(threads):
        def work(prepared):
            origins, directions, out = prepared
            return solid.hits(origins, directions, out=out[0], threads=threads)

        return with_room(solid), work, work

    def surfaces(threads):
        def work(prepared):
            origins, directions, out = prepared
            return solid.hits(origins, directions, return_surfaces=True, out=out, threads=threads)

        return with_room(solid), work, lambda prepared: work(prepared)[0]

    def nearest(threads):
        def work(prepared):
            return solid.nearest(*prepared, threads=threads)

        return rays, work, lambda prepared: work(prepared).t[None, :]

    def crossings(threads):
        def work(prepared):
            return solid.crossings(*prepared, threads=threads)

        return rays, work, lambda prepared: table(work(prepared))

    def contains(threads):
        def work(prepared):
            return solid.contains(*prepared, threads=threads)

        return points, work, lambda prepared: np.where(work(prepared), 1.0, np.inf)[None, :]

    return {"hits": hits, "surfaces": surfaces, "nearest": nearest, "crossings": crossings, "contains": contains}


def table(crossings):
    """The times of crossings as a hit array."""
    return padded([crossings.t[a:b] for a, b in zip(crossings.offsets, crossings.offsets[1:])])


def one_by_one(solid):
    """One call per ray."""

    def pairs(array, count):
        return list(zip(*rays(array, count)))

    def task(call, times):
        def work(prepared):
            for origin, direction in prepared:
                call(origin, direction)

        def answer(prepared):
            return np.concatenate([times(call(*pair)) for pair in prepared], axis=1)

        return pairs, work, answer

    def wide(lists):
        # padded to the number of rows that suffices for every ray
        return np.concatenate([lists, np.full((12 - len(lists), 1), np.inf)])

    return {
        "hits": task(solid.hits, wide),
        "nearest": task(solid.nearest, lambda found: found.t[None, :]),
        "crossings": task(solid.crossings, lambda found: wide(found.t[:, None])),
    }


def arrays(array, count):
    first, second = (np.ascontiguousarray(half[:, :count]) for half in array)
    return first, second, np.empty((first.shape[0] + second.shape[0], count), dtype=array.dtype)


def union(threads):
    def work(arguments):
        first, second, out = arguments
        return rw.array_csg(first, second, rw.Operation.UNION, out=out, threads=threads)

    return arrays, work, work


def on_threads(name, task):
    """A task on one thread, and on the number of threads in RAYWEAVE_THREADS."""
    return {name: task(1), name + "/all": task(None)}


TASKS = tasks("die", die()) | tasks("lens", lens()) | on_threads("array_csg", union)
for name, task in calls(die()).items():
    TASKS |= on_threads("python.many." + name, task)
for name, task in one_by_one(die()).items():
    TASKS["python.one." + name] = task
serve("Rayweave", importlib.metadata.version("rayweave"), TASKS)
