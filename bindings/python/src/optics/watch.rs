//! Progress and interrupts of traces.

use std::time::{Duration, Instant};

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rayweave::optics::{Emitter, OpticsError, Segments};

use crate::error::bad_value;

/// Reports the progress of a run to Python, and checks for signals.
pub struct Watch {
    progress: Option<Py<PyAny>>,
    total: usize,
    last: Instant,
}

/// The minimum time between two reports.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

impl Watch {
    /// Creates the watch of a run. `progress` is called with the number of finished rays and the
    /// total.
    pub fn new(light: &impl Emitter, progress: Option<Py<PyAny>>) -> Watch {
        Watch { progress, total: light.count(), last: Instant::now() }
    }

    /// Checks for signals after a chunk, and reports the progress if the last report is old enough.
    pub fn check(&mut self, part: &Segments) -> PyResult<()> {
        let done = part.id.iter().max().map_or(0, |&last| last + 1);
        Python::attach(|py| {
            py.check_signals()?;
            match &self.progress {
                Some(progress) if self.last.elapsed() >= REPORT_INTERVAL => {
                    self.last = Instant::now();
                    progress.call1(py, (done, self.total)).map(|_| ())
                }
                _ => Ok(()),
            }
        })
    }

    /// Reports the end of the run.
    pub fn end(&self) -> PyResult<()> {
        let Some(progress) = &self.progress else { return Ok(()) };
        Python::attach(|py| progress.call1(py, (self.total, self.total)).map(|_| ()))
    }
}

/// The reason why a run ends early.
pub enum Halt {
    /// The trace itself failed or was cancelled.
    Refused(OpticsError),
    /// Python raised an exception.
    Raised(PyErr),
}

impl From<OpticsError> for Halt {
    fn from(error: OpticsError) -> Halt {
        Halt::Refused(error)
    }
}

impl Halt {
    /// The exception.
    pub fn into_error(self) -> PyErr {
        match self {
            Halt::Refused(OpticsError::Cancelled) => PyKeyboardInterrupt::new_err("cancelled"),
            Halt::Refused(error) => bad_value(error),
            Halt::Raised(error) => error,
        }
    }
}
