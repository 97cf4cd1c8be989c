"""Exact ray tracing through constructive solid geometry.

Shapes are functions, and operators combine them: ``|`` union, ``&`` intersection, ``-`` difference, ``^`` symmetric
difference, ``~`` complement. Lengths have any unit you like; angles are in degrees.

>>> import rayweave as rw
>>> die = (rw.box(2) & rw.sphere(1.35)) - rw.cylinder(0.5)
>>> die.translate([0, 0, 5]).rotate_z(45).bounds.shape
(2, 3)
>>> rw.box(2) - rw.cylinder(0.5).rotate_x(90)
box(size=[2, 2, 2]) - cylinder(radius=0.5).rotate_x(90)

Rays are arrays of origins and directions, which are broadcast against each other. `nearest` returns the first crossing
of each ray, `crossings` all of them, `hits` only their times:

>>> found = die.nearest([[-5, 0.8, 0], [-5, 3, 0]], [1, 0, 0])
>>> found.t
array([ 4., inf])
>>> die.hits([-5, 0.8, 0], [1, 0, 0]).ravel()
array([4., 6.])

`distance` returns the signed distances of points, negative inside, with the nearest points of the surface:

>>> die.distance([[0, 0, 3], [0.8, 0, 0]]).distance.round(3)
array([ 2.062, -0.2  ])

A `Model` has regions, each a solid made of a medium. Later regions have priority where solids overlap:

>>> model = rw.Model(
...     regions=[
...         rw.Region("tank", rw.box([10, 10, 4]), medium="water", colour="deepskyblue"),
...         rw.Region("ball", rw.sphere(1.5), medium="glass", colour="#e0c060"),
...     ],
...     media={"water": {"index": 1.33, "density": 1.0}, "glass": {"index": 1.5, "density": 2.5}},
... )
>>> [(piece["medium"], piece["t_end"] - piece["t_start"]) for piece in model.partition([0, 0, -9], [0, 0, 1], 0)][1:4]
[('water', 0.5), ('glass', 3.0), ('water', 0.5)]

Tables of results have `to_pandas`, `to_arrow` and `to_xarray`; pictures and drawings have `save` and `show`:

>>> rw.render(model, size=(320, 240)).save("tank.png")
>>> rw.measure(model).to_pandas()[["regions", "media"]]
  regions  media
0    tank  water
1    ball  glass
>>> rw.section(model, "z=0").names
['water', 'glass']
>>> remarks = model.save("tank.3mf")

========== ==========================================================================================================
shapes     `sphere`, `box`, `cylinder`, `cone`, `torus`, `mesh`, `extrude`, `revolve`, ...: ``help(rayweave.cone)``
files      `load`, `loads`, `load_mesh`, `Model.save`, `convert`: model files, OpenSCAD, GDML, STL, OBJ, PLY, OFF, 3MF, glTF
questions  `measure`, `check`, `section`, `thickness`, `diff`, `infill`, `Solid.distance`, `Solid.explain`
pictures   `render`, `sheet`, `timeline`
light      `rayweave.optics`: lenses, mirrors, sources, detectors, prescriptions
photons    `rayweave.photons`: optical photons in detectors described in GDML
curves     `rayweave.space`: crossings along curves, solids in 2 to 4 dimensions
cluster    `rayweave.cluster`: runs on many processes or machines
========== ==========================================================================================================
"""

from difflib import get_close_matches as _get_close_matches
from importlib import import_module as _import_module
from importlib.metadata import version
from typing import TYPE_CHECKING as _TYPE_CHECKING

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
    devices,
    from_polygons,
    intersection,
    load,
    loads,
    place,
    universe,
    union,
    empty,
)
from rayweave._diff import Diff, DiffPlaces, diff
from rayweave._distance import Distances
from rayweave._drawing import Drawing
from rayweave._explain import Entry, Operand, Passage, Question
from rayweave._hit_array import Operation, array_csg, count_array
from rayweave._infill import infill
from rayweave._measure import Measurement, measure
from rayweave._mesh import Mesh, from_trimesh, load_mesh
from rayweave._model import Medium, Region
from rayweave._outline import extrude, revolve
from rayweave._picture import Camera, Picture, render, sheet
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
from rayweave._table import Rows, Table
from rayweave._thickness import Thickness, thickness
from rayweave._timeline import Timeline, ray_timeline, timeline

if _TYPE_CHECKING:
    from rayweave import cluster

__version__ = version("rayweave")

__all__ = [
    "Camera",
    "Check",
    "Crossings",
    "Diff",
    "DiffPlaces",
    "Distances",
    "Drawing",
    "Entry",
    "Explanation",
    "Finding",
    "Measurement",
    "Medium",
    "Mesh",
    "Model",
    "ModelCrossings",
    "Operand",
    "Operation",
    "Partition",
    "Passage",
    "Picture",
    "Polygons",
    "Question",
    "RayweaveError",
    "Region",
    "RootRay",
    "Rows",
    "Section",
    "Solid",
    "Table",
    "Thickness",
    "Timeline",
    "array_csg",
    "asphere",
    "biconic",
    "box",
    "box_from_corners",
    "check",
    "cluster",
    "cone",
    "convert",
    "convex",
    "count_array",
    "cylinder",
    "devices",
    "diff",
    "ellipsoid",
    "extrude",
    "freeform",
    "from_polygons",
    "from_trimesh",
    "half_space",
    "infill",
    "intersection",
    "load",
    "load_mesh",
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
    "revolve",
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

#: Words of other programs, with what to write here.
_MEANT = {
    "cube": "box(size)",
    "cuboid": "box([x, y, z])",
    "block": "box([x, y, z])",
    "ball": "sphere(radius)",
    "plane": "half_space(normal, offset)",
    "pipe": "tube(...)",
    "difference": "a - b",
    "subtract": "a - b",
    "intersect": "a & b",
    "complement": "~a",
    "translate": "solid.translate(v)",
    "rotate": "solid.rotate(axis, degrees) or solid.rotate_z(degrees)",
    "scale": "solid.scale(s)",
    "mirror": "solid.mirror(normal)",
    "save": "solid.save(path)",
    "export": "solid.save(path)",
    "read": "load(path)",
    "open": "load(path)",
    "volume": "solid.volume or measure(solid)",
    "trace": "solid.crossings(origins, directions), or rayweave.optics for light",
    "area": "solid.area or measure(solid)",
    "bounds": "solid.bounds",
    "disk": "cylinder(radius, height)",
    "distance": "solid.distance(points)",
    "hexagon": "prism(6, radius, height)",
    "lathe": "revolve(points)",
    "linear_extrude": "extrude(points, height)",
    "rotate_extrude": "revolve(points)",
    "polygon": "extrude(points, height) or from_polygons([points])",
    "polyhedron": "mesh(vertices, faces)",
    "ray": "solid.crossings(origins, directions)",
    "rectangle": "box([x, y, z])",
    "ring": "torus(major, minor) or tube(outer_radius, inner_radius, height)",
    "show": "render(solid).show()",
    "signed_distance": "solid.distance(points)",
    "plot": "render(solid).show()",
    "to_stl": "solid.save('part.stl')",
    "write": "solid.save(path)",
}


def __getattr__(name: str) -> object:
    if name == "cluster":
        # loaded at its first use: most programs run on one machine
        return _import_module("rayweave.cluster")
    if name in _MEANT:
        hint = f"write {_MEANT[name]}"
    else:
        near = _get_close_matches(name, __all__, 1)
        hint = f"did you mean {near[0]}?" if near else "help(rayweave) lists what there is"
    raise AttributeError(f"module 'rayweave' has no attribute '{name}': {hint}")
