//! Curves as Python classes: a base class, and a class for each kind.

use std::hash::{DefaultHasher, Hash, Hasher};

use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rayweave::space::Point;
use rayweave::space::curve::{Arc, Curve, CurveError, Helix, Line, Parabola, Spline, SplineEnds};

use super::{AnyCurve, Holds, Shared, each, in_dimension};
use crate::arrays::{double_array, list, shape_text};
use crate::error::bad_value;

/// Radians in a degree.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Constructor arguments of a curve, as given by Python.
#[derive(Clone, PartialEq)]
enum Argument {
    Number(f64),
    List(Vec<f64>),
    Rows(Vec<Vec<f64>>),
    Word(String),
    Nothing,
}

/// A trajectory r(t) in R^d: the base class of `Line`, `Parabola`, `Arc`, `Helix` and `Spline`.
/// Immutable.
///
/// >>> import rayweave.space as rs
/// >>> isinstance(rs.Line([0, 0], [1, 0]), rs.Curve)
/// True
#[pyclass(frozen, subclass, module = "rayweave.space", name = "Curve")]
pub struct PyCurve {
    any: AnyCurve,
    class: &'static str,
    /// The class method that created it; `None` for the constructor.
    maker: Option<&'static str>,
    arguments: Vec<(&'static str, Argument)>,
}

impl PyCurve {
    /// The curve.
    pub fn any(&self) -> &AnyCurve {
        &self.any
    }

    fn new<const D: usize>(
        curve: impl Curve<D> + Send + Sync + 'static,
        class: &'static str,
        arguments: Vec<(&'static str, Argument)>,
    ) -> Self
    where
        AnyCurve: Holds<Shared<D>>,
    {
        let shared: Shared<D> = std::sync::Arc::new(curve);
        PyCurve { any: AnyCurve::hold(shared), class, maker: None, arguments }
    }

    /// Evaluates at one time, or at each of many: an array (d,) or (N, d).
    fn at<'py>(&self, t: &Bound<'py, PyAny>, velocity: bool) -> PyResult<Bound<'py, PyAny>> {
        let (py, times) = (t.py(), double_array(t, "t")?);
        let one = times.ndim() == 0;
        if times.ndim() > 1 {
            let shape = shape_text(times.shape());
            return Err(bad_value(format!("t has shape {shape}: it must be a number or (N,).")));
        }
        let times: Vec<f64> = times.try_readonly().map_err(bad_value)?.as_array().iter().copied().collect();
        if let Some(k) = times.iter().position(|t| !t.is_finite()) {
            let place = if one { String::new() } else { format!("[{k}]") };
            return Err(bad_value(format!("t{place} is {}: it must be finite.", times[k])));
        }
        let numbers: Vec<f64> = each!(AnyCurve, &self.any, curve => {
            times.iter().flat_map(|&t| if velocity { curve.velocity(t) } else { curve.position(t) }).collect()
        });
        let d = self.any.dimension();
        let array = PyArray1::from_vec(py, numbers);
        Ok(if one { array.into_any() } else { array.reshape([times.len(), d])?.into_any() })
    }
}

#[pymethods]
impl PyCurve {
    /// The dimension of the space: 2, 3 or 4.
    #[getter]
    fn dimension(&self) -> usize {
        self.any.dimension()
    }

    /// The first and the last time at which the curve is defined; infinite if it is unbounded.
    #[getter]
    fn domain(&self) -> (f64, f64) {
        each!(AnyCurve, &self.any, curve => curve.domain())
    }

