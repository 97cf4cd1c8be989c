//! The solid as a Python class.

use std::path::PathBuf;
use std::sync::OnceLock;

use numpy::PyArray2;
use numpy::ndarray::arr2;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyIterator, PyList, PyTuple};
use rayweave::formats::WriteOptions;
use rayweave::math::{Affine, Bounds, Vec3};
use rayweave::model::{Node, Program, Solid};
use rayweave::scene::Document;

use crate::drawing::{Subject, notebook_png, render_method};
use crate::engine::{Engine, QueryOptions, computed, time_argument};
use crate::error::{bad_type, bad_value, no_attribute, no_sum, no_truth_value, shown};
use crate::explain::{PyExplanation, explain};
use crate::interrupt::abandonable;
use crate::repr::python_text;
use crate::save::save_scene;
use crate::solid_scene::scene_of;
use crate::to_mesh::to_mesh;
use crate::vectors::{components, direction, finite, invertible, maps, matrix, vector};
use crate::{along, crossings, distance, hits, nearest, occurrences, pickle, points};

/// A solid: a boolean combination of shapes under affine maps. It never changes.
///
/// >>> import rayweave as rw
/// >>> washer = (rw.cylinder(5, 1) - rw.cylinder(2)).translate([0, 0, 0.5])
/// >>> washer.contains([3, 0, 0.5])
/// array([ True])
/// >>> washer.hits([-9, 0, 0.5], [1, 0, 0]).ravel()
/// array([ 4.,  7., 11., 14.])
///
/// Create solids with the functions `sphere`, `box`, ... and combine them with `|` (union), `&` (intersection), `-`
/// (difference), `^` (symmetric difference) and `~` (complement). Transforms are about the origin and return a new
/// solid; matrices are world_from_local and act on columns.
///
/// Queries take `origins` and `directions` of shape (N, 3) or (3,), broadcast against each other, or grids (..., 3), whose rays are
/// numbered in row-major order; `t` is in units of the direction, which need not be of unit length. `t_min` and `t_max` restrict every ray to the open window between
/// them. `evaluator` is "packets" (the default), "weave" (one sweep per ray), "reference" (slow and simple) or
/// "single_hit" (crossing by crossing); all give bit-identical answers. `threads` is by default the environment
/// variable RAYWEAVE_THREADS, or the number of cores; answers do not depend on it.
///
/// `device` is "cpu", "gpu" (a graphics card, in packages built with the Cargo feature `gpu`; an error if there is none or it cannot
/// hold the model) or "auto" (a graphics card if there is one that can hold the model, otherwise the CPU, with a warning). The
/// answers are bit-identical. The solid is compiled for the card once; batches of some 100,000 rays keep it busy. `devices()` lists
/// the cards.
#[pyclass(frozen, module = "rayweave", name = "Solid")]
pub struct PySolid {
    solid: Solid,
    /// Compiled at the first query.
    engine: OnceLock<Engine>,
}

/// Words of other programs for methods, with what to write.
const WORDS: [(&str, &str); 22] = [
    ("add", "a | b"),
    ("bounding_box", "solid.bounds"),
    ("bbox", "solid.bounds"),
    ("center_mass", "solid.centroid"),
    ("colour", "Region(name, solid, colour=...)"),
    ("color", "Region(name, solid, colour=...)"),
    ("cut", "a - b"),
    ("difference", "a - b"),
    ("export", "solid.save(path)"),
    ("fuse", "a | b"),
    ("intersect", "a & b"),
    ("intersection", "a & b"),
    ("intersects", "solid.crossings(origins, directions)"),
    ("move", "solid.translate(v)"),
    ("plot", "solid.render().show()"),
    ("resize", "solid.scale(s)"),
    ("show", "solid.render().show()"),
    ("signed_distance", "solid.distance(points)"),
    ("subtract", "a - b"),
    ("trace", "solid.crossings(origins, directions)"),
    ("union", "a | b"),
    ("write", "solid.save(path)"),
];

/// The number of leaves that are compiled within a few milliseconds.
const SMALL: u64 = 1000;

impl PySolid {
    /// Wraps a solid, without compiling it.
    pub fn from_solid(solid: Solid) -> Self {
        PySolid { solid, engine: OnceLock::new() }
    }

