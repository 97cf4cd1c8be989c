//! Conversion of errors to Python exceptions.

use std::path::{Path, PathBuf};

use pyo3::exceptions::{PyAttributeError, PyFileNotFoundError, PyTypeError, PyValueError};
use pyo3::prelude::*;

pyo3::create_exception!(
    rayweave,
    RayweaveError,
    PyValueError,
    "A value that cannot be used: the message says which one, where, and why.\n\n\
     A wrong type is a TypeError.\n\n\
     >>> import rayweave as rw\n\
     >>> rw.sphere(-1)\n\
     Traceback (most recent call last):\n\
     ...\n\
     rayweave.RayweaveError: sphere: radius is -1: radius must be finite and greater than 0. Did you mean 1?"
);

/// A `RayweaveError` with this message.
pub fn bad_value(message: impl std::fmt::Display) -> PyErr {
    RayweaveError::new_err(message.to_string())
}

/// A `TypeError` with this message.
pub fn bad_type(message: impl std::fmt::Display) -> PyErr {
    PyTypeError::new_err(message.to_string())
}

/// The error about an attribute that an object does not have; `words` has words of other programs with what to write.
pub fn no_attribute(kind: &str, name: &str, words: &[(&str, &str)]) -> PyErr {
    let meant = words.iter().find(|(word, _)| *word == name);
    let hint = meant.map_or(String::new(), |(_, write)| format!(": write {write}"));
    PyAttributeError::new_err(format!("a {kind} has no attribute '{name}'{hint}"))
}

/// The error about a solid as a condition, such as `a and b`, which Python would answer with `b`.
pub fn no_truth_value() -> PyErr {
    bad_type(
        "a solid has no truth value: `and`, `or`, `not` and `if` do not combine solids. Write a & b (intersection), a | b (union), \
         a - b (difference) or ~a (complement), or `is not None` to test for a missing solid.",
    )
}

/// The error about the sum of two solids.
pub fn no_sum() -> PyErr {
    bad_type(
        "a solid has no sum: the operators are | (union), & (intersection), - (difference), ^ and ~. Write a | b.",
    )
}

/// An argument in a message: its text, or its type if that is long.
pub fn shown(object: &Bound<'_, PyAny>) -> String {
    const LONG: usize = 40;
    let text = object.repr().map(|text| text.to_string()).unwrap_or_default();
    if text.len() <= LONG && !text.is_empty() && !text.contains(" at 0x") {
        return text;
    }
    let kind =
        object.get_type().name().map_or_else(|_| "an unknown type".to_owned(), |name| name.to_string());
    format!("of type {kind}")
}

/// Rejects the path of an input file that does not exist, with a `FileNotFoundError`.
pub fn require_file(path: &Path) -> PyResult<()> {
    // errors other than absence are reported by the reader of the file
    match path.try_exists() {
        Ok(false) => Err(PyFileNotFoundError::new_err((
            NO_ENTRY,
            match rayweave::scene::nearby_files(path) {
                Some(hint) => format!("there is no such file: {hint}"),
                None => "there is no such file".to_owned(),
            },
            path.to_string_lossy().into_owned(),
        ))),
        _ => Ok(()),
    }
}

/// Raises a `FileNotFoundError` with files of similar names if there is no such file.
#[pyfunction]
#[pyo3(signature = (path))]
pub fn require_input(path: PathBuf) -> PyResult<()> {
    require_file(&path)
}

/// The error number `ENOENT`, which has the same value on all supported platforms.
const NO_ENTRY: i32 = 2;