    /// r(t): (d,), or (N, d) for times (N,).
    #[pyo3(signature = (t: "ArrayLike") -> "NDArray[np.float64]")]
    fn position<'py>(&self, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.at(t, false)
    }

    /// r'(t): (d,), or (N, d) for times (N,).
    #[pyo3(signature = (t: "ArrayLike") -> "NDArray[np.float64]")]
    fn velocity<'py>(&self, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.at(t, true)
    }

    /// An upper bound of the length of r'' between two times, t0 < t1.
    #[pyo3(signature = (t0, t1))]
    fn acceleration_bound(&self, t0: f64, t1: f64) -> PyResult<f64> {
        if t0.is_nan() || t1.is_nan() || t0 >= t1 {
            return Err(bad_value(format!("t0 is {t0} and t1 is {t1}: t0 must be less than t1.")));
        }
        Ok(each!(AnyCurve, &self.any, curve => curve.acceleration_bound(t0, t1)))
    }

    fn __eq__(&self, other: PyRef<'_, PyCurve>) -> bool {
        (self.class, self.maker) == (other.class, other.maker) && self.arguments == other.arguments
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.class, self.maker).hash(&mut hasher);
        self.arguments.iter().for_each(|(_, argument)| argument.hash(&mut hasher));
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        let arguments = self.arguments.iter().filter(|(_, argument)| *argument != Argument::Nothing);
        let texts: Vec<String> = arguments.map(|(name, argument)| format!("{name}={argument}")).collect();
        let maker = self.maker.map(|maker| format!(".{maker}")).unwrap_or_default();
        format!("{}{maker}({})", self.class, texts.join(", "))
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    #[pyo3(signature = (_memo: "dict[int, Any]"))]
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyDict>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let module = py.import("rayweave.space")?;
        let arguments: PyResult<Vec<_>> =
            self.arguments.iter().map(|(_, argument)| argument.to_python(py)).collect();
        let parts = (self.class, self.maker, PyTuple::new(py, arguments?)?).into_pyobject(py)?;
        Ok((module.getattr("_restore")?, parts))
    }
}

impl Argument {
    fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(match self {
            Argument::Number(number) => number.into_pyobject(py)?.into_any(),
            Argument::List(numbers) => numbers.into_pyobject(py)?,
            Argument::Rows(rows) => rows.into_pyobject(py)?,
            Argument::Word(word) => word.into_pyobject(py)?.into_any(),
            Argument::Nothing => py.None().into_bound(py),
        })
    }

    fn hash(&self, hasher: &mut DefaultHasher) {
        // adding zero makes the two zeros, which are equal, hash alike
        let mut number = |x: f64| (x + 0.0).to_bits().hash(hasher);
        match self {
            Argument::Number(x) => number(*x),
            Argument::List(list) => list.iter().copied().for_each(number),
            Argument::Rows(rows) => rows.iter().flatten().copied().for_each(number),
            Argument::Word(word) => word.hash(hasher),
            Argument::Nothing => {}
        }
    }
}

impl std::fmt::Display for Argument {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const SHOWN: usize = 6;
        match self {
            Argument::Number(number) => write!(f, "{number:?}"),
            Argument::List(list) if list.len() <= SHOWN => write!(f, "{list:?}"),
            Argument::List(list) => write!(f, "[{:?}, ... {} more]", list[0], list.len() - 1),
            Argument::Rows(rows) if rows.len() <= SHOWN => write!(f, "{rows:?}"),
            Argument::Rows(rows) => write!(f, "[{:?}, ... {} more]", rows[0], rows.len() - 1),
            Argument::Word(word) => write!(f, "'{word}'"),
            Argument::Nothing => f.write_str("None"),
        }
    }
}

/// The straight line origin + t direction.
///
/// Both are of shape (d,), d = 2, 3 or 4. `t` is in units of the direction, which need not be of unit length; a
/// direction of length zero is a point at rest. Raises `RayweaveError` for numbers that are not finite.
///
/// >>> import rayweave.space as rs
/// >>> rs.Line([0, 0], [1, 2]).position([0, 1])
/// array([[0., 0.],
///        [1., 2.]])
#[pyclass(frozen, extends = PyCurve, module = "rayweave.space", name = "Line")]
pub struct PyLine;

