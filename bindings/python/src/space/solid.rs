//! Solids in R^d as a Python class.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyIterator, PyList};
use rayweave::rootray::RootRay;
use rayweave::space::{Face, Point, Program, Solid, SpaceError};

use super::follow::follow;
use super::kinds::make;
use super::recipe::{Recipe, call_named};
use super::table::{PointTable, points};
use super::{AnyCurve, AnySolid, Holds, Shared, each};
use crate::arrays::{double_array, list, room, shape_text};
use crate::engine::{not_whole, thread_argument};
use crate::error::{bad_type, bad_value, no_sum, no_truth_value, shown};
use crate::rootray::PyRootRay;

/// A solid in the plane, in space or in a space of four dimensions: a boolean combination of shapes under affine maps. It never
/// changes.
///
/// Create solids with the functions of `rayweave.space` and combine them with `|` (union), `&` (intersection), `-`
/// (difference), `^` (symmetric difference) and `~` (complement); both sides must be of the same dimension. Maps are
/// about the origin and return a new solid. Axes are counted from 0. Lengths must be 0 or of a magnitude between 1e-60
/// and 1e60.
///
/// >>> import rayweave.space as rs
/// >>> ring = rs.ball(2, d=2) - rs.ball(1, d=2)
/// >>> ring.contains([[1.5, 0], [0, 0]])
/// array([ True, False])
/// >>> ring.rotate(0, 1, 90).dimension
/// 2
#[pyclass(frozen, module = "rayweave.space", name = "Solid")]
pub struct PySpaceSolid {
    any: AnySolid,
    recipe: Arc<Recipe>,
}

impl PySpaceSolid {
    /// Result of an operation on solids of one dimension.
    pub fn make(
        call: &'static str,
        dimension: usize,
        numbers: Vec<f64>,
        name: Option<&str>,
        operands: &[&PySpaceSolid],
    ) -> PyResult<Self> {
        // adding zero turns -0 into 0, which is equal to it
        let numbers: Vec<f64> = numbers.into_iter().map(|x| x + 0.0).collect();
        let parts: Vec<&AnySolid> = operands.iter().map(|solid| &solid.any).collect();
        let any = make(call, dimension, &numbers, name, &parts)?;
        let operands = operands.iter().map(|solid| solid.recipe.clone()).collect();
        let recipe = Arc::new(Recipe { call, dimension, numbers, name: name.map(Into::into), operands });
        Ok(PySpaceSolid { any, recipe })
    }

    fn image(&self, call: &'static str, numbers: Vec<f64>) -> PyResult<Self> {
        Self::make(call, self.any.dimension(), numbers, None, &[self])
    }

    fn join(&self, call: &'static str, other: &Self) -> PyResult<Self> {
        let (a, b) = (self.any.dimension(), other.any.dimension());
        if a != b {
            return Err(bad_value(format!(
                "one solid is of dimension {a} and the other of dimension {b}: an operator needs equal dimensions. Use extrude."
            )));
        }
        Self::make(call, a, Vec::new(), None, &[self, other])
    }

    /// The numbers of a point or a vector of this space.
    fn vector(&self, object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
        let numbers = list(object, name)?;
        let dimension = self.any.dimension();
        match numbers.len() == dimension {
            true => Ok(numbers),
            false => Err(bad_value(format!(
                "{name} has {} numbers: it must have {dimension}, as many as the space has dimensions.",
                numbers.len()
            ))),
        }
    }
}

#[pymethods]
impl PySpaceSolid {
    /// The dimension of the space: 2, 3 or 4.
    #[getter]
    fn dimension(&self) -> usize {
        self.any.dimension()
    }

    /// The solid moved by a vector (d,).
    #[pyo3(signature = (v: "ArrayLike"))]
    fn translate(&self, v: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.image("translate", self.vector(v, "v")?)
    }

    /// The solid scaled about the origin by a number, or by one number per axis (d,); negative numbers mirror, 0 is an error.
    #[pyo3(signature = (s: "float | ArrayLike"))]
    fn scale(&self, s: &Bound<'_, PyAny>) -> PyResult<Self> {
        let factors = match s.extract::<f64>() {
            Ok(factor) => vec![factor; self.any.dimension()],
            Err(_) => self.vector(s, "s")?,
        };
        self.image("scale", factors)
    }

