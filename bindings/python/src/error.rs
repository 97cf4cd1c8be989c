//! Conversion of errors to Python exceptions.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

pyo3::create_exception!(
    rayweave,
    RayweaveError,
    PyValueError,
    "A value that cannot be used: the message says which one, where, and why.\n\n\
     A wrong type is a TypeError."
);

/// A `RayweaveError` with this message.
pub fn bad_value(message: impl std::fmt::Display) -> PyErr {
    RayweaveError::new_err(message.to_string())
}

/// A `TypeError` with this message.
pub fn bad_type(message: impl std::fmt::Display) -> PyErr {
    PyTypeError::new_err(message.to_string())
}
