//! Boolean operations on hit arrays.

use std::num::NonZeroUsize;

use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBool;
use rayweave::model::drive::thread_count;
use rayweave::rootray::hit_array::{self, CsgOptions, Float, HitArray, HitArrayError, Operation, Regularize};

use crate::arrays::{RealArray, contiguous, real_array, shape_text};
use crate::engine::thread_argument;
use crate::error::{bad_type, bad_value, shown};

type Array<'py, T> = Bound<'py, PyArrayDyn<T>>;

/// Two hit arrays of one type with the shape of their result.
struct Pair<'py, T: Element> {
    array1: PyReadonlyArrayDyn<'py, T>,
    array2: PyReadonlyArrayDyn<'py, T>,
    /// (H1 + H2,) or (H1 + H2, N).
    shape: Vec<usize>,
}

impl<'py, T: Float + Element> Pair<'py, T> {
    fn new(array1: Array<'py, T>, array2: Array<'py, T>) -> PyResult<Self> {
        let (shape1, shape2) = (hit_shape(&array1, "array1")?, hit_shape(&array2, "array2")?);
        if shape1.len() != shape2.len() {
            return Err(bad_value(format!(
                "array1 has shape {} and array2 has shape {}: both must be one ray, or both an array of rays.",
                shape_text(&shape1),
                shape_text(&shape2)
            )));
        }
        let shape = [&[shape1[0] + shape2[0]], &shape1[1..]].concat();
        let borrow = |array: Array<'py, T>| contiguous(array)?.try_readonly().map_err(bad_value);
        Ok(Pair { array1: borrow(array1)?, array2: borrow(array2)?, shape })
    }

    /// Both arrays in the form that the algebra takes.
    fn views(&self) -> PyResult<(HitArray<'_, T>, HitArray<'_, T>)> {
        Ok((view(&self.array1)?, view(&self.array2)?))
    }
}

fn hit_shape<T: Element>(array: &Array<'_, T>, name: &str) -> PyResult<Vec<usize>> {
    match array.shape() {
        shape @ ([_] | [_, _]) => Ok(shape.to_vec()),
        other => Err(bad_value(format!(
            "{name} has shape {}: hits of one ray are (H,), of N rays (H, N).",
            shape_text(other)
        ))),
    }
}

fn view<'a, T: Float + Element>(array: &'a PyReadonlyArrayDyn<'_, T>) -> PyResult<HitArray<'a, T>> {
    let columns = array.shape().get(1).copied().unwrap_or(1);
    HitArray::new(array.as_slice().map_err(bad_value)?, array.shape()[0], columns).map_err(bad_value)
}

/// An operation on two arrays of any element type.
struct Request<'a, 'py> {
    operation: Operation,
    sort_output: bool,
    regularize: Regularize<f64>,
    threads: Option<NonZeroUsize>,
    out: Option<&'a Bound<'py, PyAny>>,
}

impl<'py> Request<'_, 'py> {
    fn run<T: Float + Element>(
        &self,
        pair: Pair<'py, T>,
        narrow: impl Fn(f64) -> T,
    ) -> PyResult<Bound<'py, PyAny>> {
        let regularize = match self.regularize {
            Regularize::No => Regularize::No,
            Regularize::Exact => Regularize::Exact,
            Regularize::Weld(min_sep) => Regularize::Weld(narrow(min_sep)),
        };
        // querying the number of cores takes longer than processing a small array
        let threads = match hit_array::most_threads(pair.array1.len() + pair.array2.len()) {
            NonZeroUsize::MIN => NonZeroUsize::MIN,
            most => thread_count(self.threads).min(most),
        };
        let options =
            CsgOptions { sort_output: self.sort_output, regularize, threads, ..CsgOptions::default() };
        match self.out {
            None => self.fresh(pair, options).map(Bound::into_any),
            Some(out) => self.write(pair, options, out),
        }
    }

    fn fresh<T: Float + Element>(
        &self,
        pair: Pair<'py, T>,
        options: CsgOptions<T>,
    ) -> PyResult<Array<'py, T>> {
        let py = pair.array1.py();
        let (array1, array2) = pair.views()?;
        let operation = self.operation;
        let hits = py.detach(|| hit_array::array_csg(array1, array2, operation, options));
        to_array(py, hits.map_err(bad_value)?, &pair.shape)
    }

    fn write<T: Float + Element>(
        &self,
        pair: Pair<'py, T>,
        options: CsgOptions<T>,
        out: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let array = output::<T>(out, &pair.shape)?;
        // written directly, unless it shares memory with an operand, which must be read completely
        // first
        if array.is_c_contiguous()
            && array.is_aligned()
            && let Ok(mut borrowed) = array.try_readwrite()
        {
            let (array1, array2) = pair.views()?;
            let slice = borrowed.as_slice_mut().map_err(bad_value)?;
            let (py, operation) = (pair.array1.py(), self.operation);
            py.detach(|| hit_array::array_csg_into(array1, array2, operation, options, slice))
                .map_err(bad_value)?;
            return Ok(out.clone());
        }
        let hits = self.fresh(pair, options)?;
        out.set_item(pyo3::types::PyEllipsis::get(out.py()), hits)?;
        Ok(out.clone())
    }
}