#[pymethods]
impl PyLine {
    #[new]
    #[pyo3(signature = (origin: "ArrayLike", direction: "ArrayLike"))]
    fn new(origin: &Bound<'_, PyAny>, direction: &Bound<'_, PyAny>) -> PyResult<PyClassInitializer<PyLine>> {
        let vectors = [finite(origin, "origin")?, finite(direction, "direction")?];
        let curve = in_dimension!(same_length(&["origin", "direction"], &vectors)?, D => {
            let [origin, direction] = fixed::<D, 2>(&vectors);
            Ok(PyCurve::new(Line::new(origin, direction), "Line", named(["origin", "direction"], &vectors)))
        })?;
        Ok(PyClassInitializer::from(curve).add_subclass(PyLine))
    }
}

/// The path of a projectile, position + t velocity + t^2 / 2 acceleration.
///
/// All are of shape (d,), d = 2, 3 or 4: position and velocity at t = 0, and the constant acceleration, in units of
/// length and of t. Raises `RayweaveError` for numbers that are not finite.
///
/// >>> import rayweave.space as rs
/// >>> throw = rs.Parabola([0, 0], [2, 4], [0, -2])
/// >>> throw.position(2)
/// array([4., 4.])
#[pyclass(frozen, extends = PyCurve, module = "rayweave.space", name = "Parabola")]
pub struct PyParabola;

#[pymethods]
impl PyParabola {
    #[new]
    #[pyo3(signature = (position: "ArrayLike", velocity: "ArrayLike", acceleration: "ArrayLike"))]
    fn new(
        position: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        acceleration: &Bound<'_, PyAny>,
    ) -> PyResult<PyClassInitializer<PyParabola>> {
        const NAMES: [&str; 3] = ["position", "velocity", "acceleration"];
        let vectors =
            [finite(position, NAMES[0])?, finite(velocity, NAMES[1])?, finite(acceleration, NAMES[2])?];
        let curve = in_dimension!(same_length(&NAMES, &vectors)?, D => {
            let [position, velocity, acceleration] = fixed::<D, 3>(&vectors);
            let curve = Parabola::new(position, velocity, acceleration);
            Ok(PyCurve::new(curve, "Parabola", named(NAMES, &vectors)))
        })?;
        Ok(PyClassInitializer::from(curve).add_subclass(PyParabola))
    }
}

/// A circle or an ellipse, centre + cos(speed t) axes[0] + sin(speed t) axes[1]: the window of times selects an arc of
/// it.
///
/// `centre` is of shape (d,), d = 2, 3 or 4, `axes` of shape (2, d): two perpendicular axes whose length is the radius
/// give a circle, others an ellipse (its conjugate semi-diameters). `speed` is in degrees per unit of t: with 1, the
/// default, `t` is the angle in degrees. Raises `RayweaveError` for numbers that are not finite.
///
/// >>> import rayweave.space as rs
/// >>> circle = rs.Arc([0, 0], [[2, 0], [0, 2]])
/// >>> circle.position(90).round(6)
/// array([0., 2.])
/// >>> rs.half_space(0, 2).crossings_along(circle, 0, 360).t.round(6)
/// array([ 90., 270.])
#[pyclass(frozen, extends = PyCurve, module = "rayweave.space", name = "Arc")]
pub struct PyArc;

#[pymethods]
impl PyArc {
    #[new]
    #[pyo3(signature = (centre: "ArrayLike", axes: "ArrayLike", speed = 1.0))]
    fn new(
        centre: &Bound<'_, PyAny>,
        axes: &Bound<'_, PyAny>,
        speed: f64,
    ) -> PyResult<PyClassInitializer<PyArc>> {
        let (centre, rows) = (finite(centre, "centre")?, rows(axes, "axes")?);
        let Ok([first, second]) = <[Vec<f64>; 2]>::try_from(rows.clone()) else {
            return Err(bad_value(format!("axes has {} rows: it must have 2.", rows.len())));
        };
        let vectors = [centre, first, second];
        let arguments = vec![
            ("centre", Argument::List(vectors[0].clone())),
            ("axes", Argument::Rows(rows)),
            ("speed", Argument::Number(speed)),
        ];
        let curve = in_dimension!(same_length(&["centre", "axes[0]", "axes[1]"], &vectors)?, D => {
            let [centre, first, second] = fixed::<D, 3>(&vectors);
            let curve = Arc::new(centre, [first, second], speed * DEGREE).map_err(in_degrees)?;
            Ok(PyCurve::new(curve, "Arc", arguments))
        })?;
        Ok(PyClassInitializer::from(curve).add_subclass(PyArc))
    }

