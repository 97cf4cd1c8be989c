//! A compiled solid or model, and the way from its questions to its answers: threads, signals, evaluators.

use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::time::{Duration, Instant};

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;
use rayweave::model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave::model::{Crossing, Evaluator, LeafKind, Program, RegionId, Window};
use rayweave::{AnyEvaluator, AnyScratch, Compiled};

use crate::error::{bad_type, bad_value};

/// The least that a thread takes at a time: enough to make the bookkeeping cheap.
const LEAST: usize = 1024;

/// The most: Ctrl-C is noticed, and work shared out, between them.
const MOST: usize = 8192;

/// The pieces that each thread gets of a long question, so that none waits long for the last.
const PIECES: usize = 8;

/// Rays or points that are answered at a time: few enough for the nearest cache.
pub const BLOCK: usize = 512;

/// Longest delay of Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(50);

/// Something compiled, with what every question about it needs.
pub struct Engine {
    /// The program.
    pub program: Arc<Program>,
    /// The names of the media by their numbers; none for a solid alone.
    pub media: Option<Arc<[String]>>,
    evaluator: AnyEvaluator,
    /// Every region is of another medium than the world.
    is_plain: bool,
    leaves: PyOnceLock<Py<PyArray1<i32>>>,
    surface_names: PyOnceLock<Py<PyTuple>>,
    medium_names: PyOnceLock<Py<PyTuple>>,
    region_names: PyOnceLock<Py<PyTuple>>,
    /// The rows that the hits of a short question needed last: a guess for the next one.
    pub rows: AtomicUsize,
}

impl Engine {
    /// Evaluator of a solid.
    pub fn of_solid(program: Program) -> PyResult<Self> {
        Engine::new(Arc::new(program), None)
    }

    /// Evaluator of a model.
    pub fn of_model(compiled: &Compiled) -> PyResult<Self> {
        Engine::new(compiled.program.clone(), Some(compiled.media.clone()))
    }

    fn new(program: Arc<Program>, media: Option<Arc<[String]>>) -> PyResult<Self> {
        Ok(Engine {
            evaluator: AnyEvaluator::new(None, program.clone()).map_err(bad_value)?,
            is_plain: program.regions().iter().all(|region| region.medium != 0),
            program,
            media,
            leaves: PyOnceLock::new(),
            surface_names: PyOnceLock::new(),
            medium_names: PyOnceLock::new(),
            region_names: PyOnceLock::new(),
            rows: AtomicUsize::new(2),
        })
    }

    /// The evaluator for daily use.
    pub fn evaluator(&self) -> &AnyEvaluator {
        &self.evaluator
    }

    /// The evaluator that is to answer a question.
    pub fn chosen(&self, py: Python<'_>, how: &How) -> PyResult<Cow<'_, AnyEvaluator>> {
        let Some(name) = &how.evaluator else { return Ok(Cow::Borrowed(&self.evaluator)) };
        let made = py.detach(|| AnyEvaluator::new(Some(name), self.program.clone()));
        Ok(Cow::Owned(made.map_err(bad_value)?))
    }

    /// Whether every region is of another medium than the world.
    pub fn is_plain(&self) -> bool {
        self.is_plain
    }

    /// Whether solids are placed in it, so that a face is in more than one place.
    pub fn has_placements(&self) -> bool {
        self.program.prototypes().iter().any(|group| group.placements > 1)
    }

    /// Whether each region is of another medium than the world.
    pub fn put_inside(&self, regions: &[u32], flags: &mut [bool]) {
        let pairs = flags.iter_mut().zip(regions);
        match self.is_plain {
            true => pairs.for_each(|(flag, &region)| *flag = region != 0),
            false => pairs.for_each(|(flag, &region)| *flag = inside(&self.program, RegionId(region))),
        }
    }

    /// The leaves that the faces belong to, by the numbers of the faces, and -1 for face -1 at the end.
    pub fn leaves<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        let leaves = || {
            let mut leaves = vec![-1; self.program.facets().len() + 1];
            for leaf in self.program.leaves() {
                if let LeafKind::Shape { facets } = leaf.kind() {
                    leaves[facets.start as usize..facets.end as usize].fill(leaf.id().0 as i32);
                }
            }
            PyArray1::from_vec(py, leaves).unbind()
        };
        self.leaves.get_or_init(py, leaves).bind(py).clone()
    }

