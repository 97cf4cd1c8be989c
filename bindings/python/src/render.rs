//! Pictures of solids and models as arrays.

use std::num::NonZeroUsize;
use std::sync::Arc;

use numpy::ndarray::{Array2, Array3};
use numpy::{Element, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayweave::device::{Device, DeviceEvaluator, DeviceOptions};
use rayweave::draw::technical::{TechnicalOptions, technical_drawing};
use rayweave::model::Program;
use rayweave::picture::{
    CutAway, Explosion, Opacity, Picture, PictureOptions, PictureSheet, SheetKind, WholeModel,
};
use rayweave::render::{PixelGrid, Size, Style, View};
use rayweave::{AnyEvaluator, Compiled, Message};

use crate::camera::camera_of;
use crate::device::{device_argument, warn};
use crate::drawing::{Subject, draw, notebook_png, released};
use crate::engine::{Engine, thread_argument};
use crate::error::bad_value;
use crate::model::PyModel;
use crate::solid::PySolid;
use crate::subject::{gathered, scene};

/// The keyword arguments of `rayweave.render`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RenderArguments<'py> {
    size: Option<(u32, u32)>,
    view: Option<String>,
    field_of_view: Option<f64>,
    camera: Option<Bound<'py, PyAny>>,
    shading: Option<String>,
    edges: Option<bool>,
    shadows: Option<bool>,
    samples: Option<u32>,
    evaluator: Option<String>,
    threads: Option<Bound<'py, PyAny>>,
    device: String,
    cut: Option<String>,
    explode: Option<String>,
    /// Names of regions or media, or none for all, with opacities.
    opacity: Vec<(Option<String>, f64)>,
}

impl RenderArguments<'_> {
    /// The subject with the requested changes, compiled again if there are any.
    fn subject(&self, object: &Bound<'_, PyAny>) -> PyResult<(Subject, Option<DeviceEvaluator>)> {
        let is_whole = self.opacity.is_empty() && self.cut.is_none() && self.explode.is_none();
        let mut subject = if is_whole { subject_of(object)? } else { self.opened(object, true)? };
        if let Some(object) = &self.camera {
            subject.scene.camera = Some(camera_of(object)?);
        }
        let program = &subject.compiled.program;
        let device = self.on_device(object, program)?;
        if let Some(device) = &device {
            subject.evaluator = device.evaluator().clone();
        } else if let Some(name) = &self.evaluator {
            subject.evaluator = AnyEvaluator::new(Some(name), program.clone()).map_err(bad_value)?;
        }
        Ok((subject, device))
    }

    /// The evaluator on the device, if that is not the CPU: the one that the object keeps, if it has the same program.
    fn on_device(
        &self,
        object: &Bound<'_, PyAny>,
        program: &Arc<Program>,
    ) -> PyResult<Option<DeviceEvaluator>> {
        let (py, device) = (object.py(), device_argument(&self.device)?);
        let name = self.evaluator.as_deref();
        if device == Device::Cpu {
            return Ok(None);
        }
        let kept = |engine: &Engine| match Arc::ptr_eq(&engine.program, program) {
            true => engine.on_device(py, device, name).cloned().map(Some),
            false => Ok(None),
        };
        let found = match (object.cast::<PyModel>(), object.cast::<PySolid>()) {
            (Ok(model), _) => kept(model.get().engine(py)?)?,
            (_, Ok(solid)) => kept(solid.get().engine(py)?)?,
            _ => None,
        };
        if found.is_some() {
            return Ok(found);
        }
        let options = DeviceOptions { device, adapter: None };
        let made = py.detach(|| DeviceEvaluator::new(options, name, program.clone())).map_err(bad_value)?;
        warn(py, made.notice())?;
        Ok(Some(made))
    }

    /// The subject without the cut, if there is one, for the views of a sheet that do not look onto it.
    fn whole(
        &self,
        object: &Bound<'_, PyAny>,
    ) -> PyResult<Option<(CutAway, AnyEvaluator, Option<DeviceEvaluator>)>> {
        let Some(cut) = &self.cut else { return Ok(None) };
        let cut = cut.parse().map_err(bad_value)?;
        let Subject { compiled, evaluator, .. } = self.opened(object, false)?;
        let device = self.on_device(object, &compiled.program)?;
        let evaluator = match (&device, &self.evaluator) {
            (Some(device), _) => device.evaluator().clone(),
            (None, Some(name)) => AnyEvaluator::new(Some(name), compiled.program).map_err(bad_value)?,
            (None, None) => evaluator,
        };
        Ok(Some((cut, evaluator, device)))
    }

    fn opened(&self, object: &Bound<'_, PyAny>, is_cut: bool) -> PyResult<Subject> {
        let mut scene = scene(object)?;
        let open = || {
            for (name, opacity) in &self.opacity {
                Opacity::new(name.as_deref(), *opacity)?.apply(&mut scene)?;
            }
            scene = scene.seen();
            if let Some(cut) = self.cut.as_ref().filter(|_| is_cut) {
                scene = cut.parse::<CutAway>()?.apply(&scene)?;
            }
            if let Some(explode) = &self.explode {
                scene = explode.parse::<Explosion>()?.apply(&scene)?;
            }
            Subject::of_scene(scene)
        };
        open().map_err(bad_value)
    }

    fn options(&self) -> PyResult<PictureOptions> {
        let size = self.size.map(|(width, height)| Size::new(width, height));
        Ok(PictureOptions {
            size: size.transpose().map_err(bad_value)?,
            view: self.view.as_deref().map(view_of).transpose()?,
            field_of_view: self.field_of_view,
            style: self.shading.as_deref().map(style).transpose()?,
            edges: self.edges,
            shadows: self.shadows,
            samples: self.samples,
        })
    }

    fn threads(&self) -> PyResult<Option<NonZeroUsize>> {
        self.threads.as_ref().map(thread_argument).transpose()
    }
}

