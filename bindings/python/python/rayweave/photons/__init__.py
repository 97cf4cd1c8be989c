"""Optical photons in detectors: Geant4's physics in exact geometry, from GDML files to arrays of hits.

Lengths are in mm, times in ns, energies in eV and wavelengths in nm.

>>> import rayweave.photons
>>> detector = rayweave.photons.load("bar.gdml")
>>> run = detector.simulate(rayweave.photons.point([0, 0, 0], 550), n=10_000)
>>> run.hits.position.shape, run.ends["detected"]
((545, 3), 545)
"""

from rayweave.photons._compare import Bin, Comparison, FirstDifference, Quantity, compare
from rayweave.photons._detector import Detector, Findings, Material, Property, ScintillationComponent, Surface, load, loads
from rayweave.photons._run import Histories, History, Hits, Run, Sequences
from rayweave.photons._sources import (
    Source,
    disc,
    from_optics,
    from_opticks,
    gensteps,
    line,
    photons,
    point,
    surface,
    volume,
)
from rayweave.photons._tables import SurfaceTables

__all__ = [
    "Bin",
    "Comparison",
    "Detector",
    "Findings",
    "FirstDifference",
    "Histories",
    "History",
    "Hits",
    "Material",
    "Property",
    "Quantity",
    "Run",
    "ScintillationComponent",
    "Sequences",
    "Source",
    "Surface",
    "SurfaceTables",
    "compare",
    "disc",
    "from_opticks",
    "from_optics",
    "gensteps",
    "line",
    "load",
    "loads",
    "photons",
    "point",
    "surface",
    "volume",
]
