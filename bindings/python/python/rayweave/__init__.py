"""Exact ray tracing through constructive solid geometry."""

from rayweave import rootray
from rayweave._answers import Crossings
from rayweave._core import (
    RayweaveError,
    RootRay,
    Solid,
    intersection,
    place,
    plenum,
    union,
    vacuum,
)
from rayweave._hit_array import Operation, array_csg, count_array
from rayweave._shapes import (
    box,
    box_from_corners,
    cone,
    convex,
    cylinder,
    ellipsoid,
    half_space,
    paraboloid,
    prism,
    quadric,
    slab,
    sphere,
    torus,
    tube,
    wedge,
)

__all__ = [
    "Crossings",
    "Operation",
    "RayweaveError",
    "RootRay",
    "Solid",
    "array_csg",
    "box",
    "box_from_corners",
    "cone",
    "convex",
    "count_array",
    "cylinder",
    "ellipsoid",
    "half_space",
    "intersection",
    "paraboloid",
    "place",
    "plenum",
    "prism",
    "quadric",
    "rootray",
    "slab",
    "sphere",
    "torus",
    "tube",
    "union",
    "vacuum",
    "wedge",
]
