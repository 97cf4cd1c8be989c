"""Exact ray tracing through constructive solid geometry."""

from importlib.metadata import version

from rayweave import optics, photons, rootray, space
from rayweave._answers import Crossings, ModelCrossings, Partition
from rayweave._check import Check, Finding, check
from rayweave._convert import convert
from rayweave._core import (
    Explanation,
    Model,
    Polygons,
    RayweaveError,
    RootRay,
    Section,
    Solid,
    from_polygons,
    intersection,
    load,
    loads,
    place,
    universe,
    union,
    empty,
)
from rayweave._diff import Diff, diff
from rayweave._drawing import Drawing
from rayweave._explain import Entry, Operand, Passage, Question
from rayweave._hit_array import Operation, array_csg, count_array
from rayweave._infill import infill
from rayweave._measure import Measurement, measure
from rayweave._model import Medium, Region
from rayweave._picture import Camera, render, sheet
from rayweave._section import save_section, section
from rayweave._shapes import (
    asphere,
    biconic,
    box,
    box_from_corners,
    cone,
    convex,
    cylinder,
    ellipsoid,
    freeform,
    half_space,
    mesh,
    paraboloid,
    prism,
    quadric,
    slab,
    sphere,
    torus,
    tube,
    wedge,
)
from rayweave._thickness import Thickness, thickness
from rayweave._timeline import Timeline, ray_timeline, timeline

__version__ = version("rayweave")

__all__ = [
    "Camera",
    "Check",
    "Crossings",
    "Diff",
    "Drawing",
    "Entry",
    "Explanation",
    "Finding",
    "Measurement",
    "Medium",
    "Model",
    "ModelCrossings",
    "Operand",
    "Operation",
    "Partition",
    "Passage",
    "Polygons",
    "Question",
    "RayweaveError",
    "Region",
    "RootRay",
    "Section",
    "Solid",
    "Thickness",
    "Timeline",
    "array_csg",
    "asphere",
    "biconic",
    "box",
    "box_from_corners",
    "check",
    "cone",
    "convert",
    "convex",
    "count_array",
    "cylinder",
    "diff",
    "ellipsoid",
    "freeform",
    "from_polygons",
    "half_space",
    "infill",
    "intersection",
    "load",
    "loads",
    "measure",
    "mesh",
    "optics",
    "paraboloid",
    "photons",
    "place",
    "universe",
    "prism",
    "quadric",
    "ray_timeline",
    "render",
    "rootray",
    "save_section",
    "section",
    "sheet",
    "slab",
    "space",
    "sphere",
    "thickness",
    "timeline",
    "torus",
    "tube",
    "union",
    "empty",
    "wedge",
]
