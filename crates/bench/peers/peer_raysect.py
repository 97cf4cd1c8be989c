"""The die and the lens in Raysect: one call per ray, as users of Raysect write it."""

import raysect
from driver import padded, serve, units
from raysect.core import AffineMatrix3D, Point3D, Ray, Vector3D, rotate_x, rotate_y, translate
from raysect.primitive import Box, Cylinder, Intersect, Sphere, Subtract


def die():
    core = Intersect(Box(Point3D(-1, -1, -1), Point3D(1, 1, 1)), Sphere(1.35))
    down = translate(0, 0, -2)
    for turn in (rotate_y(90), rotate_x(90), AffineMatrix3D()):
        core = Subtract(core, Cylinder(0.5, 4.0, transform=turn * down))
    return core


def lens():
    caps = Intersect(Sphere(50, transform=translate(0, 0, 48)), Sphere(50, transform=translate(0, 0, -48)))
    return Intersect(caps, Cylinder(10, 10, transform=translate(0, 0, -5)))


def prepare(array, count):
    origins, directions, lengths = units(array, count)
    pairs = zip(origins.tolist(), directions.tolist())
    return [Ray(Point3D(*origin), Vector3D(*direction)) for origin, direction in pairs], lengths


def tasks(name, solid):
    def full(ray):
        times = []
        hit = solid.hit(ray)
        while hit is not None:
            times.append(hit.ray_distance)
            hit = solid.next_intersection()
        return times

    def first(ray):
        hit = solid.hit(ray)
        return [] if hit is None else [hit.ray_distance, hit.normal]

    def run(ask):
        def work(prepared):
            for ray in prepared[0]:
                ask(ray)

        return work

    def all_times(prepared):
        return padded([full(ray) for ray in prepared[0]]) / prepared[1]

    def first_times(prepared):
        return padded([first(ray)[:1] for ray in prepared[0]]) / prepared[1]

    return {
        name + ".full": (prepare, run(full), all_times),
        name + ".first": (prepare, run(first), first_times),
    }


serve("Raysect", raysect.__version__, tasks("die", die()) | tasks("lens", lens()))
