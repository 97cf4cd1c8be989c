//! Path lengths through media, for each pixel.

use numpy::ndarray::{Array2, Array3};
use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;
use rayweave::model::drive::Cancel;
use rayweave::picture::{PictureOptions, arrange};
use rayweave::render::{RenderOptions, Size};
use rayweave::thickness::{ThicknessMap, ThicknessRun};
use rayweave::{AnyEvaluator, Compiled, Error};

use crate::engine::thread_argument;
use crate::error::bad_value;
use crate::interrupt::interruptible;
use crate::subject::scene;

/// Names of media; their attenuations; lengths (H, W, M); the radiograph (H, W); the symbol of the length unit.
type Maps<'py> = (Vec<String>, Vec<f64>, Bound<'py, PyArray3<f64>>, Bound<'py, PyArray2<f64>>, &'static str);

/// Path lengths of rays through each medium: see `rayweave.thickness`.
#[pyfunction]
#[pyo3(signature = (subject: "Subject", view, size, evaluator, threads: "int | None"))]
pub fn thickness_maps<'py>(
    subject: &Bound<'py, PyAny>,
    view: Option<&str>,
    size: Option<(u32, u32)>,
    evaluator: Option<&str>,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Maps<'py>> {
    let py = subject.py();
    let scene = scene(subject)?;
    let options = PictureOptions {
        size: size.map(|(width, height)| Size::new(width, height)).transpose().map_err(bad_value)?,
        view: view.map(str::parse).transpose().map_err(bad_value)?,
        ..PictureOptions::default()
    };
    let cancel = Cancel::new();
    let threads = threads.map(thread_argument).transpose()?;
    let map = interruptible(py, &cancel, || {
        let compiled = Compiled::new(&scene)?;
        let evaluator = AnyEvaluator::new(evaluator, compiled.program.clone())?;
        let mut run = ThicknessRun { threads, cancel: cancel.clone(), progress: None };
        let (camera, RenderOptions { size, .. }) = arrange(&scene, &compiled, &options)?;
        let ray = |x: usize, y: usize| camera.ray(size, x as f64 + 0.5, y as f64 + 0.5);
        let size = [size.width(), size.height()];
        Ok::<_, Error>(ThicknessMap::new(&compiled, &evaluator, size, ray, &mut run)?)
    })?;
    let ([width, height], media) = (map.size(), map.media().len());
    let lengths = Array3::from_shape_vec((height, width, media), map.path_lengths().values().to_vec());
    let radiograph = Array2::from_shape_vec((height, width), map.radiograph(&scene));
    Ok((
        map.media().to_vec(),
        map.attenuations(&scene),
        PyArray3::from_owned_array(py, lengths.map_err(bad_value)?),
        PyArray2::from_owned_array(py, radiograph.map_err(bad_value)?),
        scene.unit.symbol(),
    ))
}