    /// The solid.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// The compiled solid.
    pub fn engine(&self, py: Python<'_>) -> PyResult<&Engine> {
        computed(&self.engine, || {
            let solid = self.solid.clone();
            let compile = move || Engine::of_solid(Program::compile(&solid).map_err(bad_value)?);
            // a thread takes longer to start than a small solid to compile
            match self.solid.has_more_leaves_than(SMALL) {
                true => abandonable(py, compile)?,
                false => py.detach(compile),
            }
        })
    }

    fn apply(&self, map: Affine) -> Self {
        Self::from_solid(self.solid.apply(map))
    }
}

#[pymethods]
impl PySolid {
    /// The solid moved by a vector (3,), or by its components x, y and z.
    #[pyo3(signature = (v: "ArrayLike", y = None, z = None))]
    fn translate(&self, v: &Bound<'_, PyAny>, y: Option<f64>, z: Option<f64>) -> PyResult<Self> {
        let by = match components(v, y, z, "translate")? {
            Some(by) => by,
            None => vector(v, "v")?,
        };
        Ok(self.apply(Affine::translate(by)))
    }

    /// The solid turned about an axis through the origin, right-handed, by an angle in degrees. The axis need not be of unit
    /// length.
    #[pyo3(signature = (axis: "ArrayLike", degrees: "float | None" = None))]
    fn rotate(&self, axis: &Bound<'_, PyAny>, degrees: Option<f64>) -> PyResult<Self> {
        let degrees = degrees.ok_or_else(|| {
            bad_type(
                "degrees is missing: rotate(axis, degrees) turns about a vector. For angles about the coordinate axes, use \
                 rotate_x(degrees), rotate_y(degrees) and rotate_z(degrees).",
            )
        })?;
        let (axis, degrees) = (direction(axis, "axis")?, finite(degrees, "degrees")?);
        Ok(self.apply(Affine::rotation(axis, degrees)))
    }

    /// The solid turned about the x axis, +y towards +z, by an angle in degrees.
    #[pyo3(signature = (degrees))]
    fn rotate_x(&self, degrees: f64) -> PyResult<Self> {
        Ok(self.apply(Affine::rotation(Vec3::X, finite(degrees, "degrees")?)))
    }

    /// The solid turned about the y axis, +z towards +x, by an angle in degrees.
    #[pyo3(signature = (degrees))]
    fn rotate_y(&self, degrees: f64) -> PyResult<Self> {
        Ok(self.apply(Affine::rotation(Vec3::Y, finite(degrees, "degrees")?)))
    }

    /// The solid turned about the z axis, +x towards +y, by an angle in degrees.
    #[pyo3(signature = (degrees))]
    fn rotate_z(&self, degrees: f64) -> PyResult<Self> {
        Ok(self.apply(Affine::rotation(Vec3::Z, finite(degrees, "degrees")?)))
    }

    /// The solid scaled about the origin by a number, or by one number per axis, as an array (3,) or as x, y and z; negative
    /// numbers mirror it.
    #[pyo3(signature = (s: "float | ArrayLike", y = None, z = None))]
    fn scale(&self, s: &Bound<'_, PyAny>, y: Option<f64>, z: Option<f64>) -> PyResult<Self> {
        let factors = match (components(s, y, z, "scale")?, s.extract::<f64>()) {
            (Some(factors), _) => factors,
            (None, Ok(factor)) => Vec3::splat(finite(factor, "s")?),
            (None, Err(_)) => vector(s, "s")?,
        };
        Ok(self.apply(invertible(Affine::scale(factors), "s")?))
    }

    /// The solid mirrored in the plane through the origin with this normal, which need not be of unit length.
    #[pyo3(signature = (normal: "ArrayLike"))]
    fn mirror(&self, normal: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(self.apply(Affine::mirror(direction(normal, "normal")?)))
    }

    /// The image under an affine map: a 4 x 4 matrix world_from_local that acts on columns, with the last row 0, 0, 0, 1.
    #[pyo3(name = "transform", signature = (matrix: "ArrayLike"))]
    fn transformed(&self, #[pyo3(from_py_with = matrix_argument)] matrix: Affine) -> Self {
        self.apply(matrix)
    }

    /// The same solid with a name, which becomes part of the names of its faces.
    #[pyo3(signature = (name))]
    fn named(&self, name: &str) -> PyResult<Self> {
        if name.is_empty() {
            return Err(bad_value("name is empty: it becomes part of the names of faces."));
        }
        Ok(Self::from_solid(self.solid.named(name)))
    }

    fn __or__(&self, other: PyRef<'_, Self>) -> Self {
        Self::from_solid(&self.solid | &other.solid)
    }

