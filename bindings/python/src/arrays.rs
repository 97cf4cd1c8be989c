//! Conversion of NumPy arguments: dtypes, memory layouts and shapes.

use std::fmt::Display;

use numpy::ndarray::Array2;
use numpy::{
    Element, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;

use rayweave::model::memory;

use crate::error::{bad_type, bad_value};

/// A real array of one of the two supported types, in a directly readable layout.
pub enum RealArray<'py> {
    /// Given as float32.
    Single(Bound<'py, PyArrayDyn<f32>>),
    /// Given as float64, or converted to it.
    Double(Bound<'py, PyArrayDyn<f64>>),
}

/// Converts an object to a real array: float32 and float64 arrays are kept, integers and other
/// floating-point numbers become float64. Anything else is a `TypeError` that names the array.
pub fn real_array<'py>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<RealArray<'py>> {
    if let Ok(array) = object.cast::<PyArrayDyn<f64>>()
        && is_plain(array)
        && !is_masked(object)?
    {
        return Ok(RealArray::Double(array.clone()));
    }
    let array = as_array(object, name)?;
    match array.dtype().kind() {
        b'f' if array.dtype().itemsize() == size_of::<f32>() => converted(&array).map(RealArray::Single),
        b'f' | b'i' | b'u' => converted(&array).map(RealArray::Double),
        b'O' => Err(bad_type(format!(
            "{name} has dtype object: its elements are Python objects, not numbers of one type. Convert it, as by \
             numpy.asarray(values, dtype=float)."
        ))),
        _ => Err(bad_type(format!("{name} has dtype {}: its numbers must be real.", array.dtype()))),
    }
}

impl<'py> RealArray<'py> {
    /// The array as float64, copied only if it is float32.
    pub fn into_double(self) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        match self {
            RealArray::Double(array) => Ok(array),
            RealArray::Single(array) => converted(array.as_untyped()),
        }
    }
}

/// Like [`real_array`], but always float64.
pub fn double_array<'py>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    real_array(object, name)?.into_double()
}

/// A one-dimensional array as a list of numbers.
pub fn list(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let array = double_array(object, name)?;
    if array.ndim() != 1 {
        let shape = shape_text(array.shape());
        return Err(bad_value(format!("{name} has shape {shape}: it must be a list of numbers.")));
    }
    let array = array.try_readonly().map_err(bad_value)?;
    // an array may be larger than its memory, by a stride of 0
    let mut numbers = room(array.len())?;
    numbers.extend(array.as_array().iter());
    Ok(numbers)
}

/// A one-dimensional array as a list of numbers, for argument checks of functions written in
/// Python.
#[pyfunction]
#[pyo3(signature = (values: "ArrayLike", name))]
pub fn number_list(values: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    list(values, name)
}

/// The shape as NumPy prints it.
pub fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => {
            let sizes: Vec<String> = shape.iter().map(ToString::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

/// The array in row-major layout without gaps; a copy if it has another layout.
pub fn contiguous<'py, T: Element>(array: Bound<'py, PyArrayDyn<T>>) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    if array.is_c_contiguous() {
        return Ok(array);
    }
    let copy = array.call_method1("copy", ("C",))?;
    Ok(copy.cast_into()?)
}

/// True for arrays of `numpy.ma`.
fn is_masked(object: &Bound<'_, PyAny>) -> PyResult<bool> {
    let py = object.py();
    // plain arrays are the usual case
    if object.get_type().is(py.get_type::<PyUntypedArray>()) {
        return Ok(false);
    }
    static MASKED: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    object.is_instance(MASKED.import(py, "numpy.ma", "MaskedArray")?)
}

/// Result of `numpy.asarray` for an object.
fn as_array<'py>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = object.py();
    if object.is_none() {
        return Err(bad_type(format!("{name} is None: it must be an array of numbers.")));
    }
    let module = numpy::get_array_module(py)?;
    // the values below the mask mean nothing
    if is_masked(object)? {
        return Err(bad_type(format!(
            "{name} is a masked array: masks are not supported. Select the rows, such as {name}[~{name}.mask.any(axis=-1)].data, or fill \
             them ({name}.filled(...))."
        )));
    }
    match module.call_method1("asarray", (object,)) {
        Ok(array) => Ok(array.cast_into()?),
        Err(error) if error.is_instance_of::<PyValueError>(py) => {
            Err(bad_value(format!("{name} is not an array of numbers: {}.", error.value(py))))
        }
        Err(error) => Err(error),
    }
}

