//! The root-ray as a Python class.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyList, PyString, PyTuple};
use rayweave::rootray::hit_array::{from_column, to_column};
use rayweave::rootray::{RootRay, Side, min_sep, seed, surface_count, validate_times};

use crate::arrays::list;
use crate::error::{bad_type, bad_value, shown};

/// The parts of one trajectory inside one solid: the side on which it starts and the times at which it changes sides.
///
/// `start` is +1 or "outside", -1 or "inside": the side as t goes to -inf. `roots` are the times of the crossings: finite and
/// strictly increasing. The operators `| & - ^ ~` are exact: equal times toggle together, and no comparison uses a
/// tolerance. It unpacks and compares as the pair `(start, list of roots)`.
///
/// >>> import rayweave as rw
/// >>> a, b = rw.RootRay("outside", [1, 4]), rw.RootRay("outside", [2, 3])
/// >>> a - b
/// RootRay(+1, [1.0, 2.0, 3.0, 4.0])
/// >>> (a & b).spans(), (~a).starts_inside
/// ([(2.0, 3.0)], True)
#[pyclass(frozen, module = "rayweave", name = "RootRay", sequence)]
pub struct PyRootRay(RootRay);

#[pymethods]
impl PyRootRay {
    #[new]
    #[pyo3(signature = (start: "int | Literal['outside', 'inside']", roots: "ArrayLike"))]
    fn new(start: &Bound<'_, PyAny>, roots: &Bound<'_, PyAny>) -> PyResult<Self> {
        let roots = list(roots, "roots")?;
        RootRay::from_times(side(start)?, roots)
            .map(PyRootRay)
            .map_err(|error| bad_value(format!("roots: {error}")))
    }

    /// The root-ray of one column of a hit array: -inf entries give the start, equal entries cancel, +inf is dropped.
    #[staticmethod]
    #[pyo3(signature = (column: "ArrayLike"))]
    fn from_hits(column: &Bound<'_, PyAny>) -> PyResult<Self> {
        let column = list(column, "column")?;
        from_column(&column).map(PyRootRay).map_err(bad_value)
    }

    /// The root-ray as a column of a hit array: float64 (H,), -inf first if it starts inside, padded with +inf.
    fn to_hits<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        numpy::PyArray1::from_vec(py, to_column(&self.0))
    }

    /// +1 if the trajectory starts outside, -1 if it starts inside.
    #[getter]
    fn start(&self) -> i64 {
        if self.0.start().is_inside() { -1 } else { 1 }
    }

    /// The times of the crossings, in order.
    #[getter]
    fn roots(&self) -> Vec<f64> {
        self.0.times().collect()
    }

    /// Whether the trajectory starts inside, as t goes to -inf.
    #[getter]
    fn starts_inside(&self) -> bool {
        self.0.start().is_inside()
    }

    /// Whether the trajectory ends inside, as t goes to +inf.
    #[getter]
    fn ends_inside(&self) -> bool {
        self.0.end().is_inside()
    }

    /// Whether the trajectory is inside just after `t`.
    #[pyo3(signature = (t))]
    fn is_inside(&self, t: f64) -> PyResult<bool> {
        Ok(self.0.side_at(t).map_err(bad_value)?.is_inside())
    }

    /// The open intervals of times spent inside, in order; the ends may be infinite.
    fn spans(&self) -> Vec<(f64, f64)> {
        self.0.spans().collect()
    }

    /// The crossings with t_min < t < t_max; the side just after t_min becomes the start.
    #[pyo3(signature = (t_min = f64::NEG_INFINITY, t_max = f64::INFINITY))]
    fn clip(&self, t_min: f64, t_max: f64) -> PyResult<Self> {
        self.0.clip(t_min, t_max).map(PyRootRay).map_err(bad_value)
    }

    /// The root-ray without pieces shorter than `min_sep`, by default `rayweave.rootray.min_sep` of their ends.
    #[pyo3(signature = (min_sep = None))]
    fn weld(&self, min_sep: Option<f64>) -> PyResult<Self> {
        match min_sep {
            None => Ok(PyRootRay(self.0.weld(rayweave::rootray::min_sep))),
            Some(length) if length >= 0.0 && length.is_finite() => Ok(PyRootRay(self.0.weld(|_, _| length))),
            Some(length) => {
                Err(bad_value(format!("min_sep is {length}: it must be finite and not negative.")))
            }
        }
    }

    fn __or__(&self, other: PyRef<'_, Self>) -> Self {
        PyRootRay(&self.0 | &other.0)
    }

    fn __and__(&self, other: PyRef<'_, Self>) -> Self {
        PyRootRay(&self.0 & &other.0)
    }

    fn __sub__(&self, other: PyRef<'_, Self>) -> Self {
        PyRootRay(&self.0 - &other.0)
    }

    fn __xor__(&self, other: PyRef<'_, Self>) -> Self {
        PyRootRay(&self.0 ^ &other.0)
    }

    fn __invert__(&self) -> Self {
        PyRootRay(!&self.0)
    }

    fn __len__(&self) -> usize {
        2
    }

    #[cfg_attr(false, stub("(index: Literal[0, -2]) -> int"))]
    #[cfg_attr(false, stub("(index: Literal[1, -1]) -> list[float]"))]
    fn __getitem__<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, PyAny>> {
        self.pair(py)?.as_any().get_item(index)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyIterator>> {
        self.pair(py)?.as_any().try_iter()
    }

    fn __eq__<'py>(&self, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = other.py();
        let equal = match other.cast::<PyRootRay>() {
            Ok(other) => self.0 == other.get().0,
            Err(_) if other.is_instance_of::<PyTuple>() => self.pair(py)?.eq(other)?,
            Err(_) => return Ok(py.NotImplemented().into_bound(py)),
        };
        Ok(PyBool::new(py, equal).to_owned().into_any())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        PyTuple::new(py, self.0.times())?.hash()
    }

    fn __repr__(&self) -> String {
        const SHOWN: usize = 6;
        let roots: Vec<String> = self.0.times().take(SHOWN).map(|t| format!("{t:?}")).collect();
        let rest = self.0.roots().len() - roots.len();
        let more = if rest > 0 { format!(", ... {rest} more") } else { String::new() };
        format!("RootRay({:+}, [{}{more}])", self.start(), roots.join(", "))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        Ok((py.get_type::<Self>().into_any(), self.pair(py)?))
    }
}