    fn __and__(&self, other: PyRef<'_, Self>) -> Self {
        Self::from_solid(&self.solid & &other.solid)
    }

    fn __sub__(&self, other: PyRef<'_, Self>) -> Self {
        Self::from_solid(&self.solid - &other.solid)
    }

    fn __xor__(&self, other: PyRef<'_, Self>) -> Self {
        Self::from_solid(&self.solid ^ &other.solid)
    }

    /// Attributes that do not exist, with what other programs call them.
    fn __getattr__(&self, name: &str) -> PyResult<Self> {
        Err(no_attribute("Solid", name, &WORDS))
    }

    /// No truth value: `a and b` would be `b`.
    fn __bool__(&self) -> PyResult<bool> {
        Err(no_truth_value())
    }

    /// No sum: the union is `a | b`.
    #[cfg_attr(false, stub("(_other: Any) -> NoReturn"))]
    fn __add__(&self, _other: &Bound<'_, PyAny>) -> PyResult<Self> {
        Err(no_sum())
    }

    fn __invert__(&self) -> Self {
        Self::from_solid(!&self.solid)
    }

    /// Times at which rays enter and leave the solid: a float64 array (H, N), or a pair of it and the surfaces.
    ///
    /// Column = ray, row = k-th entry, each column in order and padded with +inf; H is the smallest even number, at
    /// least 2, that is sufficient for all columns. The column of a ray that is inside just after t_min begins with
    /// -inf; a ray that is inside just before t_max has no entry for that end. With `return_surfaces`, an int32 array
    /// (H, N) has the face of each entry (`surface_names` of `crossings` has their names), or -1.
    ///
    /// `out` is a float64 array of an even number of rows, enough for all columns, or with `return_surfaces` a pair of it and an
    /// int32 array of the same shape. The hits are written to it, and it is returned instead of a new array. It is
    /// fastest if its rows are contiguous. After an error its contents are undefined.
    #[pyo3(signature = (
        origins: "ArrayLike", directions: "ArrayLike", t_min = f64::NEG_INFINITY, t_max = f64::INFINITY, *,
        return_surfaces = false, out = None, evaluator = None, threads: "int | None" = None,
        device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ), text_signature = "($self, origins, directions, t_min=-1e999, t_max=1e999, *, return_surfaces=False, out=None, evaluator=None, threads=None, device='cpu')")]
    #[cfg_attr(
        false,
        stub(
            "(return_surfaces: Literal[False] = False, out: NDArray[np.float64] | None = None) -> NDArray[np.float64]"
        )
    )]
    #[cfg_attr(
        false,
        stub(
            "(return_surfaces: Literal[True],
          out: NDArray[np.float64] | tuple[NDArray[np.float64], NDArray[np.int32]] | None = None)
          -> tuple[NDArray[np.float64], NDArray[np.int32]]"
        )
    )]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn hits<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = time_argument)] t_min: f64,
        #[pyo3(from_py_with = time_argument)] t_max: f64,
        return_surfaces: bool,
        out: Option<&Bound<'py, PyAny>>,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = QueryOptions::new(t_min, t_max, evaluator, threads, device)?;
        hits::hits(self.engine(origins.py())?, [origins, directions], &options, return_surfaces, out)
    }

    /// All crossings of the surface, sorted by ray, then t: see `Crossings`.
    #[pyo3(signature = (
        origins: "ArrayLike", directions: "ArrayLike", t_min = f64::NEG_INFINITY, t_max = f64::INFINITY, *,
        evaluator = None, threads: "int | None" = None,
        device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ) -> "Crossings", text_signature = "($self, origins, directions, t_min=-1e999, t_max=1e999, *, evaluator=None, threads=None, device='cpu')")]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn crossings<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = time_argument)] t_min: f64,
        #[pyo3(from_py_with = time_argument)] t_max: f64,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (engine, options) =
            (self.engine(origins.py())?, QueryOptions::new(t_min, t_max, evaluator, threads, device)?);
        crossings::crossings(engine, [origins, directions], &options)
    }

    /// All crossings of the surface along one curve, or along each in a list of curves, strictly between two times: see
    /// `Crossings`, where `ray` is the number of the curve and `t` its own time. The times are finite numbers, or (N,)
    /// arrays with one for each curve. Curves are described in `rayweave.space`: `Helix` and others, or any object with
    /// `position(t)`, `velocity(t)` and `acceleration_bound(t0, t1)`.
    #[pyo3(signature = (
        curves: "Trajectory | Iterable[Trajectory]", t_min: "float | ArrayLike", t_max: "float | ArrayLike",
        *, threads: "int | None" = None
    ) -> "Crossings")]
    fn crossings_along<'py>(
        &self,
        curves: &Bound<'py, PyAny>,
        t_min: &Bound<'py, PyAny>,
        t_max: &Bound<'py, PyAny>,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        along::crossings_along(self.engine(curves.py())?, curves, [t_min, t_max], threads)
    }

    /// The first crossing of each ray after t_min: see `Crossings`. A ray that crosses nothing has t = inf, surface = -1, and NaN
    /// for point and normal.
    #[pyo3(signature = (
        origins: "ArrayLike", directions: "ArrayLike", t_min = 0.0, t_max = f64::INFINITY, *,
        evaluator = None, threads: "int | None" = None,
        device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ) -> "Crossings", text_signature = "($self, origins, directions, t_min=0.0, t_max=1e999, *, evaluator=None, threads=None, device='cpu')")]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn nearest<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = time_argument)] t_min: f64,
        #[pyo3(from_py_with = time_argument)] t_max: f64,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = QueryOptions::new(t_min, t_max, evaluator, threads, device)?;
        nearest::nearest(self.engine(origins.py())?, [origins, directions], &options)
    }

    /// Paths of names and copy numbers, such as "tower[3]/brick[12]/hole", of `occurrences` as in
    /// `Crossings.occurrence`: a list of (M,) texts, "" for -1. With `placed`, each path ends at the innermost placed
    /// solid: "tower[3]/brick[12]". Copies have the numbers of the file, or are counted from 0 in the order of `place`;
    /// of equal names in one place, the second one ends in "#2".
    #[pyo3(signature = (
        occurrences: "NDArray[np.integer[Any]] | Sequence[int]", *, placed = false
    ) -> "list[str]")]
    fn occurrence_paths<'py>(
        &self,
        occurrences: &Bound<'py, PyAny>,
        placed: bool,
    ) -> PyResult<Bound<'py, PyList>> {
        occurrences::paths(&self.engine(occurrences.py())?.program, occurrences, placed)
    }

    /// Explains the crossings of one ray: every decision of the single-hit evaluator, with its reason. Print the result to read
    /// it as text, or use its `questions`: see `Explanation`. `origin` and `direction` are three numbers each.
    #[pyo3(signature = (
        origin: "ArrayLike", direction: "ArrayLike", t_min = f64::NEG_INFINITY, t_max = f64::INFINITY
    ), text_signature = "($self, origin, direction, t_min=-1e999, t_max=1e999)")]
    fn explain(
        slf: &Bound<'_, Self>,
        origin: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = time_argument)] t_min: f64,
        #[pyo3(from_py_with = time_argument)] t_max: f64,
    ) -> PyResult<PyExplanation> {
        explain(&slf.get().engine(origin.py())?.program, slf.as_any(), [origin, direction], [t_min, t_max])
    }

    /// Whether points (N, 3) or (3,) are inside: bool (N,), or (...) for a grid (..., 3). A point on the surface has the side of
    /// a ray that lies in the surface.
    #[pyo3(signature = (
        points: "ArrayLike", *, evaluator = None, threads: "int | None" = None, device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ) -> "NDArray[np.bool_]")]
    fn contains<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = QueryOptions::of_points(evaluator, threads, device)?;
        points::contains(self.engine(points.py())?, points, &options)
    }

    /// Signed distances of points (N, 3), (3,) or of a grid (..., 3) from the surface, and the nearest points on it, with bounds: see
    /// `Distances`. Distances are negative inside. One whose bounds differ by at most `precision` times the distance (or by
    /// rounding) counts as exact. `progress=True` shows the progress on standard error; a function is called with the numbers of
    /// finished and of all points.
    ///
    /// >>> import rayweave as rw
    /// >>> found = (rw.box(2) - rw.sphere(0.5)).distance([[3, 2, 0], [0, 0, 0.8]])
    /// >>> found.distance.round(9).tolist(), found.is_exact.tolist()
    /// ([2.236067977, -0.2], [True, True])
    /// >>> found.nearest.round(9).tolist()
    /// [[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    #[pyo3(signature = (
        points: "ArrayLike", *, precision = 1e-9, threads: "int | None" = None, progress: "Progress" = None
    ) -> "Distances")]
    fn distance<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        precision: f64,
        threads: Option<&Bound<'py, PyAny>>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        distance::distance(self.engine(points.py())?, points, None, precision, (threads, progress))
    }

    /// A box around the solid: float64 (2, 3), the smallest and the largest coordinates. The box
    /// of the empty solid is (+inf, -inf). The box is conservative and may be larger than the
    /// solid.
    ///
    /// >>> import rayweave as rw
    /// >>> rw.sphere(2).bounds
    /// array([[-2., -2., -2.],
    ///        [ 2.,  2.,  2.]])
    #[getter]
    #[cfg_attr(false, stub("() -> NDArray[np.float64]"))]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(bounds_array(py, &self.engine(py)?.program.bounds()))
    }

    /// Equal if built in the same way from equal parts (not: if they fill the same space).
    fn __eq__(&self, other: PyRef<'_, Self>) -> bool {
        self.solid == other.solid
    }

    fn __hash__(&self) -> u64 {
        pickle::hash(&self.solid)
    }

    /// The name that `named` gave it, or None.
    #[getter]
    pub fn name(&self) -> Option<&str> {
        match self.solid.node() {
            Node::Named(name, _) => Some(name),
            _ => None,
        }
    }

    /// The volume: exact for a single shape whose volume has a closed form and for a mesh whose surface does not intersect itself,
    /// otherwise (`biconic`, `freeform`, `convex`, `quadric`, some aspheres, all expressions) measured by rays within 0.1 % at a
    /// confidence of 99 %. `rayweave.measure` returns the interval.
    ///
    /// >>> import rayweave as rw
    /// >>> rw.box([1, 2, 3]).volume
    /// 6.0
    #[getter]
    fn volume(slf: &Bound<'_, Self>) -> PyResult<f64> {
        measured(slf.as_any(), "volume")?.extract()
    }

    /// The surface area, measured by rays at a confidence of 99 %. `rayweave.measure` returns the interval.
    #[getter]
    fn area(slf: &Bound<'_, Self>) -> PyResult<f64> {
        measured(slf.as_any(), "area")?.extract()
    }

    /// (3,) the centre of volume, measured by rays. `rayweave.measure` returns the intervals.
    #[getter]
    #[cfg_attr(false, stub("() -> NDArray[np.float64]"))]
    fn centroid<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        measured(slf.as_any(), "centre")
    }

    /// The surface as triangles within `tolerance` of it: see `rayweave.Mesh`. The default is 1/5000 of the diagonal.
    #[pyo3(signature = (tolerance = None) -> "Mesh")]
    fn to_mesh<'py>(slf: &Bound<'py, Self>, tolerance: Option<f64>) -> PyResult<Bound<'py, PyAny>> {
        to_mesh(slf.as_any(), tolerance)
    }

    /// Writes the solid to a file, complete or not at all, in the format of its ending: a model file (.toml), a mesh (.stl, .obj,
    /// .ply, .off, .3mf, .gltf, .glb), OpenSCAD (.csg) or GDML (.gdml). `name` replaces the name of the solid. The other arguments
    /// and the result are those of `Model.save`.
    #[pyo3(signature = (path, name = None, *, format = None, tolerance = None, text = false, allow_unsound = false))]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        name: Option<&str>,
        format: Option<&str>,
        tolerance: Option<f64>,
        text: bool,
        allow_unsound: bool,
    ) -> PyResult<Vec<String>> {
        let name = name.or(self.name()).unwrap_or("solid");
        let document = Document::from_solid(name, &self.solid);
        let mut scene = scene_of(&self.solid);
        scene.regions.iter_mut().for_each(|region| region.name = name.to_owned());
        save_scene(
            py,
            &scene,
            Some(&document),
            &path,
            format,
            WriteOptions { tolerance, text, allow_unsound },
        )
    }

    /// A picture of the solid as an array: see `rayweave.render`, whose options these are.
    #[pyo3(signature = (**options: "Any") -> "NDArray[Any]")]
    fn render<'py>(
        slf: &Bound<'py, Self>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        render_method(slf.as_any(), options)
    }

    /// The picture that a notebook shows.
    fn _repr_png_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyBytes>> {
        let (py, solid) = (slf.py(), slf.get());
        notebook_png(py, &Subject::of_solid(solid.solid(), solid.engine(py)?))
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    #[pyo3(signature = (_memo: "dict[int, Any]"))]
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyDict>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        python_text(&self.solid)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let decode = py.import("rayweave._core")?.getattr("solid_from_bytes")?;
        Ok((decode, (PyBytes::new(py, &py.detach(|| pickle::encode(&self.solid))),)))
    }
}

