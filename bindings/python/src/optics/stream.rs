//! Light traced in the background, batch by batch in bounded memory.

use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread;
use std::time::Duration;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::Packets;
use rayweave::model::drive::Cancel;
use rayweave::model::memory::Growth;
use rayweave::optics::source::Sources;
use rayweave::optics::{Balance, OpticsError, Phases, Segments, System, TraceSettings, Tracer};

use crate::error::bad_value;
use crate::optics::segments::{accounts, columns};

/// The interval at which a waiting reader checks for signals.
const LOOK: Duration = Duration::from_millis(50);

/// The interval at which a thread checks whether another one has taken its table.
const TURN: Duration = Duration::from_millis(1);

/// The maximum number of chunks, of a few thousand rays each, that wait for the reader.
const WAITING: usize = 8;

enum Message {
    Part(Box<Segments>),
    End(Result<Balance, OpticsError>),
}

/// The segments of a run as an iterator of tables: see `rayweave.optics.Stream`.
#[pyclass(frozen, module = "rayweave.optics", name = "SegmentStream")]
pub struct PyStream {
    /// Held by the thread that takes a table: tables consist of consecutive rows, whichever thread takes them.
    turn: Mutex<()>,
    messages: Mutex<Receiver<Message>>,
    cancel: Cancel,
    system: Arc<System>,
    batch: Batch,
    /// The number of rays of all sources.
    total: usize,
    state: Mutex<State>,
}

/// Contents of a table.
#[derive(Clone, Copy)]
pub struct Batch {
    /// The minimum number of rows, except for the last table.
    pub rows: usize,
    /// Whether it has columns of phases.
    pub phases: bool,
}

#[derive(Default)]
struct State {
    /// The number of rows that have been returned.
    before: i64,
    /// The number of rays that have been traced.
    rays: u64,
    /// Whether the run is over, stopped or failed.
    ended: bool,
    balance: Option<Balance>,
}

impl PyStream {
    /// Starts the run on threads of its own.
    pub fn start(system: Arc<System>, light: Sources, settings: TraceSettings, batch: Batch) -> PyStream {
        let traced = system.clone();
        let (cancel, total) = (settings.cancel.clone(), light.count() as usize);
        let (sender, messages) = sync_channel(WAITING);
        // not joined: it ends when the receiver is dropped
        thread::spawn(move || {
            let tracer = Tracer::new(&traced, Packets::new);
            let ended = tracer.run(&light, &settings, |part| {
                sender.send(Message::Part(Box::new(part))).map_err(|_| OpticsError::Cancelled)
            });
            // the receiver may have been dropped
            let _ = sender.send(Message::End(ended));
        });
        PyStream {
            turn: Mutex::default(),
            messages: Mutex::new(messages),
            cancel,
            system,
            batch,
            total,
            state: Mutex::default(),
        }
    }

    /// Waits until no other thread is taking a table.
    fn turn(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, ()>> {
        loop {
            match self.turn.try_lock() {
                Ok(turn) => return Ok(turn),
                Err(TryLockError::Poisoned(poisoned)) => return Ok(poisoned.into_inner()),
                Err(TryLockError::WouldBlock) => py.detach(|| thread::sleep(TURN)),
            }
            py.check_signals().inspect_err(|_| self.cancel.cancel())?;
        }
    }

    /// The next message; `None` if Python has to check its signals first.
    fn receive(&self) -> Option<Message> {
        let messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        match messages.recv_timeout(LOOK) {
            Ok(message) => Some(message),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(Message::End(Err(OpticsError::Cancelled))),
        }
    }

    /// The rows of the next table; empty at the end.
    fn gather(&self, py: Python<'_>) -> PyResult<Segments> {
        let (mut gathered, mut growth) = (Segments::default(), Growth::default());
        while gathered.len() < self.batch.rows {
            match py.detach(|| self.receive()) {
                None => {}
                Some(Message::Part(part)) => {
                    growth
                        .check((gathered.len() + part.len()) as u64 * Segments::ROW)
                        .map_err(|shortage| OpticsError::Memory { rays: self.total, shortage })
                        .inspect_err(|_| self.cancel.cancel())
                        .map_err(bad_value)?;
                    gathered.append(&part);
                }
                Some(Message::End(ended)) => {
                    self.state().ended = true;
                    match ended {
                        Ok(balance) => self.state().balance = Some(balance),
                        // a stream that was closed has no further rows, in any thread
                        Err(OpticsError::Cancelled) => return Ok(Segments::default()),
                        Err(error) => return Err(bad_value(error)),
                    }
                    break;
                }
            }
            py.check_signals().inspect_err(|_| self.cancel.cancel())?;
        }
        Ok(gathered)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyStream {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    /// The next table, whose parents are rows of the whole run.
    #[cfg_attr(false, stub("() -> dict[str, NDArray[Any]]"))]
    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let _turn = self.turn(py)?;
        if self.state().ended || self.cancel.is_cancelled() {
            return Ok(None);
        }
        let mut segments = self.gather(py)?;
        if segments.is_empty() {
            return Ok(None);
        }
        // whole rays, whose rows count from 0 so far
        let phases = self.batch.phases;
        let phases = py.detach(|| phases.then(|| Tracer::new(&self.system, Packets::new).phases(&segments)));
        {
            let mut state = self.state();
            let before = state.before;
            segments.parent.iter_mut().filter(|parent| **parent >= 0).for_each(|parent| *parent += before);
            state.before += segments.len() as i64;
            state.rays = segments.id.last().map_or(state.rays, |&last| last as u64 + 1);
        }
        let table = columns(py, segments)?;
        if let Some(Phases { s, p }) = phases {
            table.set_item("phase_s", PyArray1::from_vec(py, s))?;
            table.set_item("phase_p", PyArray1::from_vec(py, p))?;
        }
        Ok(Some(table))
    }

    /// Stops the run: there are no further tables.
    fn cancel(&self) {
        self.cancel.cancel();
    }

    /// The approximate number of rays traced so far.
    #[getter]
    fn rays(&self) -> u64 {
        self.state().rays
    }

    /// The balance of power, available once the run is over.
    #[getter]
    #[cfg_attr(false, stub("() -> dict[str, Any] | None"))]
    fn balance<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let balance = self.state().balance.clone();
        balance.map(|balance| accounts(py, &balance)).transpose()
    }
}

impl Drop for PyStream {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}