impl PyRootRay {
    /// Wraps a root-ray.
    pub fn from_root_ray(ray: RootRay) -> Self {
        PyRootRay(ray)
    }

    /// The root-ray.
    pub fn root_ray(&self) -> &RootRay {
        &self.0
    }

    fn pair<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let roots = PyList::new(py, self.0.times())?.into_any();
        PyTuple::new(py, [self.start().into_pyobject(py)?.into_any(), roots])
    }
}

/// The start side: the sign of the seed, or a word. A bool is ambiguous and is rejected.
fn side(start: &Bound<'_, PyAny>) -> PyResult<Side> {
    if let Ok(word) = start.cast::<PyString>() {
        return match word.to_str()? {
            "outside" => Ok(Side::Outside),
            "inside" => Ok(Side::Inside),
            other => {
                Err(bad_value(format!("start is '{other}': it must be 'outside' or 'inside', +1 or -1.")))
            }
        };
    }
    if !start.is_instance_of::<PyBool>()
        && let Ok(sign) = start.extract::<i64>()
    {
        let ray = seed::from_pair(sign, &[]);
        return ray.map(|ray| ray.start()).map_err(|error| bad_value(format!("start: {error}")));
    }
    Err(bad_type(format!("start is {}: it must be +1 or 'outside', -1 or 'inside'.", shown(start))))
}

/// The minimum separation of two root times: see `rayweave.rootray.min_sep`.
#[pyfunction]
#[pyo3(name = "min_sep", signature = (t1, t2))]
pub fn least_separation(t1: f64, t2: f64) -> PyResult<f64> {
    for (name, t) in [("t1", t1), ("t2", t2)] {
        if !t.is_finite() {
            return Err(bad_value(format!("{name} is {t}: root times are finite.")));
        }
    }
    Ok(min_sep(t1, t2))
}

/// All problems of a list of root times, as messages: see `rayweave.rootray.validate`.
#[pyfunction]
#[pyo3(signature = (roots: "ArrayLike"))]
pub fn root_problems(roots: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    let roots = list(roots, "roots")?;
    Ok(validate_times(roots).iter().map(ToString::to_string).collect())
}

/// The number of root-rays that are inside: see `rayweave.rootray.surface_count`.
#[pyfunction]
#[pyo3(name = "surface_count", signature = (rays))]
pub fn count_surfaces(rays: Vec<PyRef<'_, PyRootRay>>) -> (usize, Vec<(f64, usize)>) {
    let count = surface_count(rays.iter().map(|ray| &ray.0));
    (count.start, count.steps)
}