/// A measured value of the only region of a solid.
fn measured<'py>(solid: &Bound<'py, PyAny>, value: &str) -> PyResult<Bound<'py, PyAny>> {
    solid.py().import("rayweave._measure")?.getattr("value_of")?.call1((solid, value))
}

fn matrix_argument(object: &Bound<'_, PyAny>) -> PyResult<Affine> {
    matrix(object, "matrix")
}

/// The box as rows of the smallest and the largest coordinates.
pub fn bounds_array<'py>(py: Python<'py>, bounds: &Bounds) -> Bound<'py, PyArray2<f64>> {
    let bounds = if bounds.is_empty() { Bounds::EMPTY } else { *bounds };
    PyArray2::from_owned_array(py, arr2(&[bounds.lo.to_array(), bounds.hi.to_array()]))
}

/// A solid from its pickled bytes.
#[pyfunction]
#[pyo3(signature = (data))]
pub fn solid_from_bytes(data: &[u8]) -> PyResult<PySolid> {
    pickle::decode(data).map(PySolid::from_solid).map_err(bad_value)
}

/// The empty solid: the neutral element of union.
///
/// >>> import rayweave as rw
/// >>> rw.empty().contains([0, 0, 0])
/// array([False])
#[pyfunction]
pub fn empty() -> PySolid {
    PySolid::from_solid(Solid::empty())
}

