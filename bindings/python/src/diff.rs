//! Differences of two models, as columns.

use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use rayweave::diff::{
    DiffProgress, DiffReport, DiffSettings, Difference, Match, diff_section, diff_with_progress,
};
use rayweave::measure::{MeasureProgress, MeasureSettings};
use rayweave::model::drive::Cancel;
use rayweave::{AnalysisError, AnyEvaluator};

use crate::engine::thread_argument;
use crate::error::bad_value;
use crate::progress::watched;
use crate::section::PySection;
use crate::subject::{bounds, scene};

/// The number of values of a pair: three volumes with their half widths, the thickness and the ends
/// of a segment of a ray, the corners of the place.
const NUMBERS: usize = 19;

/// Those of a place: volume, centre, corners.
const PLACE_NUMBERS: usize = 10;

/// Names; whether the pair is the same, proved, in A, in B, and the spot in A; numbers; whether all is the same, the unit, the
/// distance, the number of rays; the picture; of each place its pair, whether it is in A, and its volume, centre and corners.
type Columns<'py> = (
    Vec<String>,
    [Bound<'py, PyArray1<bool>>; 5],
    Bound<'py, PyArray2<f64>>,
    (bool, &'static str, f64, u64),
    PySection,
    Places<'py>,
);

type Places<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>, Bound<'py, PyArray2<f64>>);

/// Common and different parts of two models: see `rayweave.diff`.
#[pyfunction]
#[pyo3(signature = (
    a: "Subject", b: "Subject", by, distance, cells, precision, confidence, most_rays: "int | None",
    within: "Sequence[Sequence[float]] | None", seed, threads: "int | None",
    progress: "Callable[[int, int], object] | None" = None
))]
#[expect(clippy::too_many_arguments, reason = "those of the function in Python")]
pub fn diff_columns<'py>(
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    by: Option<&str>,
    distance: Option<f64>,
    cells: u32,
    precision: f64,
    confidence: f64,
    most_rays: Option<u64>,
    within: Option<[[f64; 3]; 2]>,
    seed: u64,
    threads: Option<&Bound<'py, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Columns<'py>> {
    let py = a.py();
    let (first, second) = (scene(a)?, scene(b)?);
    let by = match by {
        None => Match::Auto,
        Some("region") => Match::Region,
        Some("medium") => Match::Medium,
        Some("whole") => Match::Whole,
        Some(other) => return Err(bad_value(format!("by is '{other}': it can be region, medium or whole."))),
    };
    let cancel = Cancel::new();
    let settings = DiffSettings {
        by,
        distance,
        across: cells,
        measure: MeasureSettings {
            precision,
            confidence,
            within: within.map(bounds),
            seed,
            threads: threads.map(thread_argument).transpose()?,
            cancel: cancel.clone(),
            ..DiffSettings::default().measure
        }
        .with_most_rays(most_rays),
    };
    let (report, section) = watched(py, &cancel, progress, |watch| {
        let mut tell = |now: DiffProgress| {
            let part = MeasureProgress { rays: now.rays, precision: now.precision }.part_done(precision);
            watch.report((1000.0 * (now.done as f64 + part) / now.pairs.max(1) as f64) as u64, 1000);
        };
        let make = AnyEvaluator::maker(None);
        let report = diff_with_progress(&first, &second, make, &settings, &mut tell)?;
        let section = diff_section(&first, &second, &report, AnyEvaluator::maker(None), &settings, None)?;
        Ok::<_, AnalysisError>((report, section))
    })?;
    columns(py, &report, PySection::new(section, report.unit.symbol()))
}

fn columns<'py>(py: Python<'py>, report: &DiffReport, section: PySection) -> PyResult<Columns<'py>> {
    let pairs = &report.pairs;
    let truths = |of: fn(&Difference) -> bool| PyArray1::from_iter(py, pairs.iter().map(of));
    let numbers = Array2::from_shape_vec((pairs.len(), NUMBERS), pairs.iter().flat_map(numbers).collect());
    Ok((
        pairs.iter().map(|pair| pair.name.clone()).collect(),
        [
            truths(|pair| pair.is_same),
            truths(|pair| pair.is_proved),
            truths(|pair| pair.is_in[0]),
            truths(|pair| pair.is_in[1]),
            truths(|pair| pair.spot.is_some_and(|spot| spot.is_a)),
        ],
        PyArray2::from_owned_array(py, numbers.map_err(bad_value)?),
        (report.is_same(), report.unit.symbol(), report.distance, report.rays),
        section,
        places(py, pairs)?,
    ))
}

/// The pair of each place, whether it is in A, and its volume, centre and corners.
fn places<'py>(py: Python<'py>, pairs: &[Difference]) -> PyResult<Places<'py>> {
    let all = || (0..).zip(pairs).flat_map(|(k, pair)| pair.places.iter().map(move |place| (k, place)));
    let numbers = all().flat_map(|(_, place)| {
        let points = [place.centre, place.bounds.lo, place.bounds.hi];
        std::iter::once(place.volume).chain(points.into_iter().flat_map(|point| point.to_array()))
    });
    let table = Array2::from_shape_vec((all().count(), PLACE_NUMBERS), numbers.collect());
    Ok((
        PyArray1::from_iter(py, all().map(|(k, _)| k)),
        PyArray1::from_iter(py, all().map(|(_, place)| place.is_a)),
        PyArray2::from_owned_array(py, table.map_err(bad_value)?),
    ))
}

fn numbers(pair: &Difference) -> [f64; NUMBERS] {
    let mut all = [f64::NAN; NUMBERS];
    for (k, volume) in [pair.both, pair.a_only, pair.b_only].into_iter().enumerate() {
        (all[k], all[3 + k]) = (volume.value, volume.half_width);
    }
    all[6] = pair.spot.map_or(0.0, |spot| spot.thickness);
    if let Some(spot) = pair.spot {
        all[7..10].copy_from_slice(&spot.chord.from.to_array());
        all[10..13].copy_from_slice(&spot.chord.to.to_array());
    }
    if let Some(place) = pair.place {
        all[13..16].copy_from_slice(&place.lo.to_array());
        all[16..19].copy_from_slice(&place.hi.to_array());
    }
    all
}
