# Generated from the sources of the binding: run `cargo xtask stub --accept` instead of editing.

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, NoReturn, Self, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import disjoint_base

from rayweave._answers import Crossings, ModelCrossings, Partition
from rayweave._check import CheckRow
from rayweave._distance import Distances
from rayweave._explain import Passage, Question
from rayweave._mesh import Mesh
from rayweave._model import Media, Medium, Region, Regions, Subject
from rayweave._picture import Camera
from rayweave._progress import Progress
from rayweave.photons._compare import CompareRow
from rayweave.space import PointCrossings, Trajectory

__all__ = [
    "Arc",
    "Arrivals",
    "AtomicFile",
    "CompiledDetector",
    "CompiledPrescription",
    "CompiledSystem",
    "Curve",
    "Explanation",
    "Glass",
    "GradedMedium",
    "Helix",
    "LightSource",
    "Line",
    "Model",
    "Parabola",
    "PhotonHistories",
    "PhotonHits",
    "PhotonRun",
    "PhotonSource",
    "PhotonTables",
    "Polygons",
    "RayweaveError",
    "ReadElement",
    "RootRay",
    "Section",
    "SegmentStream",
    "Sheet",
    "Solid",
    "SpaceSolid",
    "Spline",
    "array_csg",
    "check_rows",
    "compare_photons",
    "coordinate_break",
    "count_array",
    "devices",
    "diff_columns",
    "empty",
    "event_names",
    "exact_volume",
    "extrude_outline",
    "from_polygons",
    "glass_names",
    "infill_columns",
    "intersection",
    "lensmaker",
    "load",
    "load_detector",
    "load_optics",
    "loads",
    "loads_detector",
    "loads_optics",
    "manuals",
    "measure_columns",
    "mesh_defects",
    "mesh_file_parts",
    "mesh_parts",
    "min_sep",
    "notebook_png",
    "number_list",
    "optical_component",
    "optimise",
    "photon_property_svg",
    "place",
    "pupil_points",
    "ray_timeline_svg",
    "render",
    "require_input",
    "revolve_outline",
    "root_problems",
    "section_from_parts",
    "section_list",
    "section_text",
    "shape",
    "sheet_svg",
    "solid_from_bytes",
    "space_join",
    "space_shape",
    "space_solid_from_steps",
    "space_trace",
    "space_trace_along",
    "surface_count",
    "technical_svg",
    "thickness_maps",
    "timeline_svg",
    "tolerance",
    "union",
    "universe",
    "zernike_fit",
    "zernike_term",
    "zernike_values",
]

_ErrorOf = tuple[str, str, Sequence[float]]
_GoalOf = tuple[str, Sequence[float], str, float, float, float]
_MaterialBehind = Glass | str | float | tuple[float, float]
_Outline = tuple[str, float, float]
_Part = (
    tuple[str, Solid, str, _Substance | None, _Spec, Sequence[tuple[str, _Spec]]]
    | tuple[str, Sheet, _Spec]
    | tuple[str, ReadElement]
)
_Row = (
    tuple[float, float, _MaterialBehind, float, tuple[float | None, float | None], float, Sequence[float], Sequence[float], _Spec]
)
_Spec = tuple[str, Sequence[float]]
_Substance = Glass | GradedMedium | tuple[float, float]

def number_list(values: ArrayLike, name: str) -> list[float]:
    """A one-dimensional array as a list of numbers, for argument checks of functions written in
    Python.
    """

def check_rows(
    subject: Subject,
    wall: float | None,
    gap: float | None,
    distance: float | None,
    cells: int,
    confidence: float,
    most_pairs: int,
    within: Sequence[Sequence[float]] | None,
    seed: int,
    pictures: bool,
    threads: int | None,
    progress: Callable[[int, int], object] | None = None,
) -> tuple[list[CheckRow], str, dict[str, float]]:
    """Probable faults of a model, with the unit and the scope of the check: see `rayweave.check`."""

def devices() -> list[dict[str, Any]]:
    """The graphics cards that can trace rays, best first: a list of dicts with "name", "kind", "driver", "largest_table_bytes" and
    "f64", whether it computes in double precision. It is empty if no driver is installed. An error in a package that was built
    without the Cargo feature `gpu`.

    >>> import rayweave as rw
    >>> [card["name"] for card in rw.devices()]  # doctest: +SKIP
    ['NVIDIA H200']
    """

def diff_columns(
    a: Subject,
    b: Subject,
    by: str | None,
    distance: float | None,
    cells: int,
    precision: float,
    confidence: float,
    most_rays: int | None,
    within: Sequence[Sequence[float]] | None,
    seed: int,
    threads: int | None,
    progress: Callable[[int, int], object] | None = None,
) -> tuple[list[str], list[NDArray[np.bool_]], NDArray[np.float64], tuple[bool, str, float, int], Section, tuple[NDArray[np.int64], NDArray[np.bool_], NDArray[np.float64]]]:
    """Common and different parts of two models: see `rayweave.diff`."""

class RayweaveError(ValueError):
    """A value that cannot be used: the message says which one, where, and why.

    A wrong type is a TypeError.

    >>> import rayweave as rw
    >>> rw.sphere(-1)
    Traceback (most recent call last):
    ...
    rayweave.RayweaveError: sphere: radius is -1: radius must be finite and greater than 0. Did you mean 1?
    """

def require_input(path: str | PathLike[str]) -> None:
    """Raises a `FileNotFoundError` with files of similar names if there is no such file."""

@final
class Explanation:
    """Explanation of the answer for one ray: printed as text, with the same contents as data in its attributes.

    >>> import rayweave as rw
    >>> explanation = rw.box(2).named("die").explain([-3, 0, 0], [1, 0, 0])
    >>> [(passage.t, passage.face) for passage in explanation.crossings]
    [(2.0, 'die.x-'), (4.0, 'die.x+')]
    >>> explanation.start == "the world"
    True
    """

    @property
    def start(self) -> str:
        """The name of the region just after t_min: "the world" where there is none."""

    @property
    def questions(self) -> tuple[Question, ...]:
        """Queries to the model, in order: see `Question`."""

    @property
    def crossings(self) -> tuple[Passage, ...]:
        """The crossings, which are the answer: see `Passage`."""

    @property
    def welded(self) -> int:
        """Number of changes of medium that were welded with their neighbours, because the ray stays within `delta` of both
        surfaces between them.
        """

    @property
    def steps(self) -> int:
        """Number of shapes queried and decisions made, over all queries."""

    def story(self, lines: int | None = ...) -> str:
        """The text with at most `lines` lines of decisions, None for all of them; omitted lines are counted."""

@final
class AtomicFile:
    """A file that is renamed to its path at `finish`: see `rayweave._files.AtomicFile`."""

    def __new__(cls, path: str | PathLike[str]) -> AtomicFile: ...

    def write(self, data: bytes) -> None:
        """Appends bytes."""

    def finish(self) -> None:
        """Completes the file."""

    def discard(self) -> None:
        """Removes what has been written, unless the file is complete."""

def array_csg(
    array1: ArrayLike,
    array2: ArrayLike,
    operation: int,
    sort_output: bool,
    regularize: bool | float,
    out: NDArray[Any] | None,
    threads: int | None,
) -> NDArray[Any]:
    """The hits of `array1 operation array2`: see `rayweave.array_csg`."""