/// All of space: the neutral element of intersection.
///
/// >>> import rayweave as rw
/// >>> (rw.universe() - rw.sphere(1)).contains([[0, 0, 0], [2, 0, 0]])
/// array([False,  True])
#[pyfunction]
pub fn universe() -> PySolid {
    PySolid::from_solid(Solid::universe())
}

/// The union of solids, given one by one or as one iterable; `empty()` if there are none.
///
/// >>> import rayweave as rw
/// >>> rw.union(rw.sphere(1), rw.box(1)) == rw.union([rw.sphere(1), rw.box(1)])
/// True
#[pyfunction]
#[pyo3(signature = (*solids: "Solid | Iterable[Solid]"))]
pub fn union(solids: &Bound<'_, PyTuple>) -> PyResult<PySolid> {
    Ok(PySolid::from_solid(Solid::union(operands(solids)?)))
}

/// The intersection of solids, given one by one or as one iterable; `universe()` if there are none.
///
/// >>> import rayweave as rw
/// >>> rw.intersection(rw.box(2), rw.sphere(1.2)).contains([0.9, 0, 0])
/// array([ True])
#[pyfunction]
#[pyo3(signature = (*solids: "Solid | Iterable[Solid]"))]
pub fn intersection(solids: &Bound<'_, PyTuple>) -> PyResult<PySolid> {
    Ok(PySolid::from_solid(Solid::intersection(operands(solids)?)))
}

