"""Triangle meshes of solids."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayweave import _core
from rayweave._core import Solid
from rayweave._model import Subject
from rayweave._shapes import mesh
from rayweave._table import table_of
from rayweave._package import package

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Mesh:
    """A surface of triangles, as `Solid.to_mesh`, `Model.to_mesh` and `load_mesh` return it.

    >>> import rayweave as rw
    >>> rw.box([1, 2, 3]).to_mesh()
    <Mesh: 8 vertices, 12 triangles>
    """

    vertices: _Array
    """(V, 3) the vertices."""
    triangles: NDArray[np.uint32]
    """(T, 3) the vertices of each triangle, counter-clockwise seen from outside."""
    _regions: tuple[tuple[str, int], ...] = field(default=(), repr=False)
    """The names of the regions and their numbers of triangles, one after the other, in a mesh of several regions."""

    @property
    def faces(self) -> NDArray[np.uint32]:
        """(T, 3) the triangles, by the name that trimesh and PyVista use."""
        return self.triangles

    @property
    def bounds(self) -> _Array:
        """(2, 3) the smallest and the largest coordinates."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @property
    def normals(self) -> _Array:
        """(T, 3) the unit normals of the triangles, pointing outwards."""
        doubled = self._doubled()
        return np.asarray(doubled / np.linalg.norm(doubled, axis=1, keepdims=True))

    @property
    def area(self) -> float:
        """The area of all triangles."""
        return float(np.linalg.norm(self._doubled(), axis=1).sum() / 2)

    @property
    def volume(self) -> float:
        """The enclosed volume, by the divergence theorem; for an open mesh, a number without meaning.

        Exact within rounding, if the triangles are counter-clockwise seen from outside. `Solid.volume` of `to_solid()` does
        not depend on their orientation.
        """
        if len(self.triangles) == 0:
            return 0.0
        corners = self.vertices[self.triangles]
        # about the centre, so that a position far away costs no digits
        a, b, c = np.moveaxis(corners - self.bounds.mean(axis=0), 1, 0)
        return float(np.einsum("ij,ij", a, np.cross(b, c)) / 6)

    @property
    def shells(self) -> int:
        """The number of parts that are connected by edges."""
        return self._defects()[0]

    @property
    def open_edges(self) -> int:
        """The number of edges with an odd number of triangles."""
        return self._defects()[1]

    @property
    def is_closed(self) -> bool:
        """Whether there are triangles and no open edges, so that `to_solid` accepts the mesh."""
        return len(self.triangles) > 0 and self.open_edges == 0

    def describe(self) -> str:
        """A summary with the number of all defects and the position of the first of each kind. Where regions of a model touch, each
        has triangles of its own: regions are examined one by one if the whole has defects.

        >>> import rayweave as rw
        >>> rw.box(2).to_mesh().describe()
        '12 triangles, 8 vertices, 1 shell'
        >>> pair = rw.Model({"left": rw.box(2), "right": rw.box(2).translate(2, 0, 0)})
        >>> print(pair.to_mesh().describe())
        24 triangles, 16 vertices, 2 regions. to_mesh(by="region") returns a mesh for each.
        left: 12 triangles, 8 vertices, 1 shell
        right: 12 triangles, 8 vertices, 1 shell
        """
        *_, summary, is_sound = self._defects()
        if is_sound or len(self._regions) < 2:
            return summary
        counts = f"{len(self.triangles)} triangles, {len(self.vertices)} vertices, {len(self._regions)} regions"
        ends = np.cumsum([count for _, count in self._regions])
        parts = np.split(self.triangles, ends[:-1])
        own = [f"{name}: {_compact(self.vertices, part).describe()}" for (name, _), part in zip(self._regions, parts, strict=True)]
        return "\n".join([f'{counts}. to_mesh(by="region") returns a mesh for each.', *own])

    def _defects(self) -> tuple[int, int, float, str, bool]:
        """Shells, open edges, volume, summary, and whether the solid is unambiguous."""
        return _core.mesh_defects(
            np.ascontiguousarray(self.vertices, np.float64), np.ascontiguousarray(self.triangles, np.uint32)
        )

    @property
    def centroid(self) -> _Array:
        """(3,) the centre of the enclosed volume, by the divergence theorem."""
        a, b, c = np.moveaxis(self.vertices[self.triangles], 1, 0)
        volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
        return np.asarray(volumes @ (a + b + c) / (4 * volumes.sum()))

    def _doubled(self) -> _Array:
        """(T, 3) normals with twice the areas as lengths."""
        a, b, c = np.moveaxis(self.vertices[self.triangles], 1, 0)
        return np.asarray(np.cross(b - a, c - a))

    def to_solid(self) -> Solid:
        """The solid within the mesh."""
        return mesh(self.vertices, self.triangles)

    def save(self, path: str | PathLike[str], *, format: str | None = None) -> list[str]:
        """Writes the mesh to a file in the format of its ending: see `Model.save`."""
        return self.to_solid().save(path, format=format)

    def to_trimesh(self) -> Any:
        """The mesh as a `trimesh.Trimesh`."""
        return package("trimesh", "its meshes").Trimesh(self.vertices, self.triangles, process=False)

    def to_pyvista(self) -> Any:
        """The mesh as a `pyvista.PolyData`."""
        triangles = self.triangles.astype(np.int64)
        return package("pyvista", "its meshes").PolyData.from_regular_faces(self.vertices, triangles)

    def __repr__(self) -> str:
        return f"<Mesh: {len(self.vertices)} vertices, {len(self.triangles)} triangles>"

    def _repr_html_(self) -> str:
        if len(self.triangles) == 0:
            return table_of("Mesh", {"vertices": 0, "triangles": 0})
        lo, hi = self.bounds
        counts = {"vertices": len(self.vertices), "triangles": len(self.triangles)}
        return table_of("Mesh", counts | {"size": hi - lo, "volume": self.volume, "area": self.area})