/// The array with elements of type `T` in a plain layout, copied only if necessary.
fn converted<'py, T: Element>(array: &Bound<'py, PyUntypedArray>) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    if let Ok(array) = array.cast::<PyArrayDyn<T>>()
        && is_plain(array)
    {
        return Ok(array.clone());
    }
    let copy = array.call_method1("astype", (T::get_dtype(array.py()), "C"))?;
    Ok(copy.cast_into()?)
}

/// True if the elements are aligned and their strides are multiples of the element size, unlike
/// some fields of packed record arrays.
fn is_plain<T: Element>(array: &Bound<'_, PyArrayDyn<T>>) -> bool {
    let whole = |stride: &isize| stride % size_of::<T>() as isize == 0;
    array.is_aligned() && array.strides().iter().all(whole) && array.len() > 0
}

/// The error about something that does not fit into memory.
pub fn no_memory(what: &str, reason: &dyn Display) -> PyErr {
    PyMemoryError::new_err(format!("not enough memory for {what}: {reason}."))
}

/// An empty list with capacity for `len` entries, or a `MemoryError`.
pub fn room<T>(len: usize) -> PyResult<Vec<T>> {
    let refused = |reason: &dyn Display| {
        no_memory(&format!("a list of {len} entries of {} bytes", size_of::<T>()), reason)
    };
    memory::check(len as u64, size_of::<T>() as u64).map_err(|shortage| refused(&shortage))?;
    let mut list = Vec::new();
    list.try_reserve_exact(len).map(|()| list).map_err(|error| refused(&error))
}

/// The number of elements from which on NumPy allocates the array, because it uses large pages and
/// leaves them uninitialised.
pub const MANY: usize = 1 << 14;

/// Creates a one-dimensional array. The caller must write all elements.
pub fn fresh<T: Element + Copy + Default>(py: Python<'_>, len: usize) -> PyResult<Bound<'_, PyArray1<T>>> {
    if len >= MANY {
        return Ok(empty::<T>(py, &[len])?.cast_into()?);
    }
    Ok(PyArray1::from_vec(py, vec![T::default(); len]))
}

/// Creates a two-dimensional array. The caller must write all elements.
pub fn fresh_table<T: Element + Copy + Default>(
    py: Python<'_>,
    [rows, columns]: [usize; 2],
) -> PyResult<Bound<'_, PyArray2<T>>> {
    if rows.saturating_mul(columns) >= MANY {
        return Ok(empty::<T>(py, &[rows, columns])?.cast_into()?);
    }
    Ok(PyArray2::from_owned_array(py, Array2::from_elem((rows, columns), T::default())))
}

/// True if NumPy owns the memory of an array of [`fresh_table`], which can then be resized.
pub fn is_from_numpy<T>(table: &Bound<'_, PyArray2<T>>) -> bool {
    table.len() >= MANY
}

/// Creates an array of booleans, all false.
pub fn fresh_flags(py: Python<'_>, len: usize) -> PyResult<Bound<'_, PyArray1<bool>>> {
    if len >= MANY {
        static ZEROS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        return Ok(ZEROS.import(py, "numpy", "zeros")?.call1((len, bool::get_dtype(py)))?.cast_into()?);
    }
    Ok(PyArray1::from_vec(py, vec![false; len]))
}

fn empty<'py, T: Element>(py: Python<'py>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let entries = shape.iter().fold(1u64, |entries, &size| entries.saturating_mul(size as u64));
    memory::check(entries, size_of::<T>() as u64)
        .map_err(|shortage| no_memory(&format!("the answer of shape {}", shape_text(shape)), &shortage))?;
    static EMPTY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    EMPTY.import(py, "numpy", "empty")?.call1((PyTuple::new(py, shape)?, T::get_dtype(py)))
}
