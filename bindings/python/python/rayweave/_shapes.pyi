# Generated from the registry of primitives: run `cargo xtask generated --accept` instead of editing.

from numpy.typing import ArrayLike

from rayweave._core import Solid

__all__ = [
    "asphere",
    "biconic",
    "box",
    "box_from_corners",
    "cone",
    "convex",
    "cylinder",
    "ellipsoid",
    "freeform",
    "half_space",
    "mesh",
    "paraboloid",
    "prism",
    "quadric",
    "slab",
    "sphere",
    "torus",
    "tube",
    "wedge",
]

def asphere(
    aperture: float,
    curvature: float,
    conic: float = ...,
    even: ArrayLike = ...,
    odd: ArrayLike = ...,
    height: float = ...,
) -> Solid: ...
def biconic(
    aperture: float,
    curvature_x: float,
    curvature_y: float,
    conic_x: float = ...,
    conic_y: float = ...,
    height: float = ...,
) -> Solid: ...
def box(
    size: float | ArrayLike,
) -> Solid: ...
def box_from_corners(
    lo: ArrayLike,
    hi: ArrayLike,
) -> Solid: ...
def cone(
    radius1: float,
    radius2: float,
    height: float,
) -> Solid: ...
def convex(
    planes: ArrayLike,
) -> Solid: ...
def cylinder(
    radius: float,
    height: float = ...,
) -> Solid: ...
def ellipsoid(
    radii: ArrayLike,
) -> Solid: ...
def freeform(
    aperture: float,
    curvature: float = ...,
    conic: float = ...,
    xy: ArrayLike = ...,
    zernike: ArrayLike = ...,
    norm_radius: float = ...,
    height: float = ...,
) -> Solid: ...
def half_space(
    normal: ArrayLike,
    offset: float,
) -> Solid: ...
def mesh(
    vertices: ArrayLike,
    faces: ArrayLike,
) -> Solid: ...
def paraboloid(
    focal_length: float,
    height: float = ...,
) -> Solid: ...
def prism(
    sides: int,
    radius: float,
    height: float,
) -> Solid: ...
def quadric(
    matrix: ArrayLike,
) -> Solid: ...
def slab(
    normal: ArrayLike,
    lo: float,
    hi: float,
) -> Solid: ...
def sphere(
    radius: float,
) -> Solid: ...
def torus(
    major: float,
    minor: float,
) -> Solid: ...
def tube(
    outer_radius: float,
    inner_radius: float,
    height: float,
) -> Solid: ...
def wedge(
    start_degrees: float,
    sweep_degrees: float,
) -> Solid: ...