    /// The solid turned about the origin in a coordinate plane, from one axis towards another, by an angle in degrees. (In space,
    /// from axis 0 to axis 1 is the rotation about z.) Quarter turns are exact.
    #[pyo3(signature = (from_axis: "int", to_axis: "int", degrees))]
    fn rotate(
        &self,
        from_axis: &Bound<'_, PyAny>,
        to_axis: &Bound<'_, PyAny>,
        degrees: f64,
    ) -> PyResult<Self> {
        let axes = [count(from_axis, "from_axis")?, count(to_axis, "to_axis")?];
        self.image("rotate", vec![axes[0], axes[1], degrees])
    }

    /// The image under an invertible affine map, p -> matrix p + offset: matrix (d, d), acting on columns, offset (d,).
    #[pyo3(signature = (matrix: "ArrayLike", offset: "ArrayLike | None" = None))]
    fn affine(&self, matrix: &Bound<'_, PyAny>, offset: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let (d, matrix) = (self.any.dimension(), double_array(matrix, "matrix")?);
        if matrix.shape() != [d, d] {
            let shape = shape_text(matrix.shape());
            return Err(bad_value(format!("matrix has shape {shape}: it must be ({d}, {d}).")));
        }
        let matrix = matrix.try_readonly().map_err(bad_value)?;
        let mut numbers: Vec<f64> = matrix.as_array().iter().copied().collect();
        match offset {
            Some(offset) => numbers.extend(self.vector(offset, "offset")?),
            None => numbers.extend(vec![0.0; d]),
        }
        self.image("affine", numbers)
    }

    /// The same solid in a space of higher dimension, unbounded along the new axes.
    #[pyo3(signature = (d: "int"))]
    fn extrude(&self, d: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::make("extrude", count(d, "d")? as usize, Vec::new(), None, &[self])
    }

    /// The same solid with a name, which becomes part of the names of its faces.
    #[pyo3(signature = (name))]
    fn named(&self, name: &str) -> PyResult<Self> {
        if name.is_empty() {
            return Err(bad_value("name is empty: it becomes part of the names of faces."));
        }
        Self::make("named", self.any.dimension(), Vec::new(), Some(name), &[self])
    }

    fn __or__(&self, other: PyRef<'_, Self>) -> PyResult<Self> {
        self.join("union", &other)
    }

    fn __and__(&self, other: PyRef<'_, Self>) -> PyResult<Self> {
        self.join("intersection", &other)
    }

    fn __sub__(&self, other: PyRef<'_, Self>) -> PyResult<Self> {
        self.join("difference", &other)
    }

    fn __xor__(&self, other: PyRef<'_, Self>) -> PyResult<Self> {
        self.join("symmetric_difference", &other)
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

    fn __invert__(&self) -> PyResult<Self> {
        Self::make("complement", self.any.dimension(), Vec::new(), None, &[self])
    }

    /// All crossings of the lines through pairs of points, t = 0 at p and t = 1 at q, over all t: see `PointCrossings`. `p` and `q`
    /// are of shape (N, d) or (d,), broadcast against each other; the two points of a pair must differ.
    #[pyo3(signature = (p: "ArrayLike", q: "ArrayLike", *, threads: "int | None" = None) -> "PointCrossings")]
    fn crossings<'py>(
        &self,
        p: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let threads = threads.map(thread_argument).transpose()?;
        each!(AnySolid, &self.any, solid => PointTable::of_lines(solid, [p, q], threads))
    }