    /// The circle in space about `centre` from `start`, right-handed about `normal` (of any length but 0), with `speed`
    /// degrees per unit of t. The part of start - centre along the normal is dropped.
    #[staticmethod]
    #[pyo3(signature = (centre: "ArrayLike", normal: "ArrayLike", start: "ArrayLike", speed = 1.0))]
    fn about(
        py: Python<'_>,
        centre: &Bound<'_, PyAny>,
        normal: &Bound<'_, PyAny>,
        start: &Bound<'_, PyAny>,
        speed: f64,
    ) -> PyResult<Py<PyArc>> {
        const NAMES: [&str; 3] = ["centre", "normal", "start"];
        let vectors = [in_space(centre, NAMES[0])?, in_space(normal, NAMES[1])?, in_space(start, NAMES[2])?];
        let [centre, normal, start] = fixed::<3, 3>(&vectors);
        let curve = Arc::about(centre, normal, start, speed * DEGREE).map_err(in_degrees)?;
        let mut arguments = named(NAMES, &vectors);
        arguments.push(("speed", Argument::Number(speed)));
        let curve = PyCurve { maker: Some("about"), ..PyCurve::new(curve, "Arc", arguments) };
        Py::new(py, PyClassInitializer::from(curve).add_subclass(PyArc))
    }
}

/// The path of a charged particle in a uniform magnetic field: a helix about the field.
///
/// `position` and `velocity`, of shape (3,), are those at t = 0; `axis` is the direction of the field, of any length but 0;
/// `radius` is the gyro radius, the speed across the field divided by the signed gyro frequency. A positive radius
/// turns clockwise as seen against the field, like a positive charge, a negative one counter-clockwise; an infinite
/// radius is a straight line. For a particle of charge q and momentum p across a field B it is p / (q B). Raises
/// `RayweaveError` for numbers that are not finite, an axis of length zero, a radius of 0.
///
/// >>> import rayweave.space as rs
/// >>> path = rs.Helix([0, 0, 0], [1, 0, 1], axis=[0, 0, 1], radius=2)
/// >>> path.position(0).tolist(), path.velocity(0).tolist()
/// ([0.0, 0.0, 0.0], [1.0, 0.0, 1.0])
#[pyclass(frozen, extends = PyCurve, module = "rayweave.space", name = "Helix")]
pub struct PyHelix;

const MOTION: [&str; 3] = ["position", "velocity", "axis"];

#[pymethods]
impl PyHelix {
    #[new]
    #[pyo3(signature = (position: "ArrayLike", velocity: "ArrayLike", axis: "ArrayLike", radius))]
    fn new(
        position: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        axis: &Bound<'_, PyAny>,
        radius: f64,
    ) -> PyResult<PyClassInitializer<PyHelix>> {
        let vectors =
            [in_space(position, MOTION[0])?, in_space(velocity, MOTION[1])?, in_space(axis, MOTION[2])?];
        let [position, velocity, axis] = fixed::<3, 3>(&vectors);
        let curve = Helix::with_radius(position, velocity, axis, radius).map_err(bad_value)?;
        let curve = helix(curve, None, MOTION, &vectors, ("radius", radius));
        Ok(PyClassInitializer::from(curve).add_subclass(PyHelix))
    }

    /// The same helix, defined by the signed gyro frequency in degrees per unit of t.
    #[staticmethod]
    #[pyo3(signature = (position: "ArrayLike", velocity: "ArrayLike", axis: "ArrayLike", frequency))]
    fn with_frequency(
        py: Python<'_>,
        position: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        axis: &Bound<'_, PyAny>,
        frequency: f64,
    ) -> PyResult<Py<PyHelix>> {
        let vectors =
            [in_space(position, MOTION[0])?, in_space(velocity, MOTION[1])?, in_space(axis, MOTION[2])?];
        let [position, velocity, axis] = fixed::<3, 3>(&vectors);
        let curve = Helix::new(position, velocity, axis, frequency * DEGREE).map_err(bad_value)?;
        let curve = helix(curve, Some("with_frequency"), MOTION, &vectors, ("frequency", frequency));
        Py::new(py, PyClassInitializer::from(curve).add_subclass(PyHelix))
    }

