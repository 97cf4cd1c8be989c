//! Path lengths through media, for each pixel.

use numpy::ndarray::{Array2, Array3};
use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;
use rayweave::model::drive::Cancel;
use rayweave::picture::{PictureOptions, arrange};
use rayweave::render::{Projection, RenderOptions, Size};
use rayweave::thickness::{ThicknessMap, ThicknessRun, check_attenuations, transmitted};
use rayweave::{AnyEvaluator, Compiled, Error};

use crate::camera::camera_of;
use crate::engine::thread_argument;
use crate::error::bad_value;
use crate::interrupt::interruptible;
use crate::render::view_of;
use crate::subject::scene;

/// Names of media; their attenuations; lengths (H, W, M); the radiograph and the line integrals of the attenuation (H, W); the
/// symbol of the length unit; the size of a pixel at parallel rays; remarks about the media.
type Maps<'py> = (
    Vec<String>,
    Vec<f64>,
    Bound<'py, PyArray3<f64>>,
    [Bound<'py, PyArray2<f64>>; 2],
    &'static str,
    Option<f64>,
    Vec<String>,
);

/// Path lengths of rays through each medium: see `rayweave.thickness`.
#[pyfunction]
#[pyo3(signature = (subject: "Subject", view, camera: "Camera | None", size, by, evaluator, threads: "int | None"))]
pub fn thickness_maps<'py>(
    subject: &Bound<'py, PyAny>,
    view: Option<&str>,
    camera: Option<&Bound<'py, PyAny>>,
    size: Option<(u32, u32)>,
    by: &str,
    evaluator: Option<&str>,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Maps<'py>> {
    let by_region = match by {
        "medium" => false,
        "region" => true,
        other => return Err(bad_value(format!("by is '{other}': it can be medium or region."))),
    };
    let py = subject.py();
    let mut scene = scene(subject)?;
    if let Some(object) = camera {
        scene.camera = Some(camera_of(object)?);
    }
    let remarks = check_attenuations(&scene).map_err(bad_value)?;
    let options = PictureOptions {
        size: size.map(|(width, height)| Size::new(width, height)).transpose().map_err(bad_value)?,
        view: view.map(view_of).transpose()?,
        ..PictureOptions::default()
    };
    let cancel = Cancel::new();
    let threads = threads.map(thread_argument).transpose()?;
    let (map, pixel) = interruptible(py, &cancel, || {
        let compiled = if by_region { Compiled::by_region(&scene)? } else { Compiled::new(&scene)? };
        let evaluator = AnyEvaluator::new(evaluator, compiled.program.clone())?;
        let mut run = ThicknessRun { threads, cancel: cancel.clone(), ..ThicknessRun::default() };
        let (camera, RenderOptions { size, .. }) = arrange(&scene, &compiled, &options)?;
        let ray = |x: usize, y: usize| camera.ray(size, x as f64 + 0.5, y as f64 + 0.5);
        let size = [size.width(), size.height()];
        let pixel = match camera.projection() {
            Projection::Orthographic { height } => Some(height / size[1] as f64),
            Projection::Perspective { .. } => None,
        };
        let map = ThicknessMap::new(&compiled, &evaluator, size, ray, &mut run)?;
        Ok::<_, Error>((if by_region { map.of_regions(&scene) } else { map }, pixel))
    })?;
    let ([width, height], media) = (map.size(), map.media().len());
    let lengths = Array3::from_shape_vec((height, width, media), map.path_lengths().values().to_vec());
    let picture = |values: Vec<f64>| {
        let array = Array2::from_shape_vec((height, width), values).map_err(bad_value)?;
        Ok::<_, PyErr>(PyArray2::from_owned_array(py, array))
    };
    let integrals = map.line_integrals(&scene);
    let radiograph = integrals.iter().copied().map(transmitted).collect();
    Ok((
        map.media().to_vec(),
        map.attenuations(&scene),
        PyArray3::from_owned_array(py, lengths.map_err(bad_value)?),
        [picture(radiograph)?, picture(integrals)?],
        scene.unit.symbol(),
        pixel,
        remarks,
    ))
}