    /// The names of all faces, by their numbers.
    pub fn surface_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names =
            || Ok::<_, PyErr>(PyTuple::new(py, self.program.face_names().collect::<Vec<_>>())?.unbind());
        Ok(self.surface_names.get_or_try_init(py, names)?.bind(py).clone())
    }

    /// The names of the media by their numbers.
    pub fn medium_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = || {
            let names: Vec<_> = self.media.iter().flat_map(|media| media.iter()).collect();
            Ok::<_, PyErr>(PyTuple::new(py, names)?.unbind())
        };
        Ok(self.medium_names.get_or_try_init(py, names)?.bind(py).clone())
    }

    /// The names of the regions by their numbers; number 0 is the world.
    pub fn region_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = || {
            let regions = self.program.regions().iter().map(|region| region.name.as_str());
            let names: Vec<_> = std::iter::once("world").chain(regions).collect();
            Ok::<_, PyErr>(PyTuple::new(py, names)?.unbind())
        };
        Ok(self.region_names.get_or_try_init(py, names)?.bind(py).clone())
    }
}

/// Options of any query.
pub struct How {
    /// The time window.
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
            return Err(bad_value(format!("evaluator is '{other}': it must be one of {names}.")));
        }
        let evaluator = evaluator.filter(|&name| name != AnyEvaluator::NAMES[0]).map(str::to_owned);
        Ok(How { window, evaluator, threads: threads.map(thread_argument).transpose()? })
    }
}

/// A number of threads.
pub fn thread_argument(threads: &Bound<'_, PyAny>) -> PyResult<NonZeroUsize> {
    let number: i64 = threads
        .extract()
        .map_err(|_| bad_type(format!("threads is {}: a whole number is needed.", threads.get_type())))?;
    usize::try_from(number)
        .ok()
        .and_then(NonZeroUsize::new)
        .ok_or_else(|| bad_value(format!("threads is {number}: it must be at least 1.")))
}

/// Division of rays or points into chunks for threads.
#[derive(Clone, Copy)]
pub struct Cut {
    /// The number of them.
    pub len: usize,
    /// Chunk size, at least 1.
    pub chunk: usize,
    threads: NonZeroUsize,
}

impl Cut {
    /// The chunks by the numbers of their first and last.
    pub fn ranges(self) -> impl Iterator<Item = Range<usize>> + Send {
        (0..self.len).step_by(self.chunk).map(move |start| start..self.len.min(start + self.chunk))
    }
}

impl Cut {
    /// All in one.
    pub fn whole(len: usize) -> Self {
        Cut { len, chunk: len.max(1), threads: NonZeroUsize::MIN }
    }

    /// As many chunks as are worth the bookkeeping.
    pub fn small(self) -> Self {
        Cut { chunk: LEAST, ..self }
    }

    /// The number of chunks.
    pub fn chunks(self) -> usize {
        self.len.div_ceil(self.chunk)
    }
}

impl How {
    /// Division of `count` rays or points into chunks.
    pub fn cut(&self, len: usize) -> Cut {
        // looking up the number of threads takes longer than many a question
        if len <= LEAST {
            return Cut { len, chunk: LEAST, threads: NonZeroUsize::MIN };
        }
        let threads = thread_count(self.threads);
        let chunk = (len / (threads.get() * PIECES)).clamp(LEAST, MOST).next_multiple_of(BLOCK);
        Cut {
            len,
            chunk,
            threads: NonZeroUsize::new(len.div_ceil(chunk)).map_or(threads, |n| threads.min(n)),
        }
    }
}

