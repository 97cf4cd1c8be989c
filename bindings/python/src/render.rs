//! Pictures of solids and models as arrays.

use std::num::NonZeroUsize;
use std::sync::Arc;

use numpy::ndarray::{Array2, Array3};
use numpy::{Element, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayweave::math::Vec3;
use rayweave::model::drive::Cancel;
use rayweave::model::{Program, Solid};
use rayweave::picture::{Picture, PictureKind, Wishes, arrange};
use rayweave::render::{Plane, Run, Size, Style};
use rayweave::scene::{Camera, Colour, Medium, Projection, RenderSettings, Scene, SceneRegion, Unit};
use rayweave::{AnyEvaluator, Compiled};

use crate::engine::thread_argument;
use crate::error::{bad_type, bad_value};
use crate::model::PyModel;
use crate::solid::PySolid;
use crate::vectors::vector;

/// The size of pictures in notebooks.
const NOTEBOOK: (u32, u32) = (480, 360);

/// What is drawn.
struct Subject {
    scene: Scene,
    compiled: Compiled,
    evaluator: AnyEvaluator,
}

impl Subject {
    fn new(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = object.py();
        if let Ok(model) = object.cast::<PyModel>() {
            let (compiled, engine) = model.get().compiled(py)?;
            let (whole, scene) = (model.get().scene(), model.get().scene().clone().seen());
            if scene.regions.len() < whole.regions.len() {
                let compiled = Compiled::new(&scene).map_err(bad_value)?;
                let evaluator = AnyEvaluator::new(None, compiled.program.clone()).map_err(bad_value)?;
                return Ok(Subject { scene, compiled, evaluator });
            }
            return Ok(Subject { scene, compiled: compiled.clone(), evaluator: engine.evaluator().clone() });
        }
        let Ok(solid) = object.cast::<PySolid>() else {
            return Err(bad_type(format!("subject is {} (a Solid or a Model is needed)", object.get_type())));
        };
        let engine = solid.get().engine(py)?;
        Ok(Subject {
            scene: scene_of(solid.get().solid()),
            compiled: compiled_of(engine.program.clone()),
            evaluator: engine.evaluator().clone(),
        })
    }
}

/// A compiled solid as a model of one region.
pub fn compiled_of(program: Arc<Program>) -> Compiled {
    Compiled { program, media: ["world".to_owned(), "solid".to_owned()].into() }
}

/// The scene of one solid and nothing else.
pub fn scene_of(solid: &Solid) -> Scene {
    let name = "solid".to_owned();
    let medium = |name: &str| Medium { name: name.to_owned(), ..Medium::default() };
    let region =
        SceneRegion { name: name.clone(), solid: solid.clone(), medium: 1, colour: Colour::PALETTE[0] };
    Scene {
        unit: Unit::default(),
        parameters: Vec::new(),
        solids: vec![(name, solid.clone())],
        regions: vec![region],
        media: vec![medium("world"), medium("solid")],
        camera: None,
        lights: Vec::new(),
        render: RenderSettings::default(),
        warnings: Default::default(),
    }
}

/// A camera from the attributes of a `rayweave.Camera`.
fn camera(object: &Bound<'_, PyAny>) -> PyResult<Camera> {
    let number = |name: &str| object.getattr(name)?.extract::<Option<f64>>();
    let place = |name: &str| vector(&object.getattr(name)?, &format!("camera.{name}"));
    let projection = match (number("height")?, number("field_of_view")?) {
        (Some(height), _) => Projection::Orthographic { height },
        (None, degrees) => {
            Projection::Perspective { fov: degrees.unwrap_or(rayweave::picture::FIELD_OF_VIEW) }
        }
    };
    let (position, target, up): (Vec3, Vec3, Vec3) = (place("position")?, place("target")?, place("up")?);
    Ok(Camera { projection, position, target, up, size: None })
}

fn style(name: &str) -> PyResult<Style> {
    match name {
        "gooch" => Ok(Style::Gooch),
        "headlight" => Ok(Style::Headlight),
        "flat" => Ok(Style::Flat),
        _ => Err(bad_value(format!("shading is '{name}' (it must be 'gooch', 'headlight' or 'flat')"))),
    }
}

/// The picture with the interpreter released; Ctrl-C stops it.
fn draw(
    py: Python<'_>,
    subject: &Subject,
    evaluator: Option<&str>,
    kind: PictureKind,
    wishes: &Wishes,
    threads: Option<NonZeroUsize>,
) -> PyResult<Picture> {
    let (camera, settings) = arrange(&subject.scene, &subject.compiled, wishes).map_err(bad_value)?;
    let evaluator = match evaluator {
        None => subject.evaluator.clone(),
        name => AnyEvaluator::new(name, subject.compiled.program.clone()).map_err(bad_value)?,
    };
    let cancel = Cancel::new();
    let (token, mut interrupt) = (cancel.clone(), None);
    let drawn = py.detach(|| {
        let mut progress = |_| {
            if let Err(error) = Python::attach(|py| py.check_signals()) {
                interrupt = Some(error);
                token.cancel();
            }
        };
        let mut run = Run { threads, cancel, progress: Some(&mut progress) };
        Picture::draw(kind, &evaluator, &camera, &settings, &mut run)
    });
    match interrupt {
        Some(error) => Err(error),
        None => drawn.map_err(bad_value),
    }
}

/// A picture of a solid or a model: see `rayweave.render`.
#[pyfunction]
#[pyo3(name = "render", signature = (subject, *, kind, size, view, field_of_view, camera, shading, edges, shadows, samples, evaluator, threads))]
#[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
pub fn render_array<'py>(
    subject: &Bound<'py, PyAny>,
    kind: &str,
    size: Option<(u32, u32)>,
    view: Option<&str>,
    field_of_view: Option<f64>,
    camera: Option<&Bound<'py, PyAny>>,
    shading: Option<&str>,
    edges: Option<bool>,
    shadows: Option<bool>,
    samples: Option<u32>,
    evaluator: Option<&str>,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = subject.py();
    let mut subject = Subject::new(subject)?;
    if let Some(object) = camera {
        subject.scene.camera = Some(self::camera(object)?);
    }
    let wishes = Wishes {
        size: size.map(|(width, height)| Size::new(width, height)).transpose().map_err(bad_value)?,
        view: view.map(str::parse).transpose().map_err(bad_value)?,
        field_of_view,
        style: shading.map(style).transpose()?,
        edges,
        shadows,
        samples,
    };
    let kind = kind.parse().map_err(bad_value)?;
    let threads = threads.map(thread_argument).transpose()?;
    to_array(py, draw(py, &subject, evaluator, kind, &wishes, threads)?)
}

