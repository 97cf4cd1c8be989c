//! A compiled solid or model, and the way from its questions to its answers: threads, signals, evaluators.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;
use rayweave::model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave::model::{Crossing, Evaluator, Program, RegionId, Window};
use rayweave::trace::Weave;
use rayweave::{AnyEvaluator, Compiled};

use crate::error::{bad_type, bad_value};

/// Rays or points that a thread takes at a time: enough to make the bookkeeping cheap, few enough for the cache.
const CHUNK: usize = 1024;

/// How long Ctrl-C may go unnoticed.
const PATIENCE: Duration = Duration::from_millis(50);

/// Something compiled, with what every question about it needs.
pub struct Engine {
    /// The program.
    pub program: Arc<Program>,
    /// The names of the media by their numbers; none for a solid alone.
    pub media: Option<Arc<[String]>>,
    weave: Weave,
    surface_names: PyOnceLock<Py<PyTuple>>,
}

impl Engine {
    /// What answers questions about a solid.
    pub fn of_solid(program: Program) -> Self {
        Engine::new(Arc::new(program), None)
    }

    /// What answers questions about a model.
    pub fn of_model(compiled: &Compiled) -> Self {
        Engine::new(compiled.program.clone(), Some(compiled.media.clone()))
    }

    fn new(program: Arc<Program>, media: Option<Arc<[String]>>) -> Self {
        Engine { weave: Weave::new(program.clone()), program, media, surface_names: PyOnceLock::new() }
    }

    /// The evaluator for daily use.
    pub fn weave(&self) -> &Weave {
        &self.weave
    }

    /// The names of all faces, by their numbers.
    pub fn surface_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = || {
            Ok::<_, PyErr>(PyTuple::new(py, self.program.facets().iter().map(|facet| &*facet.name))?.unbind())
        };
        Ok(self.surface_names.get_or_try_init(py, names)?.bind(py).clone())
    }
}

/// How a question is to be answered, whatever it is.
pub struct How {
    /// The part of the rays that is asked about.
    pub window: Window,
    /// None for the one for daily use, which is kept ready.
    evaluator: Option<String>,
    threads: Option<NonZeroUsize>,
}

impl How {
    /// From the arguments that all questions share.
    pub fn new(
        t_min: f64,
        t_max: f64,
        evaluator: Option<&str>,
        threads: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let window = Window::new(t_min, t_max)
            .map_err(|error| bad_value(format!("t_min = {t_min}, t_max = {t_max}: {error}")))?;
        if let Some(other) = evaluator.filter(|name| !AnyEvaluator::NAMES.contains(name)) {
            let names = AnyEvaluator::NAMES.map(|name| format!("'{name}'")).join(", ");
            return Err(bad_value(format!("evaluator is '{other}' (it must be one of {names})")));
        }
        let evaluator = evaluator.filter(|&name| name != AnyEvaluator::NAMES[0]).map(str::to_owned);
        Ok(How { window, evaluator, threads: threads.map(thread_argument).transpose()? })
    }
}

/// A number of threads.
pub fn thread_argument(threads: &Bound<'_, PyAny>) -> PyResult<NonZeroUsize> {
    let number: i64 = threads
        .extract()
        .map_err(|_| bad_type(format!("threads is {} (a whole number is needed)", threads.get_type())))?;
    usize::try_from(number)
        .ok()
        .and_then(NonZeroUsize::new)
        .ok_or_else(|| bad_value(format!("threads is {number} (it must be at least 1)")))
}

/// A question that is asked chunk by chunk, of any evaluator.
pub trait Question: Sync {
    /// The answer to one chunk.
    type Answer: Send;
    /// What a thread keeps between chunks, beside the evaluator's own memory.
    type Scratch: Default;

    /// The number of rays or points.
    fn len(&self) -> usize;

    /// The answer for a part of them.
    fn answer<E: Evaluator>(
        &self,
        evaluator: &E,
        chunk: Range<usize>,
        memory: &mut E::Scratch,
        scratch: &mut Self::Scratch,
    ) -> Self::Answer;
}

impl Engine {
    /// Asks a question with the interpreter released; `merge` takes the answers in order.
    pub fn ask<Q: Question>(
        &self,
        py: Python<'_>,
        how: &How,
        question: &Q,
        merge: impl FnMut(Q::Answer) + Send,
    ) -> PyResult<()> {
        py.detach(|| match &how.evaluator {
            None => ask(&self.weave, how, question, merge),
            Some(name) => {
                let evaluator = AnyEvaluator::new(Some(name), self.program.clone()).map_err(bad_value)?;
                ask(&evaluator, how, question, merge)
            }
        })
    }
}

fn ask<Q: Question, E: Evaluator>(
    evaluator: &E,
    how: &How,
    question: &Q,
    mut merge: impl FnMut(Q::Answer),
) -> PyResult<()> {
    in_chunks(
        question.len(),
        CHUNK,
        how.threads,
        || (evaluator.scratch(), Q::Scratch::default()),
        |(memory, scratch), chunk| question.answer(evaluator, chunk, memory, scratch),
        |answer| {
            merge(answer);
            Ok(())
        },
    )
}

/// Works on things by their numbers, so many at a time, on several threads; `merge` takes the results in order. To be called
/// with the interpreter released; Ctrl-C is noticed between chunks.
pub fn in_chunks<A: Send, M>(
    len: usize,
    chunk: usize,
    threads: Option<NonZeroUsize>,
    memory: impl Fn() -> M + Sync,
    work: impl Fn(&mut M, Range<usize>) -> A + Sync,
    mut merge: impl FnMut(A) -> PyResult<()>,
) -> PyResult<()> {
    let chunks = (0..len).step_by(chunk).map(|start| start..len.min(start + chunk));
    // looking up the number of cores takes longer than many a question
    let threads = match NonZeroUsize::new(len.div_ceil(chunk)) {
        Some(many) if many.get() > 1 => thread_count(threads).min(many),
        _ => NonZeroUsize::MIN,
    };
    let mut looked = Instant::now();
    let result = drive(threads, &Cancel::new(), chunks, memory, work, |answer| {
        merge(answer)?;
        if looked.elapsed() < PATIENCE {
            return Ok(());
        }
        looked = Instant::now();
        Python::attach(|py| py.check_signals())
    });
    match result {
        Ok(()) => Ok(()),
        Err(Stopped::Failed(error)) => Err(error),
        Err(Stopped::Cancelled) => Err(pyo3::exceptions::PyKeyboardInterrupt::new_err("cancelled")),
    }
}

/// Whether a region is made of anything but the medium of the world.
pub fn inside(program: &Program, region: RegionId) -> bool {
    program.medium_of(region) != 0
}

/// The number of the face that a crossing belongs to.
pub fn surface(program: &Program, crossing: &Crossing) -> i32 {
    program.face_number(crossing.face.leaf, crossing.face.facet) as i32
}