fn style(name: &str) -> PyResult<Style> {
    match name {
        "gooch" => Ok(Style::Gooch),
        "headlight" => Ok(Style::Headlight),
        "flat" => Ok(Style::Flat),
        _ => Err(bad_value(format!("shading is '{name}': it must be 'gooch', 'headlight' or 'flat'."))),
    }
}

/// A picture of a solid or a model: see `rayweave.render`.
#[pyfunction]
#[pyo3(name = "render", signature = (subject: "Subject", kind, arguments) -> "NDArray[Any]")]
pub fn render_array<'py>(
    subject: &Bound<'py, PyAny>,
    kind: &str,
    arguments: RenderArguments<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = subject.py();
    let (subject, device) = arguments.subject(subject)?;
    let kind = kind.parse().map_err(bad_value)?;
    let picture = draw(py, &subject, kind, &arguments.options()?, arguments.threads()?)?;
    finish(py, device.as_ref())?;
    to_array(py, picture)
}

/// A sheet with pictures of a solid or a model and a legend, as SVG: see `rayweave.sheet`.
#[pyfunction]
#[pyo3(signature = (subject: "Subject", title, is_one, arguments))]
pub fn sheet_svg(
    subject: &Bound<'_, PyAny>,
    title: &str,
    is_one: bool,
    arguments: RenderArguments<'_>,
) -> PyResult<String> {
    let py = subject.py();
    let whole = if is_one { None } else { arguments.whole(subject)? };
    let (Subject { scene, compiled, evaluator }, device) = &arguments.subject(subject)?;
    let kind = if is_one { SheetKind::One } else { SheetKind::Views };
    let options = arguments.options()?;
    let text = released(py, arguments.threads()?, |run| {
        let sheet = match &whole {
            Some((cut, whole, _)) => {
                let whole = WholeModel { cut, evaluator: whole };
                PictureSheet::draw_cut(kind, scene, compiled, evaluator, whole, &options, run)?
            }
            None => PictureSheet::draw(kind, scene, compiled, evaluator, &options, run)?,
        };
        Ok(sheet.to_svg(title))
    })?;
    finish(py, device.as_ref())?;
    finish(py, whole.as_ref().and_then(|(_, _, device)| device.as_ref()))?;
    Ok(text)
}

