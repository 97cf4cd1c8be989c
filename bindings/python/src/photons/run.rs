//! Runs of photons: results, progress and interrupts.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::photon::{End, Histories, PhotonError, PhotonRun, RemarkTerms, is_dark};

use crate::error::bad_value;
use crate::photons::histories::PyHistories;
use crate::photons::hits::PyPhotonHits;
use crate::photons::parts::DetectorParts;

/// The minimum time between two reports of progress.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

/// The result of a run: see `rayweave.photons.Run`.
#[pyclass(frozen, module = "rayweave.photons", name = "PhotonRun")]
pub struct PyPhotonRun {
    photons: u64,
    steps: u64,
    seconds: f64,
    ends: BTreeMap<End, u64>,
    hits: Py<PyPhotonHits>,
    histories: Option<Py<PyHistories>>,
}

impl PyPhotonRun {
    pub fn new(
        mut run: PhotonRun,
        mut histories: Option<Histories>,
        duration: Duration,
        detector: Arc<DetectorParts>,
    ) -> PyResult<PyPhotonRun> {
        run.hits.number_by(&detector.detector);
        let flags = histories.as_mut().map(|histories| std::mem::take(&mut histories.hit_flags));
        Python::attach(|py| {
            let own = detector.clone();
            let histories = histories.map(|histories| Py::new(py, PyHistories::new(histories, own)));
            Ok(PyPhotonRun {
                photons: run.photons,
                steps: run.steps,
                seconds: duration.as_secs_f64(),
                ends: run.ends,
                hits: Py::new(py, PyPhotonHits { hits: run.hits, flags, detector })?,
                histories: histories.transpose()?,
            })
        })
    }
}

#[pymethods]
impl PyPhotonRun {
    /// The number of photons, with those that wavelength shifters emitted in addition.
    #[getter]
    fn photons(&self) -> u64 {
        self.photons
    }

    /// The number of steps of all photons.
    #[getter]
    fn steps(&self) -> u64 {
        self.steps
    }

    /// The duration of the run in seconds.
    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The number of photons by way of ending.
    #[getter]
    #[cfg_attr(false, stub("() -> dict[str, int]"))]
    fn ends<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = PyDict::new(py);
        End::ALL.iter().try_for_each(|end| table.set_item(end.name(), self.ends.get(end).unwrap_or(&0)))?;
        Ok(table)
    }

    /// Whether the run has many photons and no hit.
    #[getter]
    fn is_dark(&self) -> bool {
        is_dark(&self.ends)
    }

    /// Remarks about the run: with a number of probable mistakes in the detector, that about a run without hits; and that about
    /// photons stopped by the limit of steps, also if they are `few`.
    #[pyo3(signature = (mistakes = None, *, few = true))]
    fn notes(&self, mistakes: Option<usize>, few: bool) -> Vec<String> {
        let terms = RemarkTerms {
            check: "`check()` of the detector",
            findings: "",
            counts: "record=\"counts\"",
            max_steps: "max_steps",
        };
        let dark = mistakes.map(|mistakes| terms.no_hits(&self.ends, mistakes));
        let stopped = if few { terms.stopped(&self.ends) } else { terms.mostly_stopped(&self.ends) };
        dark.into_iter().chain(stopped).collect()
    }

    /// The detected photons.
    #[getter]
    fn hits(&self, py: Python<'_>) -> Py<PyPhotonHits> {
        self.hits.clone_ref(py)
    }

    /// The recorded histories, if there are any.
    #[getter]
    fn histories(&self, py: Python<'_>) -> Option<Py<PyHistories>> {
        self.histories.as_ref().map(|histories| histories.clone_ref(py))
    }
}

/// The reason why a run ends early.
pub enum Halt {
    /// The run itself failed or was cancelled.
    Refused(PhotonError),
    /// Python raised an exception.
    Raised(PyErr),
}

impl From<PhotonError> for Halt {
    fn from(error: PhotonError) -> Halt {
        Halt::Refused(error)
    }
}

impl From<PyErr> for Halt {
    fn from(error: PyErr) -> Halt {
        Halt::Raised(error)
    }
}

impl Halt {
    /// The exception.
    pub fn into_error(self) -> PyErr {
        match self {
            Halt::Refused(PhotonError::Cancelled) => PyKeyboardInterrupt::new_err("cancelled"),
            Halt::Refused(error) => bad_value(error),
            Halt::Raised(error) => error,
        }
    }
}

/// Reports the progress of a run to Python.
pub struct PhotonWatch {
    progress: Option<Py<PyAny>>,
    start: u64,
    total: u64,
    last: Instant,
}

impl PhotonWatch {
    /// The watch of a run of some photons. `progress` is called with the number of finished photons and the total.
    pub fn new(photons: &Range<u64>, progress: Option<Py<PyAny>>) -> PhotonWatch {
        let total = photons.end.saturating_sub(photons.start);
        PhotonWatch { progress, start: photons.start, total, last: Instant::now() }
    }

    /// Reports that the photons before a number are done, if the last report is old enough.
    pub fn check(&mut self, end: u64) -> Result<(), Halt> {
        if self.progress.is_none() || self.last.elapsed() < REPORT_INTERVAL {
            return Ok(());
        }
        self.last = Instant::now();
        self.report(end - self.start)
    }

    /// Reports the end of the run.
    pub fn end(&self) -> Result<(), Halt> {
        self.report(self.total)
    }

    fn report(&self, done: u64) -> Result<(), Halt> {
        let Some(progress) = &self.progress else { return Ok(()) };
        Python::attach(|py| progress.call1(py, (done, self.total))).map(|_| ()).map_err(Halt::Raised)
    }
}
