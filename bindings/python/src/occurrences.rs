//! Paths of occurrences: names and copy numbers of the shapes that rays cross.

use std::collections::HashMap;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyString};
use rayweave::model::Program;

use crate::error::{bad_type, bad_value, shown};

/// The path of each occurrence, or of the innermost placed solid around it; empty for -1.
pub fn paths<'py>(
    program: &Program,
    occurrences: &Bound<'py, PyAny>,
    placed: bool,
) -> PyResult<Bound<'py, PyList>> {
    let py = occurrences.py();
    let mut known: HashMap<i64, Bound<'py, PyString>> = HashMap::from([(-1, PyString::new(py, ""))]);
    let mut paths = Vec::new();
    for (index, number) in numbers(occurrences)?.into_iter().enumerate() {
        let path = match known.get(&number) {
            Some(path) => path.clone(),
            None => {
                let text = path(program, number, placed).ok_or_else(|| unknown(index, number))?;
                known.entry(number).or_insert(PyString::new(py, &text)).clone()
            }
        };
        paths.push(path);
    }
    PyList::new(py, paths)
}

fn path(program: &Program, number: i64, placed: bool) -> Option<String> {
    let path = program.occurrence_path(program.occurrence(u64::try_from(number).ok()?)?);
    Some(if placed { path.placed().to_string() } else { path.to_string() })
}

fn unknown(index: usize, number: i64) -> PyErr {
    bad_value(format!(
        "occurrences[{index}] is {number}: there is no such occurrence. Was it found in another model?"
    ))
}

/// The numbers of an array or of a list.
fn numbers(occurrences: &Bound<'_, PyAny>) -> PyResult<Vec<i64>> {
    if let Ok(array) = occurrences.cast::<PyArray1<i64>>() {
        return Ok(array.try_readonly().map_err(bad_value)?.as_array().to_vec());
    }
    let wrong = |_| {
        let kind = shown(occurrences);
        bad_type(format!("occurrences is {kind}: it must be an array or a list of whole numbers."))
    };
    occurrences.extract().map_err(wrong)
}