/// A technical drawing of a solid or a model as SVG, with remarks: see `rayweave.sheet`.
#[pyfunction]
#[pyo3(signature = (subject: "Subject", title, size, projection, evaluator, threads: "int | None"))]
pub fn technical_svg(
    subject: &Bound<'_, PyAny>,
    title: &str,
    size: Option<(u32, u32)>,
    projection: &str,
    evaluator: Option<&str>,
    threads: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, Vec<String>)> {
    let py = subject.py();
    let scene = scene(subject)?.seen();
    let projection = projection
        .parse()
        .map_err(|()| bad_value(format!("projection is '{projection}': it can be third or first.")))?;
    let size = size.map(|(width, height)| Size::new(width, height)).transpose().map_err(bad_value)?;
    let options = TechnicalOptions { size, projection };
    let threads = threads.map(thread_argument).transpose()?;
    let drawn = released(py, threads, |run| {
        let compiled = Compiled::new(&scene)?;
        let evaluator = AnyEvaluator::new(evaluator, compiled.program)?;
        Ok(technical_drawing(&evaluator, title, scene.unit, &options, run)?)
    })?;
    Ok((drawn.svg, drawn.notes))
}

/// Checks after drawing that the device has answered all queries.
fn finish(py: Python<'_>, device: Option<&DeviceEvaluator>) -> PyResult<()> {
    let Some(device) = device else { return Ok(()) };
    warn(py, device.finish().map_err(bad_value)?.as_deref())
}

fn to_array(py: Python<'_>, picture: Picture) -> PyResult<Bound<'_, PyAny>> {
    match picture {
        Picture::Colour(image) => with_channels(py, image),
        Picture::Normal(plane) => with_channels(py, plane),
        Picture::Depth(plane) => plain(py, plane),
        Picture::Id(plane) => plain(py, plane),
    }
}

fn plain<T: Element>(py: Python<'_>, plane: PixelGrid<T>) -> PyResult<Bound<'_, PyAny>> {
    let shape = (plane.height(), plane.width());
    let array = Array2::from_shape_vec(shape, plane.into_values()).map_err(bad_value)?;
    Ok(PyArray2::from_owned_array(py, array).into_any())
}

fn with_channels<T: Element, const N: usize>(
    py: Python<'_>,
    plane: PixelGrid<[T; N]>,
) -> PyResult<Bound<'_, PyAny>> {
    let shape = (plane.height(), plane.width(), N);
    let array = Array3::from_shape_vec(shape, plane.into_values().into_flattened()).map_err(bad_value)?;
    Ok(PyArray3::from_owned_array(py, array).into_any())
}

/// A picture as a PNG file for notebooks.
#[pyfunction]
#[pyo3(name = "notebook_png", signature = (subject: "Subject"))]
pub fn notebook_picture<'py>(subject: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyBytes>> {
    notebook_png(subject.py(), &subject_of(subject)?)
}

/// The solid or model to draw.
fn subject_of(object: &Bound<'_, PyAny>) -> PyResult<Subject> {
    let py = object.py();
    let object = gathered(object)?;
    if let Ok(model) = object.cast::<PyModel>() {
        return Subject::of_model(model.get().scene(), model.get().compiled(py)?);
    }
    let solid = object.cast::<PySolid>()?.get();
    Ok(Subject::of_solid(solid.solid(), solid.engine(py)?))
}

/// The view of a name.
pub fn view_of(name: &str) -> PyResult<View> {
    name.parse().map_err(|error| {
        let near = Message::unknown("view", name, View::ALL.iter().map(|view| view.name()));
        let hint = near.suggestion().map_or(String::new(), |near| format!(" {near}"));
        bad_value(format!("{error}{hint}"))
    })
}