/// A thread that answers a question.
pub struct Worker<'e, S> {
    /// Evaluator.
    pub evaluator: &'e AnyEvaluator,
    /// The evaluator's own memory.
    pub memory: AnyScratch,
    /// Additional state of the query.
    pub scratch: S,
}

/// Asks a question chunk by chunk with the interpreter released; `merge` takes the answers in order. `work` answers one chunk,
/// or `None` if a ray or point in it cannot be used: then the answer here is false.
pub fn ask<C: Send, A: Send, S: Default>(
    py: Python<'_>,
    evaluator: &AnyEvaluator,
    cut: Cut,
    chunks: impl Iterator<Item = C> + Send,
    work: impl Fn(&mut Worker<'_, S>, C) -> Option<A> + Send + Sync,
    mut merge: impl FnMut(A) -> PyResult<()> + Send,
) -> PyResult<bool> {
    let worker = || Worker { evaluator, memory: evaluator.scratch(), scratch: S::default() };
    let merge = |answer: Option<A>| Ok(merge(answer.ok_or(Halt::Refused)?)?);
    py.detach(|| run(cut.threads, chunks, worker, work, merge))
}

/// Works on chunks that cannot be refused, with the interpreter released.
pub fn share<C: Send>(
    py: Python<'_>,
    cut: Cut,
    chunks: impl Iterator<Item = C> + Send,
    work: impl Fn(C) + Send + Sync,
) -> PyResult<()> {
    py.detach(|| run(cut.threads, chunks, || (), |(), chunk| work(chunk), |()| Ok(())))?;
    Ok(())
}

/// Why work ends before its end.
enum Halt {
    /// A ray or point cannot be used.
    Refused,
    /// An exception for Python.
    Raised(PyErr),
}

impl From<PyErr> for Halt {
    fn from(error: PyErr) -> Halt {
        Halt::Raised(error)
    }
}

/// Processes items by index, `step` at a time, on several threads; `merge` receives the results in order. To be called
/// with the interpreter released; Ctrl-C is noticed between chunks.
pub fn in_chunks<A: Send, M>(
    len: usize,
    chunk: usize,
    asked: Option<NonZeroUsize>,
    memory: impl Fn() -> M + Sync,
    work: impl Fn(&mut M, Range<usize>) -> A + Sync,
    mut merge: impl FnMut(A) -> PyResult<()>,
) -> PyResult<()> {
    let threads = NonZeroUsize::new(len.div_ceil(chunk)).unwrap_or(NonZeroUsize::MIN);
    let threads = if threads.get() > 1 { thread_count(asked).min(threads) } else { threads };
    run(threads, Cut { len, chunk, threads }.ranges(), memory, work, |answer| Ok(merge(answer)?))?;
    Ok(())
}

/// Works on chunks on several threads; false if one was refused. Ctrl-C is noticed between chunks.
fn run<C: Send, A: Send, M>(
    threads: NonZeroUsize,
    chunks: impl Iterator<Item = C> + Send,
    memory: impl Fn() -> M + Sync,
    work: impl Fn(&mut M, C) -> A + Sync,
    mut merge: impl FnMut(A) -> Result<(), Halt>,
) -> PyResult<bool> {
    let mut looked = Instant::now();
    let result = drive(threads, &Cancel::new(), chunks, memory, work, |answer| {
        merge(answer)?;
        if looked.elapsed() < PATIENCE {
            return Ok(());
        }
        looked = Instant::now();
        Ok(Python::attach(|py| py.check_signals())?)
    });
    match result {
        Ok(()) => Ok(true),
        Err(Stopped::Failed(Halt::Refused)) => Ok(false),
        Err(Stopped::Failed(Halt::Raised(error))) => Err(error),
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
