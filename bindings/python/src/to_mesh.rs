//! The method `to_mesh` of solids and models.

use pyo3::prelude::*;

/// The method `to_mesh` of solids and models.
pub fn to_mesh<'py>(subject: &Bound<'py, PyAny>, tolerance: Option<f64>) -> PyResult<Bound<'py, PyAny>> {
    subject.py().import("rayweave._mesh")?.getattr("mesh_of")?.call1((subject, tolerance))
}

/// The meshes of the regions of a model, by their names.
pub fn to_meshes<'py>(model: &Bound<'py, PyAny>, tolerance: Option<f64>) -> PyResult<Bound<'py, PyAny>> {
    model.py().import("rayweave._mesh")?.getattr("meshes_of")?.call1((model, tolerance))
}
