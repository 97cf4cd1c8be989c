//! Shapes: their manual pages, and solids from their names and parameters.

use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyTuple};
use rayweave::shape::primitive::{MANUALS, Manual, Parameter, ParameterKind, Value, build, manual};

use crate::arrays::{double_array, shape_text};
use crate::error::{bad_type, bad_value, shown};
use crate::solid::PySolid;

/// The manual pages of all shapes: dicts with the fields `name`, `parameters`, `equation`, `faces` and `text`.
#[pyfunction]
#[pyo3(signature = () -> "list[dict[str, Any]]")]
pub fn manuals(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    MANUALS.iter().map(|manual| page(py, manual)).collect()
}

fn page<'py>(py: Python<'py>, manual: &Manual) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let parameters: PyResult<Vec<_>> = manual.parameters.iter().map(|p| parameter(py, p)).collect();
    dict.set_item("name", manual.name)?;
    dict.set_item("parameters", parameters?)?;
    dict.set_item("equation", manual.equation)?;
    dict.set_item("faces", manual.faces)?;
    dict.set_item("text", manual.text)?;
    Ok(dict)
}

fn parameter<'py>(py: Python<'py>, parameter: &Parameter) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", parameter.name)?;
    dict.set_item("kind", parameter.kind.to_string())?;
    dict.set_item("type", parameter.kind.python_type())?;
    dict.set_item("unit", parameter.unit.to_string())?;
    dict.set_item("range", parameter.range.to_string())?;
    match parameter.kind {
        // a list is empty by default
        ParameterKind::Numbers => dict.set_item("default", PyTuple::empty(py))?,
        _ => dict.set_item("default", parameter.default)?,
    }
    dict.set_item("summary", parameter.summary)?;
    Ok(dict)
}

/// The shape of this name; `values` are those of all its parameters, in the order of the manual
/// page.
#[pyfunction]
#[pyo3(signature = (name, values: "Sequence[Any]"))]
pub fn shape(name: &str, values: Vec<Bound<'_, PyAny>>) -> PyResult<PySolid> {
    let parameters = manual(name).map_or(&[][..], |manual| manual.parameters);
    let arguments: PyResult<Vec<(&str, Value)>> = (parameters.iter().zip(&values))
        .map(|(parameter, object)| Ok((parameter.name, value(name, parameter, object)?)))
        .collect();
    let primitive = build(name, &arguments?).map_err(bad_value)?;
    Ok(PySolid::from_solid(primitive.into()))
}

/// Converts a value to the type of its parameter.
fn value(shape: &str, parameter: &Parameter, object: &Bound<'_, PyAny>) -> PyResult<Value> {
    let wrong = || {
        let (name, kind) = (parameter.name, parameter.kind);
        bad_type(format!("{shape}: {name} is {}: it must be {kind}.", shown(object)))
    };
    if object.is_instance_of::<PyBool>() {
        return Err(wrong());
    }
    match parameter.kind {
        ParameterKind::Number | ParameterKind::Count => {
            object.extract().map(Value::Number).map_err(|_| wrong())
        }
        _ => {
            if let Ok(number) = object.extract() {
                return Ok(Value::Number(number));
            }
            numbers(object, &format!("{shape}: {}", parameter.name))
        }
    }
}

/// A list of numbers or of rows.
fn numbers(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Value> {
    let array = double_array(object, name)?;
    let entries: Vec<f64> = array.try_readonly().map_err(bad_value)?.as_array().iter().copied().collect();
    match *array.shape() {
        [_] => Ok(Value::Vector(entries)),
        [rows, 0] => Ok(Value::Rows(vec![Vec::new(); rows])),
        [_, columns] => Ok(Value::Rows(entries.chunks_exact(columns).map(<[f64]>::to_vec).collect())),
        ref other => Err(bad_value(format!(
            "{name} has shape {}: it must be a list of numbers or of rows.",
            shape_text(other)
        ))),
    }
}