    /// The helix from `start` about the line through `centre` along `axis`, right-handed, rising along the axis by
    /// `pitch` in every turn of 360 units of t: `t` is the angle in degrees. A pitch of 0 is a circle; a negative one
    /// makes the helix left-handed.
    #[staticmethod]
    #[pyo3(signature = (centre: "ArrayLike", axis: "ArrayLike", start: "ArrayLike", pitch))]
    fn about(
        py: Python<'_>,
        centre: &Bound<'_, PyAny>,
        axis: &Bound<'_, PyAny>,
        start: &Bound<'_, PyAny>,
        pitch: f64,
    ) -> PyResult<Py<PyHelix>> {
        const NAMES: [&str; 3] = ["centre", "axis", "start"];
        let vectors = [in_space(centre, NAMES[0])?, in_space(axis, NAMES[1])?, in_space(start, NAMES[2])?];
        let [centre, axis, start] = fixed::<3, 3>(&vectors);
        let turning = Helix::about(centre, axis, start, pitch).map_err(bad_value)?;
        // the same path, with t in degrees instead of radians
        let velocity = turning.velocity(0.0).map(|x| DEGREE * x);
        let curve = Helix::new(start, velocity, axis, DEGREE * turning.frequency()).map_err(bad_value)?;
        let curve = helix(curve, Some("about"), NAMES, &vectors, ("pitch", pitch));
        Py::new(py, PyClassInitializer::from(curve).add_subclass(PyHelix))
    }
}

fn helix(
    curve: Helix,
    maker: Option<&'static str>,
    names: [&'static str; 3],
    vectors: &[Vec<f64>; 3],
    (last, number): (&'static str, f64),
) -> PyCurve {
    let mut arguments = named(names, vectors);
    arguments.push((last, Argument::Number(number)));
    PyCurve { maker, ..PyCurve::new(curve, "Helix", arguments) }
}

/// A cubic spline: at `points[k]` at time `knots[k]`, with r' and r'' continuous; defined from the first to the last knot.
///
/// `knots` are (N,), at least two and strictly increasing, `points` (N, d), d = 2, 3 or 4. `ends` is "natural" (r'' = 0 at both
/// ends), "periodic" (r' and r'' are equal at both ends, and the points must be) or "clamped", with `velocities` (2, d)
/// at the two ends. Raises `RayweaveError` that names the first bad knot or point.
///
/// >>> import rayweave.space as rs
/// >>> path = rs.Spline([0, 1, 2], [[0, 0], [1, 1], [2, 0]])
/// >>> path.domain, path.position(1)
/// ((0.0, 2.0), array([1., 1.]))
#[pyclass(frozen, extends = PyCurve, module = "rayweave.space", name = "Spline")]
pub struct PySpline;

#[pymethods]
impl PySpline {
    #[new]
    #[pyo3(signature = (
        knots: "ArrayLike", points: "ArrayLike",
        ends: "Literal['natural', 'clamped', 'periodic']" = "natural",
        velocities: "ArrayLike | None" = None
    ))]
    fn new(
        knots: &Bound<'_, PyAny>,
        points: &Bound<'_, PyAny>,
        ends: &str,
        velocities: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyClassInitializer<PySpline>> {
        let (knots, points) = (list(knots, "knots")?, rows(points, "points")?);
        let velocities = velocities.map(|object| rows(object, "velocities")).transpose()?;
        let curve = in_dimension!(points.first().map_or(0, Vec::len), D => {
            let ends = spline_ends::<D>(ends, velocities.as_deref())?;
            let points: Vec<Point<D>> = points.iter().map(|row| std::array::from_fn(|k| row[k])).collect();
            Ok(Spline::new(&knots, &points, ends).map_err(bad_value)?)
                .map(|spline| PyCurve::new(spline, "Spline", Vec::new()))
        })?;
        let arguments = vec![
            ("knots", Argument::List(knots)),
            ("points", Argument::Rows(points)),
            ("ends", Argument::Word(ends.to_owned())),
            ("velocities", velocities.map_or(Argument::Nothing, Argument::Rows)),
        ];
        Ok(PyClassInitializer::from(PyCurve { arguments, ..curve }).add_subclass(PySpline))
    }
}