def from_trimesh(source: Any) -> Solid:
    """The solid within a closed mesh of trimesh or PyVista, or of any object with `vertices` (V, 3) and `faces` (T, 3).

    A point is inside if a ray from it crosses the mesh an odd number of times. A mesh whose triangles cross each other, such as two
    overlapping parts in one mesh, gives a warning: `rw.union(rw.from_trimesh(part) for part in mesh.split())` is the union of the parts.
    For an open mesh, see `trimesh.repair`, or save it and read it with `load(path, repair=True)`.

    >>> import rayweave as rw
    >>> solid = rw.from_trimesh(rw.box(2).to_mesh())
    >>> solid.contains([0.5, 0.5, 0.5])
    array([ True])
    """
    vertices, faces = _vertices_and_faces(source)
    solid = mesh(vertices, faces)
    shells, *_, summary, is_sound = Mesh(np.asarray(vertices, np.float64), np.asarray(faces, np.uint32))._defects()
    if not is_sound:
        advice = " For the union of parts that overlap, use rw.union(rw.from_trimesh(part) for part in mesh.split())."
        warnings.warn(
            f"the solid within the mesh may be another than was meant ({summary}): a point is inside if a ray from it crosses the mesh "
            f"an odd number of times, whatever the orientation of the triangles.{advice if shells > 1 else ''}",
            stacklevel=2,
        )
    return solid


def _vertices_and_faces(source: Any) -> tuple[ArrayLike, ArrayLike]:
    """The vertices (V, 3) and the triangles (T, 3) of a mesh of another package."""
    if hasattr(source, "points") and hasattr(source, "triangulate"):
        # PolyData of PyVista; each of its faces is preceded by the number of its corners
        triangles = source.triangulate()
        return triangles.points, np.reshape(triangles.faces, (-1, 4))[:, 1:]
    for name in ("vertices", "faces"):
        if not hasattr(source, name):
            kind = type(source).__name__
            hint = " Use one solid for each mesh of source.dump()." if hasattr(source, "geometry") else ""
            raise TypeError(f"source is of type {kind}, without {name}: it must be a mesh with vertices (V, 3) and faces (T, 3).{hint}")
    return source.vertices, source.faces


def load_mesh(
    path: str | PathLike[str],
    *,
    format: str | None = None,
    unit: str | None = None,
    repair: bool = False,
    allow: Sequence[str | PathLike[str]] = (),
) -> Mesh:
    """The triangles of a mesh file (.stl, .obj, .ply, .off, .3mf, .gltf, .glb), closed or not, all objects in one mesh.

    `load` reads closed meshes as models. The arguments are those of `load`; z is up.

    >>> import rayweave as rw
    >>> _ = rw.box([1, 2, 3]).save("block.stl")
    >>> block = rw.load_mesh("block.stl")
    >>> len(block.triangles), block.shells, block.is_closed, block.volume
    (12, 1, True, 6.0)
    """
    return _joined(_core.mesh_file_parts(Path(path), format, unit, repair, [Path(file) for file in allow]))


def mesh_of(subject: Subject, tolerance: float | None) -> Mesh:
    """All regions as one mesh."""
    parts = _sound(_core.mesh_parts(subject, tolerance))
    whole = _joined(parts)
    return Mesh(whole.vertices, whole.triangles, tuple((name, len(corners)) for name, _, corners in parts))


def meshes_of(subject: Subject, tolerance: float | None) -> dict[str, Mesh]:
    """A mesh for each region, by its name; regions of the same name, as in GDML files, share a mesh."""
    parts: dict[str, list[tuple[str, _Array, NDArray[np.uint32]]]] = {}
    for part in _sound(_core.mesh_parts(subject, tolerance)):
        parts.setdefault(part[0], []).append(part)
    return {name: _joined(own) for name, own in parts.items()}


def _sound(parts: list[tuple[str, _Array, NDArray[np.uint32]]]) -> list[tuple[str, _Array, NDArray[np.uint32]]]:
    """The parts; a warning about each whose mesh is not sound. It names the line that called `to_mesh`."""
    for name, vertices, triangles in parts:
        *_, summary, is_sound = Mesh(vertices, triangles)._defects()
        if not is_sound:
            text = (
                f"the mesh of {name!r} is not sound: {summary}. Choose another tolerance, or make its parts regions of a model, "
                'rw.Model({...}): to_mesh(by="region") and files in 3MF have a mesh for each.'
            )
            warnings.warn(text, stacklevel=4)
    return parts


def _compact(vertices: _Array, triangles: NDArray[np.uint32]) -> Mesh:
    """The triangles with only the vertices that they use."""
    used, corners = np.unique(triangles, return_inverse=True)
    return Mesh(vertices[used], corners.reshape(-1, 3).astype(np.uint32))


def _joined(parts: list[tuple[str, _Array, NDArray[np.uint32]]]) -> Mesh:
    vertices = np.concatenate([np.zeros((0, 3)), *(points for _, points, _ in parts)])
    starts = np.cumsum([0, *(len(points) for _, points, _ in parts)])
    triangles = [corners + np.uint32(start) for (_, _, corners), start in zip(parts, starts, strict=False)]
    return Mesh(vertices, np.concatenate([np.zeros((0, 3), np.uint32), *triangles]))