    /// All crossings of one curve, or of each in a list of curves, strictly between two times: see `PointCrossings`. The times
    /// are finite numbers, or (N,) arrays with one for each curve. Curves are described in `rayweave.space`.
    #[pyo3(signature = (
        curves: "Trajectory | Iterable[Trajectory]", t_min: "float | ArrayLike", t_max: "float | ArrayLike",
        *, threads: "int | None" = None
    ) -> "PointCrossings")]
    fn crossings_along<'py>(
        &self,
        curves: &Bound<'py, PyAny>,
        t_min: &Bound<'py, PyAny>,
        t_max: &Bound<'py, PyAny>,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let threads = threads.map(thread_argument).transpose()?;
        each!(AnySolid, &self.any, solid => PointTable::of_curves(solid, curves, [t_min, t_max], threads))
    }

    /// Whether points (N, d) or (d,) are inside: bool (N,). A point on the surface has the side of
    /// a ray that lies in the surface.
    #[pyo3(signature = (points: "ArrayLike"))]
    fn contains<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        each!(AnySolid, &self.any, solid => contains(solid, points))
    }

    /// Equal if built in the same way from equal parts (not: if they fill the same space).
    fn __eq__(&self, other: PyRef<'_, Self>) -> bool {
        Arc::ptr_eq(&self.recipe, &other.recipe) || self.recipe.steps() == other.recipe.steps()
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.recipe.steps().hash(&mut hasher);
        hasher.finish()
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    #[pyo3(signature = (_memo: "dict[int, Any]"))]
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyDict>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        format!("<Solid of dimension {}: {}>", self.any.dimension(), self.recipe.text())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyList>,))> {
        let steps: PyResult<Vec<_>> = (self.recipe.steps().into_iter())
            .map(|step| {
                let numbers: Vec<f64> = step.numbers.into_iter().map(f64::from_bits).collect();
                (step.call, step.dimension, numbers, step.name.as_deref(), step.operands).into_pyobject(py)
            })
            .collect();
        let decode = py.import("rayweave._core")?.getattr("space_solid_from_steps")?;
        Ok((decode, (PyList::new(py, steps?)?,)))
    }
}

/// One step of a pickle: call, dimension, numbers, name, operands.
type Pickled = (String, usize, Vec<f64>, Option<String>, Vec<usize>);

/// A solid of R^d from its pickled steps.
#[pyfunction]
#[pyo3(signature = (steps))]
pub fn space_solid_from_steps(steps: Vec<Pickled>) -> PyResult<PySpaceSolid> {
    let damaged =
        || bad_value("the pickled bytes are not a solid: they are damaged or come from a different version.");
    let mut made: Vec<PySpaceSolid> = Vec::with_capacity(steps.len());
    for (call, dimension, numbers, name, operands) in steps {
        let call = call_named(&call).ok_or_else(damaged)?;
        let operands: Option<Vec<&PySpaceSolid>> = operands.into_iter().map(|k| made.get(k)).collect();
        let solid =
            PySpaceSolid::make(call, dimension, numbers, name.as_deref(), &operands.ok_or_else(damaged)?)?;
        made.push(solid);
    }
    made.pop().ok_or_else(damaged)
}

