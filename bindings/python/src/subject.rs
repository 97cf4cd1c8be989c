//! Subjects of queries: a solid or a model as a scene, and boxes by their corners.

use pyo3::prelude::*;
use rayweave::scene::Scene;
use rayweave::{Bounds, Vec3};

use crate::error::bad_type;
use crate::model::PyModel;
use crate::solid::PySolid;
use crate::solid_scene::scene_of;

/// A box by its corners.
pub fn bounds([lo, hi]: [[f64; 3]; 2]) -> Bounds {
    Bounds { lo: Vec3::from(lo), hi: Vec3::from(hi) }
}

/// The scene of a model, or that of a solid as its only region.
pub fn scene(subject: &Bound<'_, PyAny>) -> PyResult<Scene> {
    if let Ok(model) = subject.cast::<PyModel>() {
        return Ok(model.get().scene().clone());
    }
    match subject.cast::<PySolid>() {
        Ok(solid) => Ok(scene_of(solid.get().solid())),
        Err(_) => Err(bad_type(format!("subject is {}: it must be a Solid or a Model.", subject.get_type()))),
    }
}