fn spline_ends<const D: usize>(ends: &str, velocities: Option<&[Vec<f64>]>) -> PyResult<SplineEnds<D>> {
    match (ends, velocities) {
        ("natural", None) => Ok(SplineEnds::Natural),
        ("periodic", None) => Ok(SplineEnds::Periodic),
        ("clamped", Some([first, last])) if first.len() == D => {
            let end = |row: &[f64]| std::array::from_fn(|k| row[k]);
            Ok(SplineEnds::Clamped { first: end(first), last: end(last) })
        }
        ("clamped", Some(rows)) => Err(bad_value(format!(
            "velocities has shape ({}, {}): it must be (2, {D}), one for each end.",
            rows.len(),
            rows.first().map_or(0, Vec::len)
        ))),
        ("clamped", None) => {
            Err(bad_value("velocities is missing: ends = 'clamped' needs them, one for each end."))
        }
        ("natural" | "periodic", Some(_)) => Err(bad_value(format!(
            "velocities are given: with ends = '{ends}' they are computed. Use ends = 'clamped'."
        ))),
        _ => Err(bad_value(format!("ends is '{ends}': it must be 'natural', 'clamped' or 'periodic'."))),
    }
}

/// The error of a speed, under its name in Python.
fn in_degrees(error: CurveError) -> PyErr {
    match error {
        CurveError::InvalidArgument { what: "angular_speed", why } => {
            bad_value(CurveError::InvalidArgument { what: "speed", why })
        }
        other => bad_value(other),
    }
}

/// A list of finite numbers.
fn finite(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let numbers = list(object, name)?;
    match numbers.iter().position(|x| !x.is_finite()) {
        None => Ok(numbers),
        Some(k) => Err(bad_value(format!("{name}[{k}] is {}: it must be finite.", numbers[k]))),
    }
}

/// A vector of three-dimensional space.
fn in_space(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let numbers = finite(object, name)?;
    match numbers.len() {
        3 => Ok(numbers),
        other => Err(bad_value(format!("{name} has {other} numbers: it must have 3."))),
    }
}

/// Rows of numbers, all of one length.
fn rows(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Vec<f64>>> {
    let array = double_array(object, name)?;
    if array.ndim() != 2 {
        let shape = shape_text(array.shape());
        return Err(bad_value(format!("{name} has shape {shape}: it must be rows of numbers.")));
    }
    let array = array.try_readonly().map_err(bad_value)?;
    Ok(array.as_array().rows().into_iter().map(|row| row.to_vec()).collect())
}

/// The common length of vectors; an error if they differ.
fn same_length(names: &[&str], vectors: &[Vec<f64>]) -> PyResult<usize> {
    let d = vectors[0].len();
    match vectors.iter().position(|vector| vector.len() != d) {
        None => Ok(d),
        Some(k) => Err(bad_value(format!(
            "{} has {d} numbers and {} has {}: they must have the same length.",
            names[0],
            names[k],
            vectors[k].len()
        ))),
    }
}

/// Vectors of fixed length.
fn fixed<const D: usize, const N: usize>(vectors: &[Vec<f64>; N]) -> [Point<D>; N] {
    vectors.each_ref().map(|vector| std::array::from_fn(|k| vector[k]))
}

fn named<const N: usize>(names: [&'static str; N], vectors: &[Vec<f64>; N]) -> Vec<(&'static str, Argument)> {
    names.into_iter().zip(vectors.iter().cloned().map(Argument::List)).collect()
}
