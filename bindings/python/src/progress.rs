//! Reports of the progress of long computations to Python.

use std::fmt::Display;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use rayweave::model::drive::Cancel;

use crate::interrupt::interruptible;

/// The minimum time between two reports.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

/// Calls a Python function with the finished work and the total.
pub struct Progress {
    function: Option<Py<PyAny>>,
    total: u64,
    last: Instant,
    /// Stops the work if the function raises an exception.
    cancel: Cancel,
    raised: Option<PyErr>,
}

impl Progress {
    /// Calls the function, if the last call was long enough ago.
    pub fn report(&mut self, done: u64, total: u64) {
        self.total = total;
        if self.last.elapsed() >= REPORT_INTERVAL && self.raised.is_none() && done < total {
            self.last = Instant::now();
            self.call(done);
        }
    }

    /// Sets the total for the call at the end.
    pub fn total(&mut self, total: u64) {
        self.total = total;
    }

    fn call(&mut self, done: u64) {
        let Some(function) = &self.function else { return };
        if let Err(error) = Python::attach(|py| function.call1(py, (done, self.total)).map(|_| ())) {
            self.raised = Some(error);
            self.cancel.cancel();
        }
    }
}

/// Like [`interruptible`], with a Python function that is called during the work and once at its end, with the total twice. An exception
/// of the function cancels the work and is raised.
pub fn watched<T: Send, X: Display + Send>(
    py: Python<'_>,
    cancel: &Cancel,
    function: Option<Py<PyAny>>,
    work: impl FnOnce(&mut Progress) -> Result<T, X> + Send,
) -> PyResult<T> {
    let mut progress =
        Progress { function, total: 0, last: Instant::now(), cancel: cancel.clone(), raised: None };
    let result = interruptible(py, cancel, || work(&mut progress));
    if result.is_ok() && progress.raised.is_none() {
        progress.call(progress.total);
    }
    match progress.raised {
        Some(error) => Err(error),
        None => result,
    }
}

/// The function to call for an argument `progress`: a function, or whether to draw a bar.
pub fn callback(py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Py<PyAny>>> {
    let Some(progress) = progress else { return Ok(None) };
    let function = py.import("rayweave._progress")?.getattr("callback")?.call1((progress,))?;
    Ok((!function.is_none()).then(|| function.unbind()))
}
