//! Subjects of pictures, and rendering without the GIL.

use std::num::NonZeroUsize;

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use rayweave::model::Solid;
use rayweave::model::drive::Cancel;
use rayweave::picture::{Picture, PictureKind, PictureOptions, arrange};
use rayweave::render::{Run, Size};
use rayweave::scene::Scene;
use rayweave::{AnyEvaluator, Compiled};

use crate::engine::Engine;
use crate::error::bad_value;
use crate::interrupt::interruptible;
use crate::solid_scene::{compiled_of, scene_of};

/// The size of pictures in notebooks.
const NOTEBOOK: (u32, u32) = (480, 360);

/// A scene with its program and an evaluator.
pub struct Subject {
    pub scene: Scene,
    pub compiled: Compiled,
    pub evaluator: AnyEvaluator,
}

impl Subject {
    /// The subject of a compiled model; compiled again without its invisible regions, if it has
    /// any.
    pub fn of_model(whole: &Scene, (compiled, engine): &(Compiled, Engine)) -> PyResult<Subject> {
        let scene = whole.clone().seen();
        if scene.regions.len() < whole.regions.len() {
            return Subject::of_scene(scene).map_err(bad_value);
        }
        Ok(Subject { scene, compiled: compiled.clone(), evaluator: engine.evaluator().clone() })
    }

    /// The subject of a compiled solid.
    pub fn of_solid(solid: &Solid, engine: &Engine) -> Subject {
        let (scene, compiled) = (scene_of(solid), compiled_of(engine.program.clone()));
        Subject { scene, compiled, evaluator: engine.evaluator().clone() }
    }

    /// The subject of a scene, which is compiled.
    pub fn of_scene(scene: Scene) -> Result<Subject, rayweave::Error> {
        let compiled = Compiled::new(&scene)?;
        let evaluator = AnyEvaluator::new(None, compiled.program.clone())?;
        Ok(Subject { scene, compiled, evaluator })
    }
}

/// Renders without the GIL; Ctrl-C cancels.
pub fn released<T: Send>(
    py: Python<'_>,
    threads: Option<NonZeroUsize>,
    draw: impl FnOnce(&mut Run<'_>) -> Result<T, rayweave::Error> + Send,
) -> PyResult<T> {
    let cancel = Cancel::new();
    interruptible(py, &cancel, || draw(&mut Run { threads, cancel: cancel.clone(), progress: None }))
}

/// A picture of a subject.
pub fn draw(
    py: Python<'_>,
    subject: &Subject,
    kind: PictureKind,
    options: &PictureOptions,
    threads: Option<NonZeroUsize>,
) -> PyResult<Picture> {
    let (camera, settings) = arrange(&subject.scene, &subject.compiled, options).map_err(bad_value)?;
    released(py, threads, |run| Ok(Picture::draw(kind, &subject.evaluator, &camera, &settings, run)?))
}

/// A picture of a subject as a PNG file for notebooks.
pub fn notebook_png<'py>(py: Python<'py>, subject: &Subject) -> PyResult<Bound<'py, PyBytes>> {
    let size = Size::new(NOTEBOOK.0, NOTEBOOK.1).map_err(bad_value)?;
    let options = PictureOptions { size: Some(size), ..PictureOptions::default() };
    let picture = draw(py, subject, PictureKind::Colour, &options, None)?;
    Ok(PyBytes::new(py, &py.detach(|| picture.to_png())))
}

/// The method `render` of solids and models: `rayweave.render` of the object.
pub fn render_method<'py>(
    subject: &Bound<'py, PyAny>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    subject.py().import("rayweave._picture")?.getattr("render")?.call((subject,), options)
}
