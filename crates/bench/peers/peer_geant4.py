"""The die in Geant4 through geant4-pybind: each call returns the distance to the next boundary."""

import importlib.metadata
import os
import sys

# imported first: it redirects the output of the other modules
from driver import padded, serve, units

# answer "no" to the prompt of the module to download data, which solids do not need
_orders = os.dup(0)
_read, _write = os.pipe()
os.write(_write, b"n\n" * 8)
os.close(_write)
os.dup2(_read, 0)
import geant4_pybind as g4  # noqa: E402

# a new object, because the buffer of the old one may contain unused answers to the prompt
sys.stdin = os.fdopen(_orders)


def die():
    core = g4.G4IntersectionSolid("core", g4.G4Box("box", 1, 1, 1), g4.G4Orb("ball", 1.35))
    right = 1.5707963267948966
    for name, x, y in (("x", 0, right), ("y", right, 0), ("z", 0, 0)):
        turn = g4.G4RotationMatrix()
        turn.rotateX(x)
        turn.rotateY(y)
        bore = g4.G4Tubs("bore " + name, 0, 0.5, 2, 0, 2 * 3.141592653589793)
        core = g4.G4SubtractionSolid("die " + name, core, bore, g4.G4Transform3D(turn, g4.G4ThreeVector()))
    return core


SOLID = die()
FAR = 1e99


def prepare(array, count):
    origins, directions, lengths = units(array, count)
    vector = g4.G4ThreeVector
    pairs = zip(origins.tolist(), directions.tolist())
    return [(vector(*origin), vector(*direction)) for origin, direction in pairs], lengths


def full(place, direction):
    t, times = 0.0, []
    while True:
        step = SOLID.DistanceToIn(place, direction)
        if step > FAR:
            return times
        t += step
        times.append(t)
        place = place + direction * step
        step = SOLID.DistanceToOut(place, direction)
        t += step
        times.append(t)
        place = place + direction * step


def first(place, direction):
    step = SOLID.DistanceToIn(place, direction)
    if step > FAR:
        return []
    return [step, SOLID.SurfaceNormal(place + direction * step)]


def run(ask):
    def work(prepared):
        for place, direction in prepared[0]:
            ask(place, direction)

    return work


def all_times(prepared):
    return padded([full(*ray) for ray in prepared[0]]) / prepared[1]


def first_times(prepared):
    return padded([first(*ray)[:1] for ray in prepared[0]]) / prepared[1]


version = "geant4-pybind-" + importlib.metadata.version("geant4-pybind")
serve("Geant4", version, {"die.full": (prepare, run(full), all_times), "die.first": (prepare, run(first), first_times)})
