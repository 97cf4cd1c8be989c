//! Long computations that Ctrl-C cancels.

use std::fmt::Display;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use rayweave::model::drive::{Cancel, aside};

use crate::error::bad_value;

/// Interval between checks for signals.
const LOOK: Duration = Duration::from_millis(50);

/// Runs work on a separate thread, without the GIL, and cancels it when Python has a pending
/// signal.
pub fn interruptible<T: Send, X: Display + Send>(
    py: Python<'_>,
    cancel: &Cancel,
    work: impl FnOnce() -> Result<T, X> + Send,
) -> PyResult<T> {
    py.detach(|| {
        thread::scope(|scope| {
            let (done, ended) = channel();
            let worker = scope.spawn(move || {
                let result = cancel.while_current(work);
                // fails if a signal came first, because the receiver has been dropped
                let _ = done.send(());
                result
            });
            let mut interrupt = None;
            while interrupt.is_none() && ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                interrupt = Python::attach(|py| py.check_signals()).err();
            }
            if interrupt.is_some() {
                cancel.cancel();
            }
            let result = worker.join();
            match (interrupt, result) {
                (Some(error), _) => Err(error),
                (None, Ok(result)) => result.map_err(bad_value),
                (None, Err(panic)) => std::panic::resume_unwind(panic),
            }
        })
    })
}

/// Runs work that cannot be cancelled at every point, such as reading a file, without the GIL. A pending signal is raised at once: the
/// thread of the work ends as soon as it checks its token (`Cancel::current`), and its result is dropped.
pub fn abandonable<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    py.detach(|| aside(work, || Python::attach(|py| py.check_signals())))
}
