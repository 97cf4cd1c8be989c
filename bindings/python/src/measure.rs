//! Volumes, centres, inertia and areas of regions, as columns.

use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use rayweave::measure::{
    Estimate, MeasureProgress, MeasureSettings, RegionReport, SceneReport, measure_scene_with_progress,
};
use rayweave::model::drive::Cancel;
use rayweave::{AnalysisError, AnyEvaluator};

use crate::engine::thread_argument;
use crate::error::bad_value;
use crate::progress::watched;
use crate::subject::{bounds, scene};

/// Names of regions and media; numbers of rays and whether the precision is reached; the numbers of each region with their
/// half widths, row by row: volume, area, mass, volume by formula, centre (3), inertia (9); the lower and upper corners of the boxes.
type Columns<'py> = (
    Vec<String>,
    Vec<String>,
    (Bound<'py, PyArray1<u64>>, Bound<'py, PyArray1<bool>>),
    [Bound<'py, PyArray2<f64>>; 2],
    Bound<'py, PyArray2<f64>>,
);

/// The number of values of a region.
const NUMBERS: usize = 16;

/// Volume, area, mass and moments of the regions of a solid or a model: see `rayweave.measure`.
#[pyfunction]
#[pyo3(signature = (
    subject: "Subject", precision, confidence, most_rays: "int | None",
    within: "Sequence[Sequence[float]] | None", seed, evaluator, threads: "int | None",
    progress: "Callable[[int, int], object] | None" = None
))]
#[expect(clippy::too_many_arguments, reason = "those of the function in Python")]
pub fn measure_columns<'py>(
    subject: &Bound<'py, PyAny>,
    precision: f64,
    confidence: f64,
    most_rays: Option<u64>,
    within: Option<[[f64; 3]; 2]>,
    seed: u64,
    evaluator: Option<&str>,
    threads: Option<&Bound<'py, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Columns<'py>> {
    let py = subject.py();
    let scene = scene(subject)?;
    let cancel = Cancel::new();
    let settings = MeasureSettings {
        precision,
        confidence,
        within: within.map(bounds),
        seed,
        threads: threads.map(thread_argument).transpose()?,
        cancel: cancel.clone(),
        ..MeasureSettings::default()
    }
    .with_most_rays(most_rays);
    let report = watched(py, &cancel, progress, |watch| {
        let mut tell = |now: MeasureProgress| {
            let part = now.part_done(precision);
            // there is no estimate before the first round
            if part > 0.0 {
                watch.report(now.rays, (now.rays as f64 / part) as u64);
            }
        };
        let make = AnyEvaluator::maker(evaluator);
        let report = measure_scene_with_progress(&scene, None, make, &settings, &mut tell)?;
        watch.total(report.rays);
        Ok::<_, AnalysisError>(report)
    })?;
    columns(py, &report)
}

fn columns<'py>(py: Python<'py>, report: &SceneReport) -> PyResult<Columns<'py>> {
    let regions = &report.regions;
    let all: Vec<[Estimate; NUMBERS]> = regions.iter().map(numbers).collect();
    let table = |of: fn(&Estimate) -> f64| {
        let values = all.iter().flatten().map(of).collect();
        let table = Array2::from_shape_vec((all.len(), NUMBERS), values).map_err(bad_value)?;
        Ok::<_, PyErr>(PyArray2::from_owned_array(py, table))
    };
    let corners = regions.iter().flat_map(|region| match region.bounds {
        Some(own) => [own.lo.to_array(), own.hi.to_array()].concat(),
        None => vec![f64::NAN; 6],
    });
    let corners: Vec<f64> = corners.collect();
    Ok((
        regions.iter().map(|region| region.measured.name.clone()).collect(),
        regions.iter().map(|region| region.medium.clone()).collect(),
        (
            PyArray1::from_iter(py, regions.iter().map(|region| region.measured.rays)),
            PyArray1::from_iter(py, regions.iter().map(|region| region.measured.is_reached)),
        ),
        [table(|estimate| estimate.value)?, table(|estimate| estimate.half_width)?],
        PyArray2::from_owned_array(py, Array2::from_shape_vec((all.len(), 6), corners).map_err(bad_value)?),
    ))
}

fn numbers(region: &RegionReport) -> [Estimate; NUMBERS] {
    const UNKNOWN: Estimate = Estimate { value: f64::NAN, half_width: f64::NAN };
    let measured = &region.measured;
    let mut all = [UNKNOWN; NUMBERS];
    (all[0], all[1]) = (measured.volume, measured.area);
    all[2] = region.mass.unwrap_or(UNKNOWN);
    all[3] = region.exact_volume.map_or(UNKNOWN, |value| Estimate { value, half_width: 0.0 });
    all[4..7].copy_from_slice(&measured.centre.unwrap_or([UNKNOWN; 3]));
    all[7..].copy_from_slice(measured.inertia.as_flattened());
    all
}