/// The union of the images of a solid under many maps: translations (N, 3) or matrices world_from_local (N, 4, 4). The
/// solid is compiled once, regardless of the number of maps.
///
/// >>> import rayweave as rw
/// >>> row = rw.place(rw.sphere(1), [[0, 0, 0], [3, 0, 0], [6, 0, 0]])
/// >>> row.hits([-2, 0, 0], [1, 0, 0]).ravel()
/// array([1., 3., 4., 6., 7., 9.])
#[pyfunction]
#[pyo3(signature = (solid, transforms: "ArrayLike"))]
pub fn place(solid: PyRef<'_, PySolid>, transforms: &Bound<'_, PyAny>) -> PyResult<PySolid> {
    let maps = maps(transforms, "transforms")?;
    Ok(PySolid::from_solid(solid.solid.place(maps)))
}

fn operands(arguments: &Bound<'_, PyTuple>) -> PyResult<Vec<Solid>> {
    let solids = match arguments.len() {
        1 if !arguments.get_item(0)?.is_instance_of::<PySolid>() => arguments.get_item(0)?,
        _ => arguments.clone().into_any(),
    };
    let wrong = || bad_type(format!("solids is {}: it must be an iterable of solids.", shown(&solids)));
    let solids: PyResult<Bound<'_, PyIterator>> = solids.try_iter().map_err(|_| wrong());
    solids?
        .enumerate()
        .map(|(k, item)| match item?.cast_into::<PySolid>() {
            Ok(solid) => Ok(solid.get().solid.clone()),
            Err(error) => {
                Err(bad_type(format!("solids[{k}] is {}: it must be a Solid.", shown(&error.into_inner()))))
            }
        })
        .collect()
}