def count_array(
    array1: ArrayLike, array2: ArrayLike, operation: int
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """The merged entries of two hit arrays and the count after each: see `rayweave.count_array`."""

def infill_columns(
    subject: Subject | Polygons,
    spacing: float,
    angle: float,
    phase: float,
    turn: float,
    alternate: bool,
    layers: ArrayLike | None,
    layer_height: float | None,
    evaluator: str | None,
    threads: int | None,
) -> tuple[list[NDArray[np.int64]], list[NDArray[np.float64]]]:
    """The traces that fill a solid, a model or a region: see `rayweave.infill`."""

def measure_columns(
    subject: Subject,
    precision: float,
    confidence: float,
    most_rays: int | None,
    within: Sequence[Sequence[float]] | None,
    seed: int,
    evaluator: str | None,
    threads: int | None,
    progress: Callable[[int, int], object] | None = None,
) -> tuple[list[str], list[str], tuple[NDArray[np.uint64], NDArray[np.bool_]], list[NDArray[np.float64]], NDArray[np.float64]]:
    """Volume, area, mass and moments of the regions of a solid or a model: see `rayweave.measure`."""

@final
class Model:
    """A model: an ordered list of regions, each a solid made of a medium. It never changes.

    Later regions have priority where solids overlap; everywhere else is the medium of the world, number 0. The queries are those of
    `Solid`; a point is inside where the medium is not that of the world.

    `load` and `loads` read models; `Model(regions, media)` builds one. Regions are a list of solids and `Region` objects, or a dict
    of them by name. Media are a list of `Medium` objects, or a dict from names to an index, to a dict of numbers, or to a `Medium`.
    With `media`, the medium of each region must be in it.

    >>> import rayweave as rw
    >>> ball = rw.sphere(10)
    >>> model = rw.Model(
    ...     regions=[rw.Region("ball", ball, medium="glass", colour="steelblue")],
    ...     media={"glass": 1.5},
    ... )
    >>> model.nearest([0, 0, -20], [0, 0, 1]).t
    array([10.])
    """

    def __new__(
        cls, regions: Regions, media: Media | None = None, *, unit: str = "mm", camera: Camera | None = None
    ) -> Model: ...

    @property
    def solids(self) -> dict[str, Solid]:
        """The solids by their names, in the order of the file."""

    @property
    def regions(self) -> tuple[Region, ...]:
        """The regions in order; where they overlap, the later one has priority. Region k of this list
        has the number k + 1.
        """

    @property
    def media(self) -> tuple[Medium, ...]:
        """The media by their numbers; number 0 is that of the world."""

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters with their values, in the order of the file."""

    @property
    def unit(self) -> str:
        """The unit of all lengths: "nm", "um", "mm", "cm", "m", "km", "in" or "ft"."""

    @property
    def warnings(self) -> list[str]:
        """Warnings about the file, as text."""

    @overload
    def hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: float = ...,
        t_max: float = ...,
        *,
        return_surfaces: Literal[False] = False,
        out: NDArray[np.float64] | None = None,
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> NDArray[np.float64]:
        """Times at which rays enter and leave the medium of the world: see `Solid.hits`."""
    @overload
    def hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: float = ...,
        t_max: float = ...,
        *,
        return_surfaces: Literal[True],
        out: NDArray[np.float64] | tuple[NDArray[np.float64], NDArray[np.int32]] | None = None,
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]: ...

    def crossings(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: float = ...,
        t_max: float = ...,
        *,
        by: Literal["medium", "region"] = "medium",
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> ModelCrossings:
        """All changes of the medium, sorted by ray, then t: see `ModelCrossings`. With `by="region"`, also changes of region within one
        medium.
        """

    def crossings_along(
        self,
        curves: Trajectory | Iterable[Trajectory],
        t_min: float | ArrayLike,
        t_max: float | ArrayLike,
        *,
        by: Literal["medium", "region"] = "medium",
        threads: int | None = None,
    ) -> ModelCrossings:
        """All changes of the medium along one curve, or along each in a list of curves, strictly between two times: see
        `ModelCrossings`, where `ray` is the number of the curve and `t` its own time. The times are finite numbers, or
        (N,) arrays with one for each curve. Curves are described in `rayweave.space`: `Helix` and others, or any object
        with `position(t)`, `velocity(t)` and `acceleration_bound(t0, t1)`. With `by="region"`, also changes of region within one medium.
        """

    def nearest(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: float = 0.0,
        t_max: float = ...,
        *,
        by: Literal["medium", "region"] = "medium",
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> ModelCrossings:
        """The first change of the medium of each ray after t_min: see `ModelCrossings`. With `by="region"`, also a change of region
        within one medium.
        """

    def partition(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: float = ...,
        t_max: float = ...,
        *,
        by: Literal["medium", "region"] = "medium",
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> Partition:
        """The pieces of each ray in one medium, from t_min to t_max: see `Partition`. With `by="region"`, the pieces in one region."""

    def contains(
        self,
        points: ArrayLike,
        *,
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> NDArray[np.bool_]:
        """Whether points (N, 3) or (3,) are in a medium other than that of the world: bool (N,), or (...) for a grid (..., 3)."""

    def regions_at(
        self,
        points: ArrayLike,
        *,
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> NDArray[np.int32]:
        """The region of each point (N, 3) or (3,): int32 (N,), or (...) for a grid (..., 3). Region k + 1 is `regions[k]`, 0 is the
        world.
        """

    def occurrence_paths(
        self, occurrences: NDArray[np.integer[Any]] | Sequence[int], *, placed: bool = False
    ) -> list[str]:
        """Paths of names and copy numbers, such as "tower[3]/brick[12]/hole", of `occurrences` as in
        `Crossings.occurrence`: a list of (M,) texts, "" for -1. With `placed`, each path ends at the innermost placed
        solid: "tower[3]/brick[12]". Copies have the numbers of the file, or are counted from 0 in the order of `place`;
        of equal names in one place, the second one ends in "#2".
        """

    def explain(
        self, origin: ArrayLike, direction: ArrayLike, t_min: float = ..., t_max: float = ...
    ) -> Explanation:
        """Explains the crossings of one ray: every decision of the single-hit evaluator, with its reason. Print the result to read
        it as text, or use its `questions`: see `Explanation`. `origin` and `direction` are three numbers each.
        """

    def preparation(self, *, lines: int = 200) -> str:
        """Explains the compilation of the model: the effect of each pass on its tree, and the pruned parts, with reasons: the text
        of `rayweave info --explain`, with at most `lines` parts for each solid.
        """

    def distance(
        self,
        points: ArrayLike,
        *,
        regions: str | Sequence[str] | None = None,
        precision: float = 1e-9,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Distances:
        """Signed distances of points from the surface between the medium of the world and all others: see `Solid.distance`.
        `regions` is the name of a region, or several names: the distances are then those from the space that belongs to these
        regions, including their borders with other regions.

        >>> import rayweave as rw
        >>> model = rw.Model({"shell": rw.sphere(2), "core": rw.sphere(1)})
        >>> model.distance([0, 0, 1.25], regions="core").distance
        array([0.25])
        """

    def solid_of(self, region: str | int) -> Solid:
        """The solid of the space that belongs to a region, given by its name or its position in the list of regions: that of the
        region minus those of all later regions, which have priority.

        >>> import rayweave as rw
        >>> model = rw.Model({"post": rw.box([1, 1, 4]), "plate": rw.box([4, 4, 1])})
        >>> model["post"].solid.volume, model.solid_of("post").volume
        (4.0, 3.0)
        """

    @property
    def bounds(self) -> NDArray[np.float64]:
        """A box around all regions: float64 (2, 3), the smallest and the largest coordinates."""

    def save(
        self,
        path: str | PathLike[str],
        *,
        format: str | None = None,
        tolerance: float | None = None,
        text: bool = False,
        allow_unsound: bool = False,
    ) -> list[str]:
        """Writes the model to a file, complete or not at all, in the format of its ending (native without one) or the one
        that `format` names, as in `load`. Curved faces that the format does not support become triangles within `tolerance`, in
        the unit of the model; default 1/5000 of its diagonal. With `text`, STL and PLY are written as text. Returns sentences
        about parts that were approximated, dropped or written in another form. A mesh that is not sound (edges without two
        triangles, or triangles that intersect each other) is rejected, unless `allow_unsound` is true.
        """

    @overload
    def to_mesh(self, tolerance: float | None = None, *, by: None = None) -> Mesh:
        """The surfaces of all regions as triangles: see `rayweave.Mesh`. A face between two regions has triangles of both, so that
        `Mesh.describe` reports overlapping pairs and edges with more than two triangles; the mesh of each region has none.
        `tolerance` is the maximum distance from curved faces; default 1/5000 of the diagonal of the model. With `by="region"` the
        result is a dict with a mesh for each region, by its name.

        >>> import rayweave as rw
        >>> model = rw.Model({"post": rw.box([1, 1, 4]), "plate": rw.box([4, 4, 1])})
        >>> {name: mesh.volume for name, mesh in model.to_mesh(by="region").items()}
        {'post': 3.0, 'plate': 16.0}
        """
    @overload
    def to_mesh(self, tolerance: float | None = None, *, by: Literal["region"]) -> dict[str, Mesh]: ...

    def __len__(self) -> int:
        """The number of regions."""

    def __iter__(self) -> Iterator[Region]:
        """The regions in order."""

    def __getitem__(self, key: str | int, /) -> Region:
        """A region by its name, or by its position in the list of regions."""

    def to_toml(self) -> str:
        """The model file as text."""

    def __eq__(self, other: object, /) -> bool:
        """Equal if regions, media, unit and pictures are equal, regardless of parameters and of names that solids have apart from
        regions: a writer gives names to the parts of expressions.
        """

    def __hash__(self) -> int: ...

    def render(self, **options: Any) -> NDArray[Any]:
        """A picture of the model as an array: see `rayweave.render`, whose options these are."""

    def _repr_png_(self) -> bytes:
        """The picture that a notebook shows."""

    def __copy__(self) -> Model: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> Model: ...

def load(
    path: str | PathLike[str],
    parameters: dict[str, float | str] | None = None,
    *,
    format: str | None = None,
    facets: bool = False,
    fonts: Sequence[str | PathLike[str]] = ...,
    repair: bool = False,
    unit: str | None = None,
    allow: Sequence[str | PathLike[str]] = ...,
    strict: bool = False,
) -> Model:
    """Reads a model file: a native one (.toml), one of another program (OpenSCAD's .csg, Geant4's .gdml), or a mesh (.stl, .obj, .ply,
    .off, .3mf, .gltf, .glb). The ending selects the format, unless `format` names it: "native", "openscad", "gdml", or the
    ending of a mesh. `parameters` overrides parameters of a native file, or constants, variables and quantities of a GDML file, by
    numbers or arithmetic text. With `facets`, round shapes become the facets that their own program uses; by default they are exactly
    round. The model's `warnings` list parts that were approximated, dropped or rejected. `fonts` are font files and folders, searched before the system's fonts. With
    `repair`, meshes that are not solids are repaired as far as that is safe, and `warnings` list the changes. `unit` is the unit
    of files without one (STL, OBJ, PLY, OFF, OpenSCAD); default "mm". The model may read files in its folder and below, and the
    files and folders in `allow`. With `strict`, warnings are errors.

    >>> import rayweave as rw
    >>> _ = rw.Model({"die": rw.box(2)}).save("die.toml")
    >>> [region.name for region in rw.load("die.toml")]
    ['die']
    """

def loads(
    text: str,
    parameters: dict[str, float | str] | None = None,
    *,
    allow: Sequence[str | PathLike[str]] = ...,
    strict: bool = False,
) -> Model:
    """Reads a model from the text of a model file. Names of files are relative to the current folder; the model may read files there
    and below, and the files and folders in `allow`. With `strict`, warnings are errors.

    >>> import rayweave as rw
    >>> model = rw.loads(\"\"\"
    ... rayweave = 1
    ... [solid.die]
    ... box = { size = 2 }
    ... [[region]]
    ... solid = "die"
    ... \"\"\")
    >>> model["die"].solid
    box(size=[2, 2, 2]).named('die')
    """

@final
class Arrivals:
    """Rays on the image: see `rayweave.optics.Rays`."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """Their columns by name."""

    def moved(self, shift: float) -> Arrivals:
        """The same rays on a plane shifted along the axis."""

    def spot(self) -> tuple[int, tuple[float, float], tuple[float, float, float], float]:
        """The number of rays, the centroid (x, y), the RMS radii (both, x, y) and the geometric radius."""

    def encircled_energy(self, radii: Sequence[float]) -> NDArray[np.float64]:
        """The fraction of the power within circles about the centroid."""

    def radius_of_energy(self, fraction: float) -> float:
        """The radius of the smallest circle about the centroid with a fraction of the power; NaN if there is no light."""

    def mtf(self, direction: tuple[float, float], frequencies: Sequence[float]) -> NDArray[np.float64]:
        """The geometric modulation of lines across a direction."""

    def best_focus(self) -> float:
        """The shift of the plane with the smallest RMS radius; NaN for parallel rays."""

def optical_component(
    kind: str,
    numbers: Sequence[float],
    outline: _Outline | None = None,
    off_axis: tuple[float, float] = ...,
    terms: Sequence[tuple[Sequence[float], Sequence[float]]] = ...,
) -> list[Solid]:
    """The solids of a component, usually one: the kinds and the order of `numbers` are those of the match below; `terms` are the
    even and odd coefficients of each aspheric face, `outline` is the aperture, `off_axis` the offset of a mirror.
    """

def lensmaker(r1: float, r2: float, n: float, thickness: float) -> float:
    """The focal length of a thick lens in air (see `rayweave.optics.lensmaker`)."""

@final
class Sheet:
    """A sheet: a surface trimmed by a solid, with its frame.

    >>> import rayweave.optics as ro
    >>> type(ro.detector(25.0).body).__name__
    'Sheet'
    """

    def __new__(
        cls, outline: _Outline, opening: _Outline | None = None, curvature: float = 0.0, conic: float = 0.0
    ) -> Sheet:
        """`curvature` is that of the surface at its vertex, 1 over its radius. With an opening, the sheet is a stop."""

    @staticmethod
    def from_solids(surface: Solid, trim: Solid) -> Sheet:
        """A sheet: the part of the boundary of a solid that lies within another one."""

    def apply(self, world_from_local: ArrayLike) -> Sheet:
        """The sheet moved by an affine map, a 4 x 4 matrix."""

    def frame(self) -> NDArray[np.float64]:
        """Its frame, a 4 x 4 matrix from the coordinates in which it was created to those of the world."""

    def solids(self) -> tuple[Solid, Solid]:
        """The solid whose boundary is the surface, and the solid that trims it."""

def tolerance(
    lens: CompiledPrescription,
    errors: Sequence[_ErrorOf],
    merit: str,
    trials: int,
    *,
    frequency: float | None,
    refocus: bool,
    vignette: bool,
    rings: int,
    mirror_fields: bool | None,
    seed: int,
    threads: int | None,
) -> dict[str, Any]:
    """The merits of trials with their deviations, and the effect of each parameter alone."""

def optimise(
    lens: CompiledPrescription,
    parameters: Sequence[str],
    goals: Sequence[_GoalOf],
    *,
    rings: int,
    patience: int,
    aimed: bool,
) -> tuple[CompiledPrescription, dict[str, Any]]:
    """The prescription that an optimisation finds, the values of the parameters, and the course of the
    optimisation.
    """

@final
class ReadElement:
    """An element of a model file: see `rayweave.optics.Element`."""

    def parts(self) -> tuple[str, Solid | Sheet, str, NDArray[np.float64]]:
        """Its name, its solid or sheet, the name of its material, and the frame of a sheet."""

    def apply(self, world_from_local: ArrayLike) -> ReadElement:
        """The element moved by an affine map, a 4 x 4 matrix."""

    def with_finish(self, finish: _Spec, face: str | None = None) -> ReadElement:
        """The element with a finish, on all faces or on those of a name."""

def load_optics(
    path: str | PathLike[str],
    parameters: dict[str, float | str] | None = None,
    *,
    allow: Sequence[str | PathLike[str]] = ...,
    strict: bool = False,
) -> tuple[CompiledSystem, list[ReadElement], list[LightSource], dict[str, Any], str, list[str]]:
    """Reads the `[optics]` tables of a model file."""

def loads_optics(
    text: str,
    parameters: dict[str, float | str] | None = None,
    *,
    allow: Sequence[str | PathLike[str]] = ...,
    strict: bool = False,
) -> tuple[CompiledSystem, list[ReadElement], list[LightSource], dict[str, Any], str, list[str]]:
    """Reads the `[optics]` tables of the text of a model file."""

@final
class Glass:
    """A material with its refractive index by wavelength: a glass, a crystal, a liquid, a metal.

    `index(wavelength_nm)` and `extinction(wavelength_nm)` take a number or an array of vacuum wavelengths in nanometres. A
    wavelength that the data do not reach is an error; `extrapolated()` is the same material without that check.

    >>> import rayweave.optics as ro
    >>> glass = ro.Glass("N-BK7")
    >>> round(glass.index(587.5618), 5), round(glass.abbe_number(), 2)
    (1.5168, 64.17)
    >>> glass.index([486.1, 656.3]).round(5)
    array([1.52238, 1.51432])
    """

    def __new__(cls, name: str) -> Glass:
        """A material of the built-in catalogue, by name; upper and lower case, spaces and dashes do not matter."""

    @staticmethod
    def sellmeier(name: str, b: Sequence[float], c: Sequence[float]) -> Glass:
        """A material by Sellmeier's formula n^2 - 1 = sum of b l^2 / (l^2 - c), l in micrometres, c in square micrometres."""

    @staticmethod
    def from_abbe(n_d: float, v_d: float) -> Glass:
        """A material by its index at 587.5618 nm and its Abbe number."""

    @overload
    def index(self, wavelength_nm: float) -> float:
        """The refractive index at a vacuum wavelength in nanometres, or at each of an array of them."""
    @overload
    def index(self, wavelength_nm: ArrayLike) -> Any: ...

    @overload
    def extinction(self, wavelength_nm: float) -> float:
        """The extinction coefficient at a vacuum wavelength in nanometres, or at each of an array of them."""
    @overload
    def extinction(self, wavelength_nm: ArrayLike) -> Any: ...

    def abbe_number(self) -> float:
        """The Abbe number (n_d - 1) / (n_F - n_C)."""

    def extrapolated(self) -> Glass:
        """The same material without a check of the range of its data."""

    @property
    def name(self) -> str:
        """Name."""

    @property
    def maker(self) -> str:
        """Manufacturer; empty if there is none."""

    @property
    def source(self) -> str:
        """Source of the data."""

    @property
    def range_nm(self) -> tuple[float, float]:
        """Range of wavelengths with a known index, in nanometres."""

    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

def glass_names() -> list[str]:
    """The names of all materials of the catalogue.

    >>> import rayweave.optics as ro
    >>> "N-BK7" in ro.glass_names()
    True
    """

@final
class GradedMedium:
    """A medium with a gradient: see `rayweave.optics.graded`.

    >>> import rayweave.optics as ro
    >>> rod = ro.graded(1.6, "selfoc", 0.1)
    >>> round(rod.index(587.6, (1, 0, 0)), 5)
    1.59198
    """

    def __new__(cls, base: _Substance, law: _Spec, world_from_local: ArrayLike) -> GradedMedium: ...

    def index(self, wavelength_nm: float, point: tuple[float, float, float]) -> float:
        """The index at a point, a vector of three numbers, at a vacuum wavelength in nanometres; NaN where there is none."""

@final
class CompiledPrescription:
    """A prescription, with a system that is compiled on demand: see `rayweave.optics.Prescription`."""

    def __new__(cls, rows: Sequence[_Row], frame: Mapping[str, Any]) -> CompiledPrescription: ...

    @staticmethod
    def read_zmx(file: bytes) -> tuple[CompiledPrescription, list[str]]:
        """The prescription in the bytes of a Zemax file, and notes on ignored entries."""

    def write_zmx(self) -> str:
        """The text of a Zemax file."""

    def rows(self) -> list[tuple[Any, ...]]:
        """The surfaces, as the constructor takes them."""

    def frame(self) -> dict[str, Any]:
        """Aperture, fields, wavelengths, stop and image, in the form that the constructor takes."""

    def first_order(self, wavelength_nm: float, along: str) -> dict[str, Any]:
        """A dict of first-order data at a wavelength, with the matrix (a, b, c, d); pupils are (position, diameter)."""

    def seidel(self) -> dict[str, NDArray[np.float64]]:
        """The Seidel sums of every surface, as columns."""

    def parts(self) -> list[tuple[str, Any, Any, Any, Any]]:
        """The solids, stop and image of the prescription."""

    def drawing(self, first: int, last: int, title: str, indications: Sequence[tuple[str, str]]) -> str:
        """The drawing of a lens, or of the cemented lenses from the first to the last number, counted from 1, as SVG, with the texts
        of fields.
        """

    def semi_diameters(self) -> NDArray[np.float64]:
        """The clear semi-diameters of the surfaces and of the image."""

    def rays(
        self, field: int, wavelength_nm: float, pupil: ArrayLike, aimed: bool
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origins and directions, both (N, 3), of the rays of a field through points of the pupil, (N, 2), in units of its
        semi-diameter.
        """

    def arrivals(
        self, field: int, wavelength_nm: float | None, pupil: ArrayLike, aimed: bool
    ) -> Arrivals:
        """The rays of a field on the image, at one wavelength or at all of them with their weights."""

    def fan(
        self, field: int, wavelength_nm: float, reference_nm: float, pupil: ArrayLike, aimed: bool
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """A ray fan: points of the pupil and transverse ray aberrations, both (N, 2), from the central ray at `reference_nm`."""

    def wavefront(
        self, field: int, wavelength_nm: float, pupil: ArrayLike, aimed: bool
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """A wavefront: points of the pupil (N, 2) and optical path differences in waves (N,)."""

    def chief_ray_pupil_point(self, field: int, wavelength_nm: float) -> tuple[float, float]:
        """The point of the paraxial entrance pupil through which the chief ray passes."""

    def needs_aiming(self, field: int, wavelength_nm: float) -> bool:
        """Whether rays of a field have to be aimed at the stop."""

    def principal(self, field: int, wavelength_nm: float) -> list[float]:
        """The heights of the real and the paraxial chief ray on the image, and the tangential and the sagittal focus."""

    def axial_focus(self, wavelength_nm: float, height: float) -> float:
        """The distance from the image to the axis crossing of the ray at a height in the pupil, in units of its
        semi-diameter. The first field must be on the axis.
        """

    def lateral_colour(self, field: int, wavelength_nm: float) -> float:
        """The height of the chief ray on the image minus that at the primary wavelength."""

def coordinate_break(
    decentre: tuple[float, float], tilt_degrees: tuple[float, float, float], tilts_first: bool
) -> list[list[float]]:
    """The matrix of a coordinate break, row by row: it maps coordinates behind the break to those in front of it."""

def pupil_points(kind: str, count: int) -> NDArray[np.float64]:
    """Points of a pupil by kind: "hexapolar" with a number of rings, "square", "fan_x" or "fan_y" with a number of points
    across.
    """

def event_names() -> list[str]:
    """The names of events by their numbers."""

@final
class LightSource:
    """A source of light: see `rayweave.optics.Source`."""

    def __new__(
        cls,
        kind: str,
        numbers: Sequence[float],
        count: int,
        spectrum: _Spec,
        power: float,
        is_total: bool,
        seed: int,
        outline: _Outline | None,
        sampling: str,
    ) -> LightSource: ...

    @staticmethod
    def listed(
        origins: ArrayLike,
        directions: ArrayLike,
        wavelength_nm: Sequence[float] | None = None,
        power: Sequence[float] | None = None,
    ) -> LightSource:
        """Rays given one by one, optionally with their own wavelengths and powers."""

    @staticmethod
    def from_file(path: str | PathLike[str]) -> LightSource:
        """The rays of a file."""

    def with_spectrum(self, spectrum: _Spec) -> LightSource:
        """The source with a different spectrum."""

    def with_power(self, power: float, is_total: bool) -> LightSource:
        """The source with a different power, of each ray or of all together."""

    def with_stokes(self, parameters: tuple[float, float, float, float]) -> LightSource:
        """The source with polarised light, given by Stokes parameters."""

    def apply(self, world_from_local: ArrayLike) -> LightSource:
        """The source moved by an affine map, a 4 x 4 matrix."""

    @property
    def count(self) -> int:
        """The number of rays."""

    def rays(
        self,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Its rays: origins, directions, wavelengths and powers."""

@final
class SegmentStream:
    """The segments of a run as an iterator of tables: see `rayweave.optics.Stream`."""

    def __iter__(self) -> SegmentStream: ...

    def __next__(self) -> dict[str, NDArray[Any]]:
        """The next table, whose parents are rows of the whole run."""

    def cancel(self) -> None:
        """Stops the run: there are no further tables."""

    @property
    def rays(self) -> int:
        """The approximate number of rays traced so far."""

    @property
    def balance(self) -> dict[str, Any] | None:
        """The balance of power, available once the run is over."""

@final
class CompiledSystem:
    """An optical system, compiled: see `rayweave.optics.System`."""

    def __new__(cls, parts: Sequence[_Part], world: _Substance, unit_nm: float) -> CompiledSystem: ...

    @property
    def element_names(self) -> list[str]:
        """The names of the elements."""

    @property
    def surface_names(self) -> list[str]:
        """The names of all surfaces."""

    def trace(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        wavelength_nm: ArrayLike,
        power: ArrayLike,
        source: ArrayLike,
        stokes: ArrayLike | None,
        settings: Mapping[str, Any],
        progress: Callable[[int, int], object] | None = None,
    ) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """Traces rays: columns by name, and the balance of power."""

    def trace_sources(
        self,
        sources: Sequence[LightSource],
        settings: Mapping[str, Any],
        progress: Callable[[int, int], object] | None = None,
    ) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """Traces the light of sources: columns by name, and the balance of power."""

    def phases(self, columns: dict[str, NDArray[Any]]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The phases of s- and p-polarised light for the rows of a whole trace with the given columns, in degrees."""

    def stream(
        self, sources: Sequence[LightSource], settings: Mapping[str, Any], rows: int, phases: bool
    ) -> SegmentStream:
        """Traces the light of sources in the background, in tables of at least `rows` rows."""

    def trace_to(
        self,
        path: str | PathLike[str],
        unit: str,
        sources: Sequence[LightSource],
        settings: Mapping[str, Any],
        phases: bool,
        progress: Callable[[int, int], object] | None = None,
    ) -> dict[str, Any]:
        """Traces the light of sources into a file, `.csv` or `.npy`, and returns the balance of power. `unit` is that of
        lengths.
        """

def zernike_term(scheme: str, index: int) -> tuple[int, int]:
    """The radial order and the azimuthal frequency for an index: "noll" from 1, "osa" from 0."""

def zernike_values(term: tuple[int, int], pupil: ArrayLike) -> NDArray[np.float64]:
    """The values of a Zernike polynomial at points (N, 2) of the unit disk."""

def zernike_fit(
    pupil: ArrayLike, values: ArrayLike, terms: Sequence[tuple[int, int]]
) -> tuple[NDArray[np.float64], float]:
    """The coefficients of the least-squares fit, and the RMS of the residual."""

def extrude_outline(
    contours: tuple[Sequence[Sequence[tuple[float, float, float]]], tuple[float, float]],
    lo: float,
    hi: float,
    rims: tuple[tuple[float, float], tuple[float, float]],
) -> Solid:
    """A prism over an outline, lo < z < hi. `rims` has the fillet and the chamfer of the lower and of the upper rim; 0 for none."""

def revolve_outline(
    contours: tuple[Sequence[Sequence[tuple[float, float, float]]], tuple[float, float]],
    start: float,
    angle: float,
) -> Solid:
    """A solid of revolution: an outline in the half-plane x >= 0, revolved about its axis x = 0 from `start` by `angle` degrees."""

def compare_photons(
    a: str | PathLike[str],
    b: str | PathLike[str],
    least: float,
    flags: bool,
    hits: bool,
    photons: tuple[int, int] | None,
) -> CompareRow:
    """Compares two files of photons: see `rayweave.photons.compare`."""

def photon_property_svg(title: str, curves: Sequence[tuple[str, Sequence[tuple[float, float]]]]) -> str:
    """Plots properties against wavelength as SVG; a curve is its label with the unit, and pairs of a wavelength in nm and a value."""

@final
class CompiledDetector:
    """A detector, compiled: see `rayweave.photons.Detector`."""

    @property
    def warnings(self) -> list[str]:
        """Warnings of the reader of the file."""

    @property
    def optical_warnings(self) -> list[str]:
        """The probable mistakes in optical properties and surfaces, one sentence each."""

    @property
    def notes(self) -> list[str]:
        """The ignored properties and surfaces, one sentence each."""

    @property
    def sensors(self) -> list[tuple[str, str]]:
        """The names of the sensitive volumes and of their sensors."""

    def materials(
        self,
    ) -> list[tuple[str, list[tuple[str, NDArray[np.float64], NDArray[np.float64], str]], list[tuple[str, float]]]]:
        """The materials: name; properties with their energies in MeV, values and units; constants."""

    def surfaces(
        self,
    ) -> list[tuple[tuple[str, str, str], float, tuple[str, list[tuple[str, NDArray[np.float64], NDArray[np.float64], str]], list[tuple[str, float]]]]]:
        """The surfaces: the words of model, finish and type, the value; name, properties and constants as those of materials."""

    def findings(self) -> list[tuple[str, str | None, str]]:
        """The findings of the lint: rule (optical or unused), place, problem with its reason and suggestion."""

    def check_start(self, source: PhotonSource, settings: Mapping[str, Any]) -> str | None:
        """A sentence about photons of a source that start outside the world or in a material without a refractive index; an error if
        all of them do.
        """

    def read_hits(self, path: str | PathLike[str]) -> PhotonHits:
        """Hits from a table: .csv, or .npy with the file of names beside it."""

    def volume_source(self, name: str, is_boundary: bool, light: Mapping[str, Any]) -> PhotonSource:
        """A torch in a volume, or on its boundary."""

    def gensteps(self, gensteps: ArrayLike, materials: Mapping[int, str]) -> PhotonSource:
        """Gensteps in the layout of Opticks, (N, 6, 4), or of Geant4, (N, 16), with the names of materials by their numbers."""

    def simulate(
        self,
        source: PhotonSource,
        settings: Mapping[str, Any],
        progress: Callable[[int, int], object] | None = None,
    ) -> PhotonRun:
        """Simulates photons of a source. `progress` is called with the number of finished photons and the total."""

def load_detector(
    path: str | PathLike[str],
    tables: PhotonTables,
    parameters: dict[str, float | str] | None = None,
    *,
    allow: Sequence[str | PathLike[str]] = ...,
    strict: bool = False,
    allow_missing: bool = False,
) -> CompiledDetector:
    """Reads a detector from a GDML file, or from a native model converted from one."""

def loads_detector(
    text: str,
    tables: PhotonTables,
    parameters: dict[str, float | str] | None = None,
    *,
    allow: Sequence[str | PathLike[str]] = ...,
    strict: bool = False,
    allow_missing: bool = False,
    native: bool = False,
) -> CompiledDetector:
    """Reads a detector from the text of a GDML file, or of a native model."""

@final
class PhotonHistories:
    """The histories of a run: see `rayweave.photons.Histories`."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the steps by name."""

    @property
    def process_names(self) -> list[str]:
        """The names of the processes, by their numbers."""

    @property
    def volume_paths(self) -> list[str]:
        """The paths of the volumes, by their numbers."""

    @property
    def surface_names(self) -> list[str]:
        """The names of the optical surfaces, by their numbers."""

    def sequences(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.uint64], list[str]]:
        """The sequences: photons, tracks, words (N, 2), texts."""

    @property
    def processes(self) -> list[tuple[str, int]]:
        """The number of processes by name."""

    @property
    def surfaces(self) -> list[tuple[int | None, str, int]]:
        """The number of events at each optical surface (None: a bare interface): surface, process, number."""

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the table of steps of the command: .csv, .npy or .parquet."""

    def tracks_svg(self, title: str, plane: str | None = None, photons: list[int] | None = None) -> str:
        """The tracks in a section of the detector, as SVG: all of them, or those of some photons."""

@final
class PhotonHits:
    """The detected photons of a run: see `rayweave.photons.Hits`."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns by name."""

    @property
    def sensor_paths(self) -> list[str]:
        """The paths of the sensors, in the order of their placements."""

    def opticks(self) -> NDArray[np.uint32]:
        """The photons in the layout of Opticks, as the bits of float32 numbers."""

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the table of hits of the command: .csv, .npy or .parquet."""

    def select(self, rows: Sequence[int]) -> PhotonHits:
        """Some of the hits by their rows."""

    def sensors_named(self, text: str) -> list[int]:
        """The numbers of the sensors whose path ends with a text, or of all sensors ("all")."""

    def map_svg(
        self,
        title: str,
        cells: int | None = None,
        plane: str | None = None,
        scale: str = "linear",
        chosen: Sequence[int] | None = None,
    ) -> str:
        """Maps of the hits of each sensor as SVG, with a number of cells along their longer side, a plane of all maps, and the scale of the
        colours.
        """

    def spectra_svg(
        self, title: str, bins: int | None, time: tuple[float, float] | None, chosen: Sequence[int] | None
    ) -> str:
        """Spectra of times and wavelengths as SVG, with a number of bins and the range of times, of all hits or those of some sensors."""

@final
class PhotonRun:
    """The result of a run: see `rayweave.photons.Run`."""

    @property
    def photons(self) -> int:
        """The number of photons, with those that wavelength shifters emitted in addition."""

    @property
    def steps(self) -> int:
        """The number of steps of all photons."""

    @property
    def seconds(self) -> float:
        """The duration of the run in seconds."""

    @property
    def ends(self) -> dict[str, int]:
        """The number of photons by way of ending."""

    @property
    def is_dark(self) -> bool:
        """Whether the run has many photons and no hit."""

    def notes(self, mistakes: int | None = None, *, few: bool = True) -> list[str]:
        """Remarks about the run: with a number of probable mistakes in the detector, that about a run without hits; and that about
        photons stopped by the limit of steps, also if they are `few`.
        """

    @property
    def hits(self) -> PhotonHits:
        """The detected photons."""

    @property
    def histories(self) -> PhotonHistories | None:
        """The recorded histories, if there are any."""

@final
class PhotonSource:
    """A source of photons: see `rayweave.photons.Source`."""

    @staticmethod
    def point(position: ArrayLike, light: Mapping[str, Any]) -> PhotonSource:
        """A point."""

    @staticmethod
    def disc(
        centre: ArrayLike, normal: ArrayLike, radius: float, light: Mapping[str, Any]
    ) -> PhotonSource:
        """A flat disc."""

    @staticmethod
    def line(start: ArrayLike, end: ArrayLike, light: Mapping[str, Any]) -> PhotonSource:
        """A straight line."""

    @staticmethod
    def from_opticks(photons: ArrayLike) -> PhotonSource:
        """Photons in the layout of Opticks, (N, 4, 4)."""

    @staticmethod
    def photons(
        positions: ArrayLike,
        directions: ArrayLike,
        wavelengths_nm: ArrayLike,
        times: ArrayLike,
        polarisations: ArrayLike | None = None,
    ) -> PhotonSource:
        """Given photons."""

    @property
    def notes(self) -> list[str]:
        """Sentences about gensteps that do not fit their materials."""

    @property
    def count(self) -> int | None:
        """The number of photons, if it is limited."""

@final
class PhotonTables:
    """Tables of measured surfaces: see `rayweave.photons.SurfaceTables`."""

    def __new__(
        cls, folder: str | PathLike[str] | None = None, dichroic: str | PathLike[str] | None = None
    ) -> PhotonTables:
        """The tables of a folder and of a dichroic file."""

    def with_lut(self, name: str, probabilities: ArrayLike) -> PhotonTables:
        """The same with a table of probabilities for a surface or a finish."""

    def with_davis(self, name: str, reflectance: ArrayLike, directions: ArrayLike) -> PhotonTables:
        """The same with reflectances and directions for a surface or a finish."""

    def with_dichroic(
        self, name: str, wavelengths_nm: ArrayLike, angles_degrees: ArrayLike, percent: ArrayLike
    ) -> PhotonTables:
        """The same with a transmittance for a surface."""

@final
class Polygons:
    """A region of the plane bounded by polygons. Immutable; created by `from_polygons`.

    >>> import rayweave as rw
    >>> frame = rw.from_polygons([[[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [1, 3], [3, 3], [3, 1]]])
    >>> frame.area, frame.contains([[0.5, 2], [2, 2]])
    (12.0, array([ True, False]))
    >>> round(frame.extrude(0, 2).volume)
    24
    """

    @property
    def outside(self) -> int:
        """The side far away from all contours: +1 outside, -1 inside."""

    @property
    def area(self) -> float:
        """The area, inf if the region is unbounded."""

    @property
    def bounds(self) -> NDArray[np.float64]:
        """A box around the contours: float64 (2, 2), the smallest and the largest coordinates; (+inf, -inf) without contours."""

    @property
    def contours(self) -> tuple[NDArray[np.float64], ...]:
        """The contours after simplification, without vertices that are not corners: arrays of shape
        (N, 2).
        """

    def trace(self, origin: ArrayLike, direction: ArrayLike) -> RootRay:
        """The root-ray of the line origin + t direction."""

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether points (N, 2) or (2,) are inside: bool (N,). A point on the boundary has the side
        that the line along +x has just after it.
        """

    def solid(self, d: int = 2) -> SpaceSolid:
        """The region as a solid of `rayweave.space`: of the plane or, unbounded along the other axes, of a space of `d` dimensions."""

    def extrude(self, lo: float, hi: float) -> Solid:
        """The prism over the region, lo < z < hi, as a solid."""

    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __copy__(self) -> Polygons: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> Polygons: ...

def from_polygons(contours: Iterable[ArrayLike], outside: int = 1) -> Polygons:
    """The region bounded by closed contours, arrays of shape (N, 2): islands go around counter-clockwise, holes clockwise.
    `outside` is +1 or, if the outermost contours are holes, -1.

    >>> import rayweave as rw
    >>> triangle = rw.from_polygons([[[0, 0], [2, 0], [0, 2]]])
    >>> triangle.area
    2.0
    """

def render(subject: Subject, kind: str, arguments: Mapping[str, Any]) -> NDArray[Any]:
    """A picture of a solid or a model: see `rayweave.render`."""

def sheet_svg(subject: Subject, title: str, is_one: bool, arguments: Mapping[str, Any]) -> str:
    """A sheet with pictures of a solid or a model and a legend, as SVG: see `rayweave.sheet`."""

def technical_svg(
    subject: Subject,
    title: str,
    size: tuple[int, int] | None,
    projection: str,
    evaluator: str | None,
    threads: int | None,
) -> tuple[str, list[str]]:
    """A technical drawing of a solid or a model as SVG, with remarks: see `rayweave.sheet`."""

def notebook_png(subject: Subject) -> bytes:
    """A picture as a PNG file for notebooks."""

@final
class RootRay:
    """The parts of one trajectory inside one solid: the side on which it starts and the times at which it changes sides.

    `start` is +1 or "outside", -1 or "inside": the side as t goes to -inf. `roots` are the times of the crossings: finite and
    strictly increasing. The operators `| & - ^ ~` are exact: equal times toggle together, and no comparison uses a
    tolerance. It unpacks and compares as the pair `(start, list of roots)`.

    >>> import rayweave as rw
    >>> a, b = rw.RootRay("outside", [1, 4]), rw.RootRay("outside", [2, 3])
    >>> a - b
    RootRay(+1, [1.0, 2.0, 3.0, 4.0])
    >>> (a & b).spans(), (~a).starts_inside
    ([(2.0, 3.0)], True)
    """

    def __new__(cls, start: int | Literal["outside", "inside"], roots: ArrayLike) -> RootRay: ...

    @staticmethod
    def from_hits(column: ArrayLike) -> RootRay:
        """The root-ray of one column of a hit array: -inf entries give the start, equal entries cancel, +inf is dropped."""

    def to_hits(self) -> NDArray[np.float64]:
        """The root-ray as a column of a hit array: float64 (H,), -inf first if it starts inside, padded with +inf."""

    @property
    def start(self) -> int:
        """+1 if the trajectory starts outside, -1 if it starts inside."""

    @property
    def roots(self) -> list[float]:
        """The times of the crossings, in order."""

    @property
    def starts_inside(self) -> bool:
        """Whether the trajectory starts inside, as t goes to -inf."""

    @property
    def ends_inside(self) -> bool:
        """Whether the trajectory ends inside, as t goes to +inf."""

    def is_inside(self, t: float) -> bool:
        """Whether the trajectory is inside just after `t`."""

    def spans(self) -> list[tuple[float, float]]:
        """The open intervals of times spent inside, in order; the ends may be infinite."""

    def clip(self, t_min: float = ..., t_max: float = ...) -> RootRay:
        """The crossings with t_min < t < t_max; the side just after t_min becomes the start."""

    def weld(self, min_sep: float | None = None) -> RootRay:
        """The root-ray without pieces shorter than `min_sep`, by default `rayweave.rootray.min_sep` of their ends."""

    def __or__(self, other: RootRay, /) -> RootRay: ...
    def __ror__(self, other: RootRay, /) -> RootRay: ...
    def __and__(self, other: RootRay, /) -> RootRay: ...
    def __rand__(self, other: RootRay, /) -> RootRay: ...
    def __sub__(self, other: RootRay, /) -> RootRay: ...
    def __rsub__(self, other: RootRay, /) -> RootRay: ...
    def __xor__(self, other: RootRay, /) -> RootRay: ...
    def __rxor__(self, other: RootRay, /) -> RootRay: ...
    def __invert__(self) -> RootRay: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, index: Literal[0, -2], /) -> int: ...
    @overload
    def __getitem__(self, index: Literal[1, -1], /) -> list[float]: ...
    def __iter__(self) -> Iterator[Any]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

def min_sep(t1: float, t2: float) -> float:
    """The minimum separation of two root times: see `rayweave.rootray.min_sep`."""

def root_problems(roots: ArrayLike) -> list[str]:
    """All problems of a list of root times, as messages: see `rayweave.rootray.validate`."""

def surface_count(rays: Sequence[RootRay]) -> tuple[int, list[tuple[float, int]]]:
    """The number of root-rays that are inside: see `rayweave.rootray.surface_count`."""

@final
class Section:
    """Plane section of a model: areas and contours of each medium or region.

    A notebook shows it as a picture.

    >>> import rayweave as rw
    >>> cut = rw.section(rw.box([2, 3, 4]), "z=1")
    >>> cut.names, cut.areas
    (['solid'], array([6.]))
    >>> [contour.shape for contour in cut.contours("solid")]
    [(4, 2)]
    """

    @property
    def names(self) -> list[str]:
        """The names of the media or regions that the plane intersects, in their order."""

    @property
    def plane(self) -> str:
        """The plane in words: `z = 0.5`."""

    @property
    def offset(self) -> float:
        """Offset of the plane: its coordinate along the axis or, if it was given by a normal, its signed distance from `point` along
        `normal`.
        """

    @property
    def tolerance(self) -> float:
        """Maximum distance of contours from the surfaces; the error of an area is at most this times the perimeter."""

    @property
    def in_face(self) -> bool:
        """True if the plane lies in a plane face of a shape of the model. The section then shows the material on the side of larger
        coordinates: that of the box from z = -1 to 1 is full at -1 and empty at 1. A plane slightly beside it leaves no choice.

        >>> import rayweave as rw
        >>> rw.section(rw.box(2), "z=1")
        <Section z = 1 in a face, on its +z side, areas in mm^2: nothing>
        """

    @property
    def areas(self) -> NDArray[np.float64]:
        """(P,) areas of the parts."""

    @property
    def area_errors(self) -> NDArray[np.float64]:
        """(P,) the largest errors of the areas: the tolerance times the perimeter. Areas between straight edges are exact to rounding."""

    @property
    def perimeters(self) -> NDArray[np.float64]:
        """(P,) perimeters of the parts, holes included."""

    def contours(self, name: str) -> tuple[NDArray[np.float64], ...]:
        """The contours of a part, each (N, 2): outlines counter-clockwise, holes clockwise; the first point is not repeated at the
        end.
        """

    @property
    def frame(self) -> NDArray[np.float64]:
        """A point of the plane and its axes, to the right and up, (3, 3): `frame[0] + u * frame[1] + v * frame[2]` is a point of space."""

    def __len__(self) -> int:
        """The number of parts."""

    def __iter__(self) -> Iterator[str]:
        """The names of the parts."""

    def to_pandas(self) -> Any:
        """The parts as a pandas DataFrame: name, area, area_error, perimeter."""

    def to_arrow(self) -> Any:
        """The parts as an Arrow table: name, area, area_error, perimeter."""

    def to_xarray(self) -> Any:
        """The parts as an xarray Dataset with the dimension `row`: name, area, area_error, perimeter."""

    def save(self, path: str | PathLike[str], *, title: str = "") -> None:
        """Writes the section as a picture (.svg) or as closed polylines and circles (.dxf): see `rayweave.save_section`.

        >>> import rayweave as rw
        >>> rw.section(rw.sphere(1), "z=0").save("circle.svg")
        """

    def show(self) -> None:
        """Shows the section: in a notebook below the cell, otherwise in the browser."""

    def _repr_svg_(self) -> str: ...

def section_from_parts(
    plane: Sequence[float],
    parts: Sequence[Any],
    corners: Sequence[Sequence[float]],
    tolerance: float,
    unit: str,
    in_face: bool,
) -> Section:
    """A section from its pickled parts."""

def section_list(
    subject: Subject,
    plane: str,
    point: Sequence[float],
    normal: Sequence[float] | None,
    offsets: Sequence[float] | None,
    by: str,
    tolerance: float | None,
    columns: int,
    within: Sequence[Sequence[float]] | None,
    evaluator: str | None,
    threads: int | None,
) -> list[Section]:
    """Sections of a solid or a model by a plane, at the given offsets: see `rayweave.section`."""

def section_text(sections: Sequence[Section], format: str, title: str) -> str:
    """Sections as one document, "svg" or "dxf"."""

def manuals() -> list[dict[str, Any]]:
    """The manual pages of all shapes: dicts with the fields `name`, `parameters`, `equation`, `faces` and `text`."""

def shape(name: str, values: Sequence[Any]) -> Solid:
    """The shape of this name; `values` are those of all its parameters, in the order of the manual
    page.
    """

@final
class Solid:
    """A solid: a boolean combination of shapes under affine maps. It never changes.

    >>> import rayweave as rw
    >>> washer = (rw.cylinder(5, 1) - rw.cylinder(2)).translate([0, 0, 0.5])
    >>> washer.contains([3, 0, 0.5])
    array([ True])
    >>> washer.hits([-9, 0, 0.5], [1, 0, 0]).ravel()
    array([ 4.,  7., 11., 14.])

    Create solids with the functions `sphere`, `box`, ... and combine them with `|` (union), `&` (intersection), `-`
    (difference), `^` (symmetric difference) and `~` (complement). Transforms are about the origin and return a new
    solid; matrices are world_from_local and act on columns.

    Queries take `origins` and `directions` of shape (N, 3) or (3,), broadcast against each other, or grids (..., 3), whose rays are
    numbered in row-major order; `t` is in units of the direction, which need not be of unit length. `t_min` and `t_max` restrict every ray to the open window between
    them. `evaluator` is "packets" (the default), "weave" (one sweep per ray), "reference" (slow and simple) or
    "single_hit" (crossing by crossing); all give bit-identical answers. `threads` is by default the environment
    variable RAYWEAVE_THREADS, or the number of cores; answers do not depend on it.

    `device` is "cpu", "gpu" (a graphics card, in packages built with the Cargo feature `gpu`; an error if there is none or it cannot
    hold the model) or "auto" (a graphics card if there is one that can hold the model, otherwise the CPU, with a warning). The
    answers are bit-identical. The solid is compiled for the card once; batches of some 100,000 rays keep it busy. `devices()` lists
    the cards.
    """

    def translate(self, v: ArrayLike, y: float | None = None, z: float | None = None) -> Solid:
        """The solid moved by a vector (3,), or by its components x, y and z."""

    def rotate(self, axis: ArrayLike, degrees: float | None = None) -> Solid:
        """The solid turned about an axis through the origin, right-handed, by an angle in degrees. The axis need not be of unit
        length.
        """

    def rotate_x(self, degrees: float) -> Solid:
        """The solid turned about the x axis, +y towards +z, by an angle in degrees."""

    def rotate_y(self, degrees: float) -> Solid:
        """The solid turned about the y axis, +z towards +x, by an angle in degrees."""

    def rotate_z(self, degrees: float) -> Solid:
        """The solid turned about the z axis, +x towards +y, by an angle in degrees."""

    def scale(self, s: float | ArrayLike, y: float | None = None, z: float | None = None) -> Solid:
        """The solid scaled about the origin by a number, or by one number per axis, as an array (3,) or as x, y and z; negative
        numbers mirror it.
        """

    def mirror(self, normal: ArrayLike) -> Solid:
        """The solid mirrored in the plane through the origin with this normal, which need not be of unit length."""

    def transform(self, matrix: ArrayLike) -> Solid:
        """The image under an affine map: a 4 x 4 matrix world_from_local that acts on columns, with the last row 0, 0, 0, 1."""

    def named(self, name: str) -> Solid:
        """The same solid with a name, which becomes part of the names of its faces."""

    def __or__(self, other: Solid, /) -> Solid: ...
    def __ror__(self, other: Solid, /) -> Solid: ...
    def __and__(self, other: Solid, /) -> Solid: ...
    def __rand__(self, other: Solid, /) -> Solid: ...
    def __sub__(self, other: Solid, /) -> Solid: ...
    def __rsub__(self, other: Solid, /) -> Solid: ...
    def __xor__(self, other: Solid, /) -> Solid: ...
    def __rxor__(self, other: Solid, /) -> Solid: ...

    def __bool__(self) -> bool:
        """No truth value: `a and b` would be `b`."""

    def __add__(self, _other: Any, /) -> NoReturn:
        """No sum: the union is `a | b`."""

    def __radd__(self, _other: Any, /) -> NoReturn: ...
    def __invert__(self) -> Solid: ...

    @overload
    def hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: float = ...,
        t_max: float = ...,
        *,
        return_surfaces: Literal[False] = False,
        out: NDArray[np.float64] | None = None,
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> NDArray[np.float64]:
        """Times at which rays enter and leave the solid: a float64 array (H, N), or a pair of it and the surfaces.

        Column = ray, row = k-th entry, each column in order and padded with +inf; H is the smallest even number, at
        least 2, that is sufficient for all columns. The column of a ray that is inside just after t_min begins with
        -inf; a ray that is inside just before t_max has no entry for that end. With `return_surfaces`, an int32 array
        (H, N) has the face of each entry (`surface_names` of `crossings` has their names), or -1.

        `out` is a float64 array of an even number of rows, enough for all columns, or with `return_surfaces` a pair of it and an
        int32 array of the same shape. The hits are written to it, and it is returned instead of a new array. It is
        fastest if its rows are contiguous. After an error its contents are undefined.
        """
    @overload
    def hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: float = ...,
        t_max: float = ...,
        *,
        return_surfaces: Literal[True],
        out: NDArray[np.float64] | tuple[NDArray[np.float64], NDArray[np.int32]] | None = None,
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]: ...

    def crossings(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: float = ...,
        t_max: float = ...,
        *,
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> Crossings:
        """All crossings of the surface, sorted by ray, then t: see `Crossings`."""

    def crossings_along(
        self,
        curves: Trajectory | Iterable[Trajectory],
        t_min: float | ArrayLike,
        t_max: float | ArrayLike,
        *,
        threads: int | None = None,
    ) -> Crossings:
        """All crossings of the surface along one curve, or along each in a list of curves, strictly between two times: see
        `Crossings`, where `ray` is the number of the curve and `t` its own time. The times are finite numbers, or (N,)
        arrays with one for each curve. Curves are described in `rayweave.space`: `Helix` and others, or any object with
        `position(t)`, `velocity(t)` and `acceleration_bound(t0, t1)`.
        """

    def nearest(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: float = 0.0,
        t_max: float = ...,
        *,
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> Crossings:
        """The first crossing of each ray after t_min: see `Crossings`. A ray that crosses nothing has t = inf, surface = -1, and NaN
        for point and normal.
        """

    def occurrence_paths(
        self, occurrences: NDArray[np.integer[Any]] | Sequence[int], *, placed: bool = False
    ) -> list[str]:
        """Paths of names and copy numbers, such as "tower[3]/brick[12]/hole", of `occurrences` as in
        `Crossings.occurrence`: a list of (M,) texts, "" for -1. With `placed`, each path ends at the innermost placed
        solid: "tower[3]/brick[12]". Copies have the numbers of the file, or are counted from 0 in the order of `place`;
        of equal names in one place, the second one ends in "#2".
        """

    def explain(
        self, origin: ArrayLike, direction: ArrayLike, t_min: float = ..., t_max: float = ...
    ) -> Explanation:
        """Explains the crossings of one ray: every decision of the single-hit evaluator, with its reason. Print the result to read
        it as text, or use its `questions`: see `Explanation`. `origin` and `direction` are three numbers each.
        """

    def contains(
        self,
        points: ArrayLike,
        *,
        evaluator: str | None = None,
        threads: int | None = None,
        device: Literal["cpu", "gpu", "auto"] = "cpu",
    ) -> NDArray[np.bool_]:
        """Whether points (N, 3) or (3,) are inside: bool (N,), or (...) for a grid (..., 3). A point on the surface has the side of
        a ray that lies in the surface.
        """

    def distance(
        self,
        points: ArrayLike,
        *,
        precision: float = 1e-9,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Distances:
        """Signed distances of points (N, 3), (3,) or of a grid (..., 3) from the surface, and the nearest points on it, with bounds: see
        `Distances`. Distances are negative inside. One whose bounds differ by at most `precision` times the distance (or by
        rounding) counts as exact. `progress=True` shows the progress on standard error; a function is called with the numbers of
        finished and of all points.

        >>> import rayweave as rw
        >>> found = (rw.box(2) - rw.sphere(0.5)).distance([[3, 2, 0], [0, 0, 0.8]])
        >>> found.distance.round(9).tolist(), found.is_exact.tolist()
        ([2.236067977, -0.2], [True, True])
        >>> found.nearest.round(9).tolist()
        [[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        """

    @property
    def bounds(self) -> NDArray[np.float64]:
        """A box around the solid: float64 (2, 3), the smallest and the largest coordinates. The box
        of the empty solid is (+inf, -inf). The box is conservative and may be larger than the
        solid.

        >>> import rayweave as rw
        >>> rw.sphere(2).bounds
        array([[-2., -2., -2.],
               [ 2.,  2.,  2.]])
        """

    def __eq__(self, other: object, /) -> bool:
        """Equal if built in the same way from equal parts (not: if they fill the same space)."""

    def __hash__(self) -> int: ...

    @property
    def name(self) -> str | None:
        """The name that `named` gave it, or None."""

    @property
    def volume(self) -> float:
        """The volume: exact for a single shape whose volume has a closed form and for a mesh whose surface does not intersect itself,
        otherwise (`biconic`, `freeform`, `convex`, `quadric`, some aspheres, all expressions) measured by rays within 0.1 % at a
        confidence of 99 %. `rayweave.measure` returns the interval.

        >>> import rayweave as rw
        >>> rw.box([1, 2, 3]).volume
        6.0
        """

    @property
    def area(self) -> float:
        """The surface area, measured by rays at a confidence of 99 %. `rayweave.measure` returns the interval."""

    @property
    def centroid(self) -> NDArray[np.float64]:
        """(3,) the centre of volume, measured by rays. `rayweave.measure` returns the intervals."""

    def to_mesh(self, tolerance: float | None = None) -> Mesh:
        """The surface as triangles within `tolerance` of it: see `rayweave.Mesh`. The default is 1/5000 of the diagonal."""

    def save(
        self,
        path: str | PathLike[str],
        name: str | None = None,
        *,
        format: str | None = None,
        tolerance: float | None = None,
        text: bool = False,
        allow_unsound: bool = False,
    ) -> list[str]:
        """Writes the solid to a file, complete or not at all, in the format of its ending: a model file (.toml), a mesh (.stl, .obj,
        .ply, .off, .3mf, .gltf, .glb), OpenSCAD (.csg) or GDML (.gdml). `name` replaces the name of the solid. The other arguments
        and the result are those of `Model.save`.
        """

    def render(self, **options: Any) -> NDArray[Any]:
        """A picture of the solid as an array: see `rayweave.render`, whose options these are."""

    def _repr_png_(self) -> bytes:
        """The picture that a notebook shows."""

    def __copy__(self) -> Solid: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> Solid: ...

def solid_from_bytes(data: bytes) -> Solid:
    """A solid from its pickled bytes."""

def empty() -> Solid:
    """The empty solid: the neutral element of union.

    >>> import rayweave as rw
    >>> rw.empty().contains([0, 0, 0])
    array([False])
    """

def universe() -> Solid:
    """All of space: the neutral element of intersection.

    >>> import rayweave as rw
    >>> (rw.universe() - rw.sphere(1)).contains([[0, 0, 0], [2, 0, 0]])
    array([False,  True])
    """

def union(*solids: Solid | Iterable[Solid]) -> Solid:
    """The union of solids, given one by one or as one iterable; `empty()` if there are none.

    >>> import rayweave as rw
    >>> rw.union(rw.sphere(1), rw.box(1)) == rw.union([rw.sphere(1), rw.box(1)])
    True
    """

def intersection(*solids: Solid | Iterable[Solid]) -> Solid:
    """The intersection of solids, given one by one or as one iterable; `universe()` if there are none.

    >>> import rayweave as rw
    >>> rw.intersection(rw.box(2), rw.sphere(1.2)).contains([0.9, 0, 0])
    array([ True])
    """

def place(solid: Solid, transforms: ArrayLike) -> Solid:
    """The union of the images of a solid under many maps: translations (N, 3) or matrices world_from_local (N, 4, 4). The
    solid is compiled once, regardless of the number of maps.

    >>> import rayweave as rw
    >>> row = rw.place(rw.sphere(1), [[0, 0, 0], [3, 0, 0], [6, 0, 0]])
    >>> row.hits([-2, 0, 0], [1, 0, 0]).ravel()
    array([1., 3., 4., 6., 7., 9.])
    """

@disjoint_base
class Curve:
    """A trajectory r(t) in R^d: the base class of `Line`, `Parabola`, `Arc`, `Helix` and `Spline`.
    Immutable.

    >>> import rayweave.space as rs
    >>> isinstance(rs.Line([0, 0], [1, 0]), rs.Curve)
    True
    """

    @property
    def dimension(self) -> int:
        """The dimension of the space: 2, 3 or 4."""

    @property
    def domain(self) -> tuple[float, float]:
        """The first and the last time at which the curve is defined; infinite if it is unbounded."""

    def position(self, t: ArrayLike) -> NDArray[np.float64]:
        """r(t): (d,), or (N, d) for times (N,)."""

    def velocity(self, t: ArrayLike) -> NDArray[np.float64]:
        """r'(t): (d,), or (N, d) for times (N,)."""

    def acceleration_bound(self, t0: float, t1: float) -> float:
        """An upper bound of the length of r'' between two times, t0 < t1."""

    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> Self: ...

@final
class Line(Curve):
    """The straight line origin + t direction.

    Both are of shape (d,), d = 2, 3 or 4. `t` is in units of the direction, which need not be of unit length; a
    direction of length zero is a point at rest. Raises `RayweaveError` for numbers that are not finite.

    >>> import rayweave.space as rs
    >>> rs.Line([0, 0], [1, 2]).position([0, 1])
    array([[0., 0.],
           [1., 2.]])
    """

    def __new__(cls, origin: ArrayLike, direction: ArrayLike) -> Line: ...

@final
class Parabola(Curve):
    """The path of a projectile, position + t velocity + t^2 / 2 acceleration.

    All are of shape (d,), d = 2, 3 or 4: position and velocity at t = 0, and the constant acceleration, in units of
    length and of t. Raises `RayweaveError` for numbers that are not finite.

    >>> import rayweave.space as rs
    >>> throw = rs.Parabola([0, 0], [2, 4], [0, -2])
    >>> throw.position(2)
    array([4., 4.])
    """

    def __new__(cls, position: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike) -> Parabola: ...

@final
class Arc(Curve):
    """A circle or an ellipse, centre + cos(speed t) axes[0] + sin(speed t) axes[1]: the window of times selects an arc of
    it.

    `centre` is of shape (d,), d = 2, 3 or 4, `axes` of shape (2, d): two perpendicular axes whose length is the radius
    give a circle, others an ellipse (its conjugate semi-diameters). `speed` is in degrees per unit of t: with 1, the
    default, `t` is the angle in degrees. Raises `RayweaveError` for numbers that are not finite.

    >>> import rayweave.space as rs
    >>> circle = rs.Arc([0, 0], [[2, 0], [0, 2]])
    >>> circle.position(90).round(6)
    array([0., 2.])
    >>> rs.half_space(0, 2).crossings_along(circle, 0, 360).t.round(6)
    array([ 90., 270.])
    """

    def __new__(cls, centre: ArrayLike, axes: ArrayLike, speed: float = 1.0) -> Arc: ...

    @staticmethod
    def about(centre: ArrayLike, normal: ArrayLike, start: ArrayLike, speed: float = 1.0) -> Arc:
        """The circle in space about `centre` from `start`, right-handed about `normal` (of any length but 0), with `speed`
        degrees per unit of t. The part of start - centre along the normal is dropped.
        """

@final
class Helix(Curve):
    """The path of a charged particle in a uniform magnetic field: a helix about the field.

    `position` and `velocity`, of shape (3,), are those at t = 0; `axis` is the direction of the field, of any length but 0;
    `radius` is the gyro radius, the speed across the field divided by the signed gyro frequency. A positive radius
    turns clockwise as seen against the field, like a positive charge, a negative one counter-clockwise; an infinite
    radius is a straight line. For a particle of charge q and momentum p across a field B it is p / (q B). Raises
    `RayweaveError` for numbers that are not finite, an axis of length zero, a radius of 0.

    >>> import rayweave.space as rs
    >>> path = rs.Helix([0, 0, 0], [1, 0, 1], axis=[0, 0, 1], radius=2)
    >>> path.position(0).tolist(), path.velocity(0).tolist()
    ([0.0, 0.0, 0.0], [1.0, 0.0, 1.0])
    """

    def __new__(cls, position: ArrayLike, velocity: ArrayLike, axis: ArrayLike, radius: float) -> Helix: ...

    @staticmethod
    def with_frequency(
        position: ArrayLike, velocity: ArrayLike, axis: ArrayLike, frequency: float
    ) -> Helix:
        """The same helix, defined by the signed gyro frequency in degrees per unit of t."""

    @staticmethod
    def about(centre: ArrayLike, axis: ArrayLike, start: ArrayLike, pitch: float) -> Helix:
        """The helix from `start` about the line through `centre` along `axis`, right-handed, rising along the axis by
        `pitch` in every turn of 360 units of t: `t` is the angle in degrees. A pitch of 0 is a circle; a negative one
        makes the helix left-handed.
        """

@final
class Spline(Curve):
    """A cubic spline: at `points[k]` at time `knots[k]`, with r' and r'' continuous; defined from the first to the last knot.

    `knots` are (N,), at least two and strictly increasing, `points` (N, d), d = 2, 3 or 4. `ends` is "natural" (r'' = 0 at both
    ends), "periodic" (r' and r'' are equal at both ends, and the points must be) or "clamped", with `velocities` (2, d)
    at the two ends. Raises `RayweaveError` that names the first bad knot or point.

    >>> import rayweave.space as rs
    >>> path = rs.Spline([0, 1, 2], [[0, 0], [1, 1], [2, 0]])
    >>> path.domain, path.position(1)
    ((0.0, 2.0), array([1., 1.]))
    """

    def __new__(
        cls,
        knots: ArrayLike,
        points: ArrayLike,
        ends: Literal["natural", "clamped", "periodic"] = "natural",
        velocities: ArrayLike | None = None,
    ) -> Spline: ...

@final
class SpaceSolid:
    """A solid in the plane, in space or in a space of four dimensions: a boolean combination of shapes under affine maps. It never
    changes.

    Create solids with the functions of `rayweave.space` and combine them with `|` (union), `&` (intersection), `-`
    (difference), `^` (symmetric difference) and `~` (complement); both sides must be of the same dimension. Maps are
    about the origin and return a new solid. Axes are counted from 0. Lengths must be 0 or of a magnitude between 1e-60
    and 1e60.

    >>> import rayweave.space as rs
    >>> ring = rs.ball(2, d=2) - rs.ball(1, d=2)
    >>> ring.contains([[1.5, 0], [0, 0]])
    array([ True, False])
    >>> ring.rotate(0, 1, 90).dimension
    2
    """

    @property
    def dimension(self) -> int:
        """The dimension of the space: 2, 3 or 4."""

    def translate(self, v: ArrayLike) -> SpaceSolid:
        """The solid moved by a vector (d,)."""

    def scale(self, s: float | ArrayLike) -> SpaceSolid:
        """The solid scaled about the origin by a number, or by one number per axis (d,); negative numbers mirror, 0 is an error."""

    def rotate(self, from_axis: int, to_axis: int, degrees: float) -> SpaceSolid:
        """The solid turned about the origin in a coordinate plane, from one axis towards another, by an angle in degrees. (In space,
        from axis 0 to axis 1 is the rotation about z.) Quarter turns are exact.
        """

    def affine(self, matrix: ArrayLike, offset: ArrayLike | None = None) -> SpaceSolid:
        """The image under an invertible affine map, p -> matrix p + offset: matrix (d, d), acting on columns, offset (d,)."""

    def extrude(self, d: int) -> SpaceSolid:
        """The same solid in a space of higher dimension, unbounded along the new axes."""

    def named(self, name: str) -> SpaceSolid:
        """The same solid with a name, which becomes part of the names of its faces."""

    def __or__(self, other: SpaceSolid, /) -> SpaceSolid: ...
    def __ror__(self, other: SpaceSolid, /) -> SpaceSolid: ...
    def __and__(self, other: SpaceSolid, /) -> SpaceSolid: ...
    def __rand__(self, other: SpaceSolid, /) -> SpaceSolid: ...
    def __sub__(self, other: SpaceSolid, /) -> SpaceSolid: ...
    def __rsub__(self, other: SpaceSolid, /) -> SpaceSolid: ...
    def __xor__(self, other: SpaceSolid, /) -> SpaceSolid: ...
    def __rxor__(self, other: SpaceSolid, /) -> SpaceSolid: ...

    def __bool__(self) -> bool:
        """No truth value: `a and b` would be `b`."""

    def __add__(self, _other: Any, /) -> NoReturn:
        """No sum: the union is `a | b`."""

    def __radd__(self, _other: Any, /) -> NoReturn: ...
    def __invert__(self) -> SpaceSolid: ...

    def crossings(self, p: ArrayLike, q: ArrayLike, *, threads: int | None = None) -> PointCrossings:
        """All crossings of the lines through pairs of points, t = 0 at p and t = 1 at q, over all t: see `PointCrossings`. `p` and `q`
        are of shape (N, d) or (d,), broadcast against each other; the two points of a pair must differ.
        """

    def crossings_along(
        self,
        curves: Trajectory | Iterable[Trajectory],
        t_min: float | ArrayLike,
        t_max: float | ArrayLike,
        *,
        threads: int | None = None,
    ) -> PointCrossings:
        """All crossings of one curve, or of each in a list of curves, strictly between two times: see `PointCrossings`. The times
        are finite numbers, or (N,) arrays with one for each curve. Curves are described in `rayweave.space`.
        """

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether points (N, d) or (d,) are inside: bool (N,). A point on the surface has the side of
        a ray that lies in the surface.
        """

    def __eq__(self, other: object, /) -> bool:
        """Equal if built in the same way from equal parts (not: if they fill the same space)."""

    def __hash__(self) -> int: ...
    def __copy__(self) -> SpaceSolid: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> SpaceSolid: ...

def space_solid_from_steps(
    steps: Sequence[tuple[str, int, Sequence[float], str | None, Sequence[int]]],
) -> SpaceSolid:
    """A solid of R^d from its pickled steps."""

def space_shape(call: str, d: int, counts: list[tuple[str, int]], numbers: Sequence[float]) -> SpaceSolid:
    """A solid of R^d without operands. The functions of `rayweave.space` define the meaning of the
    numbers.
    """

def space_join(call: str, solids: Iterable[SpaceSolid]) -> SpaceSolid:
    """The union or the intersection of the solids. There must be at least one, because it determines
    the dimension.
    """

def space_trace(p: ArrayLike, q: ArrayLike, solid: SpaceSolid) -> RootRay:
    """The root-ray of the line through p and q: see `rayweave.space.trace`."""

def space_trace_along(curve: Trajectory, solid: SpaceSolid, t_min: float, t_max: float) -> RootRay:
    """The root-ray of a curve: see `rayweave.space.trace_along`."""

def thickness_maps(
    subject: Subject,
    view: str | None,
    camera: Camera | None,
    size: tuple[int, int] | None,
    by: str,
    evaluator: str | None,
    threads: int | None,
) -> tuple[list[str], list[float], NDArray[np.float64], list[NDArray[np.float64]], str, float | None, list[str]]:
    """Path lengths of rays through each medium: see `rayweave.thickness`."""

def timeline_svg(
    operands: Sequence[tuple[str, RootRay]],
    results: Sequence[tuple[str, RootRay]],
    title: str,
    window: tuple[float, float] | None,
    count: bool,
) -> str:
    """Root-rays drawn over time, as SVG: see `rayweave.timeline`."""

def ray_timeline_svg(
    subject: Subject, origin: ArrayLike, direction: ArrayLike, title: str, window: tuple[float, float] | None
) -> str:
    """Time line of one ray through a solid or a model, as SVG: see `rayweave.ray_timeline`."""

def mesh_parts(
    subject: Subject, tolerance: float | None
) -> list[tuple[str, NDArray[np.float64], NDArray[np.uint32]]]:
    """The regions of a solid or a model as triangle meshes: see `rayweave.Mesh`."""

def mesh_file_parts(
    path: str | PathLike[str],
    format: str | None,
    unit: str | None,
    repair: bool,
    allow: Sequence[str | PathLike[str]],
) -> list[tuple[str, NDArray[np.float64], NDArray[np.uint32]]]:
    """The meshes of a file, closed or not: see `rayweave.load_mesh`."""

def mesh_defects(
    vertices: NDArray[np.float64], triangles: NDArray[np.uint32]
) -> tuple[int, int, float, str, bool]:
    """The number of shells and of open edges, the exact volume (NaN if it is unknown), and a summary of all defects of a mesh."""

def exact_volume(solid: Solid) -> float | None:
    """The exact volume of a single shape, possibly placed; None if the volume must be measured."""