/// `out` as an array of the result's type and shape.
fn output<'a, 'py, T: Element>(out: &'a Bound<'py, PyAny>, shape: &[usize]) -> PyResult<&'a Array<'py, T>> {
    let Ok(array) = out.cast::<PyArrayDyn<T>>() else {
        let found = match out.cast::<numpy::PyUntypedArray>() {
            Ok(array) => format!("an array of dtype {}", array.dtype()),
            Err(_) => shown(out),
        };
        return Err(bad_type(format!(
            "out is {found}: it must be an array of dtype {}.",
            T::get_dtype(out.py())
        )));
    };
    if array.shape() != shape {
        return Err(bad_value(format!(
            "out has shape {}: the result has shape {}.",
            shape_text(array.shape()),
            shape_text(shape)
        )));
    }
    if !array.getattr("flags")?.getattr("writeable")?.is_truthy()? {
        return Err(bad_value("out is read-only: the result is written to it."));
    }
    Ok(array)
}

fn to_array<'py, T: Element>(py: Python<'py>, data: Vec<T>, shape: &[usize]) -> PyResult<Array<'py, T>> {
    let array = ArrayD::from_shape_vec(IxDyn(shape), data).map_err(bad_value)?;
    Ok(PyArrayDyn::from_owned_array(py, array))
}

/// The numbers of the members of `rayweave.Operation`.
fn operation_from(number: u8) -> PyResult<Operation> {
    match number {
        1 => Ok(Operation::Union),
        2 => Ok(Operation::Intersect),
        3 => Ok(Operation::Difference),
        _ => Err(bad_value(format!("operation {number} is none of 1, 2, 3"))),
    }
}

fn regularize_from(object: &Bound<'_, PyAny>) -> PyResult<Regularize<f64>> {
    let is_bool = object.is_instance_of::<PyBool>() || object.get_type().name()? == "bool";
    if is_bool {
        return Ok(if object.is_truthy()? { Regularize::Exact } else { Regularize::No });
    }
    match object.extract::<f64>() {
        Ok(min_sep) => Ok(Regularize::Weld(min_sep)),
        Err(_) => Err(bad_type(format!(
            "regularize is {}: it must be True, False or the minimum length of a piece.",
            shown(object)
        ))),
    }
}

/// The hits of `array1 operation array2`: see `rayweave.array_csg`.
#[pyfunction]
#[pyo3(signature = (
    array1: "ArrayLike", array2: "ArrayLike", operation, sort_output, regularize: "bool | float",
    out: "NDArray[Any] | None", threads: "int | None"
) -> "NDArray[Any]")]
pub fn array_csg<'py>(
    array1: &Bound<'py, PyAny>,
    array2: &Bound<'py, PyAny>,
    operation: u8,
    sort_output: bool,
    regularize: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let request = Request {
        operation: operation_from(operation)?,
        sort_output,
        regularize: regularize_from(regularize)?,
        threads: threads.map(thread_argument).transpose()?,
        out,
    };
    match (real_array(array1, "array1")?, real_array(array2, "array2")?) {
        (RealArray::Single(a), RealArray::Single(b)) => {
            request.run(Pair::new(a, b)?, |min_sep| min_sep as f32)
        }
        (a, b) => request.run(Pair::new(a.into_double()?, b.into_double()?)?, |min_sep| min_sep),
    }
}

/// The merged entries of two hit arrays and the count after each: see `rayweave.count_array`.
#[pyfunction]
#[pyo3(signature = (
    array1: "ArrayLike", array2: "ArrayLike", operation
) -> "tuple[NDArray[Any], NDArray[np.int64]]")]
pub fn count_array<'py>(
    array1: &Bound<'py, PyAny>,
    array2: &Bound<'py, PyAny>,
    operation: u8,
) -> PyResult<(Bound<'py, PyAny>, Array<'py, i64>)> {
    let operation = operation_from(operation)?;
    match (real_array(array1, "array1")?, real_array(array2, "array2")?) {
        (RealArray::Single(a), RealArray::Single(b)) => count(&Pair::new(a, b)?, operation),
        (a, b) => count(&Pair::new(a.into_double()?, b.into_double()?)?, operation),
    }
}

fn count<'py, T: Float + Element>(
    pair: &Pair<'py, T>,
    operation: Operation,
) -> PyResult<(Bound<'py, PyAny>, Array<'py, i64>)> {
    let py = pair.array1.py();
    let (array1, array2) = pair.views()?;
    let counted = py.detach(|| -> Result<_, HitArrayError> {
        let counted = hit_array::count_array(array1, array2, operation)?;
        let counts: Vec<i64> = counted.counts.into_iter().map(i64::from).collect();
        Ok((counted.times, counts))
    });
    let (times, counts) = counted.map_err(bad_value)?;
    Ok((to_array(py, times, &pair.shape)?.into_any(), to_array(py, counts, &pair.shape)?))
}