fn to_array(py: Python<'_>, picture: Picture) -> PyResult<Bound<'_, PyAny>> {
    match picture {
        Picture::Colour(image) => with_channels(py, image),
        Picture::Normal(plane) => with_channels(py, plane),
        Picture::Depth(plane) => plain(py, plane),
        Picture::Id(plane) => plain(py, plane),
    }
}

fn plain<T: Element>(py: Python<'_>, plane: Plane<T>) -> PyResult<Bound<'_, PyAny>> {
    let shape = (plane.height(), plane.width());
    let array = Array2::from_shape_vec(shape, plane.into_values()).map_err(bad_value)?;
    Ok(PyArray2::from_owned_array(py, array).into_any())
}

fn with_channels<T: Element, const N: usize>(
    py: Python<'_>,
    plane: Plane<[T; N]>,
) -> PyResult<Bound<'_, PyAny>> {
    let shape = (plane.height(), plane.width(), N);
    let array = Array3::from_shape_vec(shape, plane.into_values().into_flattened()).map_err(bad_value)?;
    Ok(PyArray3::from_owned_array(py, array).into_any())
}

/// A picture as a PNG file for notebooks.
#[pyfunction]
#[pyo3(signature = (subject))]
pub fn notebook_png<'py>(subject: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyBytes>> {
    let py = subject.py();
    let subject = Subject::new(subject)?;
    let size = Size::new(NOTEBOOK.0, NOTEBOOK.1).map_err(bad_value)?;
    let wishes = Wishes { size: Some(size), ..Wishes::default() };
    let picture = draw(py, &subject, None, PictureKind::Colour, &wishes, None)?;
    Ok(PyBytes::new(py, &py.detach(|| picture.to_png())))
}
