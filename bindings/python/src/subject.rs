//! Subjects of queries: a solid or a model as a scene, and boxes by their corners.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList, PyTuple, PyType};
use rayweave::scene::Scene;
use rayweave::{Bounds, Vec3};

use crate::error::{bad_type, shown};
use crate::model::PyModel;
use crate::solid::PySolid;
use crate::solid_scene::scene_of;

/// A box by its corners.
pub fn bounds([lo, hi]: [[f64; 3]; 2]) -> Bounds {
    Bounds { lo: Vec3::from(lo), hi: Vec3::from(hi) }
}

/// The solid or model itself, or the model of a region, of a list or of a dict of solids and regions.
pub fn gathered<'py>(subject: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = subject.py();
    if subject.is_instance_of::<PySolid>() || subject.is_instance_of::<PyModel>() {
        return Ok(subject.clone());
    }
    let is_several = subject.is_instance_of::<PyList>()
        || subject.is_instance_of::<PyTuple>()
        || subject.is_instance_of::<PyDict>();
    static REGION: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    if is_several || subject.is_instance(REGION.import(py, "rayweave._model", "Region")?)? {
        return py.get_type::<PyModel>().call1((subject,));
    }
    static ELEMENT: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    if subject.is_instance(ELEMENT.import(py, "rayweave.optics._elements", "Element")?)? {
        let body = subject.getattr("body")?;
        if body.is_instance_of::<PySolid>() {
            return Ok(body);
        }
        return Err(bad_type(
            "subject is an element without a solid: it is a sheet. Pass a lens, a mirror or a prism.",
        ));
    }
    let given = shown(subject);
    Err(bad_type(format!(
        "subject is {given}: it must be a Solid, a Model, or a list or dict of solids or regions."
    )))
}

/// The scene of a model, of several solids, or of a solid as its only region.
pub fn scene(subject: &Bound<'_, PyAny>) -> PyResult<Scene> {
    let subject = gathered(subject)?;
    match subject.cast::<PyModel>() {
        Ok(model) => Ok(model.get().scene().clone()),
        Err(_) => Ok(scene_of(subject.cast::<PySolid>()?.get().solid())),
    }
}
