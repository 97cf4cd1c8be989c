//! Runs: the photons of a source, batch by batch, on several threads.

use crate::batch::Batch;
use crate::detector::Detector;
use crate::error::PhotonError;
use crate::history::{HistoryOptions, HistoryRecorder, Recorder};
use crate::hits::Hits;
use crate::run::{PhotonPart, PhotonRun};
use crate::settings::RunSettings;
use crate::source::Source;
use rayweave_model::Evaluator;
use rayweave_model::drive::{Stopped, drive, thread_count};
use rayweave_model::memory::{Growth, Shortage};
use std::ops::Range;

/// The number of photons that advance together.
pub(crate) const BATCH: u64 = 4096;

/// Simulates photons of a source with an evaluator of the program of the detector.
///
/// The result is a function of the detector, the source, the seed, the limits and the photon numbers: it does not
/// depend on the number of threads.
///
/// # Errors
///
/// [`PhotonError::Setting`] for invalid photons and limits, [`PhotonError::Memory`], [`PhotonError::Cancelled`].
pub fn simulate<E: Evaluator>(
    detector: &Detector,
    evaluator: &E,
    source: &Source,
    settings: &RunSettings,
) -> Result<PhotonRun, PhotonError> {
    let (mut total, mut growth) = (PhotonRun::default(), Growth::default());
    simulate_parts(detector, evaluator, source, settings, None, |part| -> Result<(), PhotonError> {
        total.append(part.run);
        Ok(growth.check(total.hits.len() as u64 * Hits::ROW)?)
    })?;
    Ok(total)
}

/// Like [`simulate`], but passes the result to `merge` in parts of a few thousand photons, in the order of their numbers:
/// memory does not grow with the number of photons. Records histories if there are options for them; recording does not
/// change the photons.
///
/// # Errors
///
/// Those of [`simulate`], and those of `merge`, which end the run.
pub fn simulate_parts<E: Evaluator, X: From<PhotonError>>(
    detector: &Detector,
    evaluator: &E,
    source: &Source,
    settings: &RunSettings,
    histories: Option<HistoryOptions>,
    merge: impl FnMut(PhotonPart) -> Result<(), X>,
) -> Result<(), X> {
    match histories {
        None => run_batches(detector, evaluator, source, settings, &(), merge),
        Some(options) => {
            run_batches(detector, evaluator, source, settings, &HistoryRecorder::new(options, source), merge)
        }
    }
}

fn run_batches<E: Evaluator, R: Recorder, X: From<PhotonError>>(
    detector: &Detector,
    evaluator: &E,
    source: &Source,
    settings: &RunSettings,
    recorder: &R,
    mut merge: impl FnMut(PhotonPart) -> Result<(), X>,
) -> Result<(), X> {
    check(source, settings)?;
    let Range { start, end } = settings.photons;
    // an empty range gives one empty part: its columns are those of other parts
    let chunks = (0..(end.saturating_sub(start)).div_ceil(BATCH).max(1))
        .map(|k| start + k * BATCH..(start + (k + 1) * BATCH).min(end.max(start)));
    let work = |batch: &mut Batch<'_, E, R>, numbers: Range<u64>| -> Result<PhotonPart, Shortage> {
        let run = batch.run(source, numbers.clone())?;
        Ok(PhotonPart { photons: numbers, run, histories: batch.recorder.take() })
    };
    drive(
        thread_count(settings.threads),
        &settings.cancel,
        chunks,
        || Batch::new(detector, evaluator, settings, recorder.clone()),
        work,
        |part| merge(part.map_err(PhotonError::from)?),
    )
    .map_err(|stopped| match stopped {
        Stopped::Cancelled => PhotonError::Cancelled.into(),
        Stopped::Failed(error) => error,
    })
}

/// Checks the source and the settings of a run.
pub(crate) fn check(source: &Source, settings: &RunSettings) -> Result<(), PhotonError> {
    source.check()?;
    source.check_range(&settings.photons)?;
    if settings.max_time.is_nan() || settings.max_time <= 0.0 {
        let problem = format!("the maximum time is {} ns", settings.max_time);
        return Err(PhotonError::setting(problem, "it must be positive"));
    }
    Ok(())
}
