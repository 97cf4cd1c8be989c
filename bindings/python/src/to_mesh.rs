//! The method `to_mesh` of solids and models.

use pyo3::prelude::*;

/// The method `to_mesh` of solids and models.
pub fn to_mesh<'py>(subject: &Bound<'py, PyAny>, tolerance: Option<f64>) -> PyResult<Bound<'py, PyAny>> {
    subject.py().import("rayweave._mesh")?.getattr("mesh_of")?.call1((subject, tolerance))
}
