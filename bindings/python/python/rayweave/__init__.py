"""Exact ray tracing through constructive solid geometry."""

from rayweave import rootray
from rayweave._core import RayweaveError, RootRay
from rayweave._hit_array import Operation, array_csg, count_array

__all__ = [
    "Operation",
    "RayweaveError",
    "RootRay",
    "array_csg",
    "count_array",
    "rootray",
]