/// A solid of R^d without operands. The functions of `rayweave.space` define the meaning of the
/// numbers.
#[pyfunction]
#[pyo3(signature = (call, d: "int", counts: "list[tuple[str, int]]", numbers))]
pub fn space_shape(
    call: &str,
    d: &Bound<'_, PyAny>,
    counts: Vec<(String, Bound<'_, PyAny>)>,
    numbers: Vec<f64>,
) -> PyResult<PySpaceSolid> {
    let call = call_named(call).ok_or_else(|| bad_value(format!("there is no shape {call}")))?;
    let mut all = Vec::with_capacity(counts.len() + numbers.len());
    for (name, value) in counts {
        all.push(count(&value, &name)?);
    }
    all.extend(numbers);
    PySpaceSolid::make(call, count(d, "d")? as usize, all, None, &[])
}

/// The union or the intersection of the solids. There must be at least one, because it determines
/// the dimension.
#[pyfunction]
#[pyo3(signature = (call, solids: "Iterable[SpaceSolid]"))]
pub fn space_join(call: &str, solids: &Bound<'_, PyAny>) -> PyResult<PySpaceSolid> {
    let call = call_named(call).ok_or_else(|| bad_value(format!("there is no operator {call}")))?;
    let wrong = || bad_type(format!("solids is {}: it must be an iterable of solids.", shown(solids)));
    let all: PyResult<Bound<'_, PyIterator>> = solids.try_iter().map_err(|_| wrong());
    let mut operands = Vec::new();
    for (k, item) in all?.enumerate() {
        let solid = item?.cast_into::<PySpaceSolid>().map_err(|error| {
            let found = shown(&error.into_inner());
            bad_type(format!("solids[{k}] is {found}: it must be a Solid of rayweave.space."))
        })?;
        operands.push(solid);
    }
    let operands: Vec<&PySpaceSolid> = operands.iter().map(|solid| solid.get()).collect();
    let Some(first) = operands.first() else {
        return Err(bad_value(
            "solids is empty, so that the dimension is unknown. Use empty(d) or universe(d).",
        ));
    };
    let d = first.any.dimension();
    if let Some(k) = operands.iter().position(|solid| solid.any.dimension() != d) {
        let other = operands[k].any.dimension();
        return Err(bad_value(format!(
            "solids[0] is of dimension {d} and solids[{k}] of dimension {other}: they must have the same dimension."
        )));
    }
    PySpaceSolid::make(call, d, Vec::new(), None, &operands)
}

/// The root-ray of the line through p and q: see `rayweave.space.trace`.
#[pyfunction]
#[pyo3(signature = (p: "ArrayLike", q: "ArrayLike", solid))]
pub fn space_trace(
    p: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    solid: PyRef<'_, PySpaceSolid>,
) -> PyResult<PyRootRay> {
    let ends = [solid.vector(p, "p")?, solid.vector(q, "q")?];
    let ends = ends.each_ref().map(Vec::as_slice);
    each!(AnySolid, &solid.any, inner => line_through(inner, ends)).map_err(bad_value)
}

fn line_through<const D: usize>(solid: &Solid<D>, [p, q]: [&[f64]; 2]) -> Result<PyRootRay, SpaceError> {
    let point = |numbers: &[f64]| -> Point<D> { std::array::from_fn(|k| numbers[k]) };
    rayweave::space::trace(point(p), point(q), solid).map(plain)
}

/// The root-ray of a curve: see `rayweave.space.trace_along`.
#[pyfunction]
#[pyo3(signature = (curve: "Trajectory", solid, t_min: "float", t_max: "float"))]
pub fn space_trace_along(
    curve: &Bound<'_, PyAny>,
    solid: PyRef<'_, PySpaceSolid>,
    t_min: &Bound<'_, PyAny>,
    t_max: &Bound<'_, PyAny>,
) -> PyResult<PyRootRay> {
    each!(AnySolid, &solid.any, inner => along(inner, curve, [t_min, t_max]))
}

fn along<const D: usize>(
    solid: &Solid<D>,
    curve: &Bound<'_, PyAny>,
    window: [&Bound<'_, PyAny>; 2],
) -> PyResult<PyRootRay>
where
    AnyCurve: Holds<Shared<D>>,
{
    let mut answer = None;
    follow(
        curve,
        window,
        None,
        || rayweave::space::Tracer::new(solid),
        |tracer, curve, t0, t1| {
            let tracer = tracer.as_mut().map_err(|error| error.clone())?;
            tracer.trace_curve(&curve, t0, t1).map(plain)
        },
        |ray| match answer.replace(ray) {
            None => Ok(()),
            Some(_) => Err(bad_type("curve is a list: pass one curve, or call crossings_along.")),
        },
    )?;
    answer.ok_or_else(|| bad_type("curve is an empty list: pass one curve."))
}

/// The root-ray without its surfaces.
fn plain<const D: usize>(ray: RootRay<Face<D>>) -> PyRootRay {
    PyRootRay::from_root_ray(ray.map_surfaces(|_| ()))
}

fn contains<'py, const D: usize>(
    solid: &Solid<D>,
    object: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let py = object.py();
    let points = points::<D>(object, "points")?;
    let answers = py.detach(|| -> PyResult<Vec<bool>> {
        let program: Arc<Program<D>> = solid.compile().map_err(bad_value)?;
        let mut inside = room(points.rows.len())?;
        for (k, point) in points.rows.iter().enumerate() {
            let answer = program.contains(*point);
            inside.push(answer.map_err(|error| bad_value(format!("{}: {error}", points.place(k))))?);
        }
        Ok(inside)
    })?;
    Ok(PyArray1::from_vec(py, answers))
}

/// A non-negative integer, stored as f64 like all numbers of a recipe.
fn count(object: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    let wrong = || not_whole(object, name);
    if object.is_instance_of::<pyo3::types::PyBool>() {
        return Err(wrong());
    }
    let number: i64 = object.extract().map_err(|_| wrong())?;
    match (0..1 << 50).contains(&number) {
        true => Ok(number as f64),
        false => Err(bad_value(format!("{name} is {number}: it must be from 0 to 2^50."))),
    }
}
