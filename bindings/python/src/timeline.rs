//! Timelines of rays as SVG.

use pyo3::prelude::*;
use rayweave::draw::{Timeline, ray_timeline};
use rayweave::scene::Scene;
use rayweave::shape::Ray;
use rayweave::{Compiled, Weave};

use crate::error::bad_value;
use crate::model::PyModel;
use crate::rootray::PyRootRay;
use crate::solid::PySolid;
use crate::solid_scene::{compiled_of, scene_of};
use crate::subject::gathered;
use crate::vectors::{direction, vector};

/// The rows of a drawing, each with its name.
type Rows<'py> = Vec<(String, PyRef<'py, PyRootRay>)>;

/// Root-rays drawn over time, as SVG: see `rayweave.timeline`.
#[pyfunction]
#[pyo3(signature = (operands, results, title, window, count))]
pub fn timeline_svg(
    operands: Rows<'_>,
    results: Rows<'_>,
    title: &str,
    window: Option<(f64, f64)>,
    count: bool,
) -> PyResult<String> {
    let mut timeline = Timeline::new();
    timeline.title(title);
    for (name, ray) in &operands {
        timeline.operand(name, ray.root_ray());
    }
    for (name, ray) in &results {
        timeline.result(name, ray.root_ray());
    }
    if !count {
        timeline.without_count();
    }
    draw(timeline, window)
}

fn draw(mut timeline: Timeline, window: Option<(f64, f64)>) -> PyResult<String> {
    if let Some((t_min, t_max)) = window {
        timeline.window(t_min, t_max).map_err(bad_value)?;
    }
    Ok(timeline.to_svg())
}

/// Time line of one ray through a solid or a model, as SVG: see `rayweave.ray_timeline`.
#[pyfunction]
#[pyo3(signature = (subject: "Subject", origin: "ArrayLike", direction: "ArrayLike", title, window))]
pub fn ray_timeline_svg(
    subject: &Bound<'_, PyAny>,
    origin: &Bound<'_, PyAny>,
    direction: &Bound<'_, PyAny>,
    title: &str,
    window: Option<(f64, f64)>,
) -> PyResult<String> {
    let py = subject.py();
    let ray = Ray::new(vector(origin, "origin")?, self::direction(direction, "direction")?);
    let along = |scene: &Scene, compiled: &Compiled| {
        ray_timeline(scene, None, compiled, ray, Weave::new).map_err(bad_value)
    };
    let subject = gathered(subject)?;
    let mut timeline = match subject.cast::<PyModel>() {
        Ok(model) => along(model.get().scene(), &model.get().compiled(py)?.0),
        Err(_) => {
            let solid = subject.cast::<PySolid>()?.get();
            along(&scene_of(solid.solid()), &compiled_of(solid.engine(py)?.program.clone()))
        }
    }?;
    timeline.title(title);
    draw(timeline, window)
}
