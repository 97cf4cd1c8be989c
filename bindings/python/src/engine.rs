//! Query engine of a compiled solid or model: evaluators, threads and interrupts.

use std::iter;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::atomic::AtomicUsize;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBool, PyInt, PyTuple};
use rayweave::device::{Device, DeviceEvaluator, DeviceOptions};
use rayweave::model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave::model::{Crossing, Evaluator, LeafKind, Medium, Program, RegionId, Window};
use rayweave::scene::{Scene, world_name};
use rayweave::{AnyEvaluator, AnyScratch, Compiled, Message};

use crate::device::{Chosen, device_argument, warn};
use crate::error::{bad_type, bad_value, shown};

/// The minimum number of rays per chunk: large enough to make the overhead negligible.
const MIN_CHUNK: usize = 1024;

/// The maximum number of rays per chunk: Ctrl-C is checked, and work is balanced, between chunks.
const MAX_CHUNK: usize = 8192;

/// The number of chunks per thread for large queries, so that threads finish at about the same
/// time.
const PIECES: usize = 8;

/// The number of rays or points that an evaluator processes at a time: few enough for the L1 cache.
pub const BLOCK: usize = 512;

/// The maximum delay of Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(50);

/// A compiled program with the shared state of all queries.
pub struct Engine {
    /// The program.
    pub program: Arc<Program>,
    /// The names of the media by number; `None` for a single solid.
    pub media: Option<Arc<[String]>>,
    /// The numbers of the media by region, the world first, if the program has a medium for each region instead.
    region_media: Option<Box<[Medium]>>,
    evaluator: AnyEvaluator,
    /// The evaluators of the devices `gpu` and `auto`, once they are used.
    devices: [OnceLock<DeviceEvaluator>; 2],
    /// True if no region has the medium of the world.
    is_plain: bool,
    leaves: PyOnceLock<Py<PyArray1<i32>>>,
    surface_names: PyOnceLock<Py<PyTuple>>,
    medium_names: PyOnceLock<Py<PyTuple>>,
    region_names: PyOnceLock<Py<PyTuple>>,
    /// The number of rows of hits of the last small query: an estimate for the next one.
    pub rows: AtomicUsize,
}

impl Engine {
    /// Creates the engine of a solid.
    pub fn of_solid(program: Program) -> PyResult<Self> {
        Engine::new(Arc::new(program), None, None)
    }

    /// Creates the engine of a model.
    pub fn of_model(compiled: &Compiled) -> PyResult<Self> {
        Engine::new(compiled.program.clone(), Some(compiled.media.clone()), None)
    }

    /// Creates the engine of a model that reports changes of region within a medium, too.
    pub fn by_region(scene: &Scene) -> PyResult<Self> {
        let compiled = Compiled::by_region(scene).map_err(bad_value)?;
        let names = scene.medium_names().into_iter().map(str::to_owned).collect();
        let media = iter::once(0).chain(scene.regions.iter().map(|region| region.medium)).collect();
        Engine::new(compiled.program, Some(names), Some(media))
    }

    fn new(
        program: Arc<Program>,
        media: Option<Arc<[String]>>,
        region_media: Option<Box<[Medium]>>,
    ) -> PyResult<Self> {
        let is_plain = match &region_media {
            Some(media) => media.iter().skip(1).all(|&medium| medium != 0),
            None => program.regions().iter().all(|region| region.medium != 0),
        };
        Ok(Engine {
            evaluator: AnyEvaluator::new(None, program.clone()).map_err(bad_value)?,
            region_media,
            is_plain,
            devices: Default::default(),
            program,
            media,
            leaves: PyOnceLock::new(),
            surface_names: PyOnceLock::new(),
            medium_names: PyOnceLock::new(),
            region_names: PyOnceLock::new(),
            rows: AtomicUsize::new(2),
        })
    }

    /// The default evaluator.
    pub fn evaluator(&self) -> &AnyEvaluator {
        &self.evaluator
    }

    /// The evaluator that the arguments select.
    pub fn chosen(&self, py: Python<'_>, options: &QueryOptions) -> PyResult<Chosen<'_>> {
        if options.device != Device::Cpu {
            return self.on_device(py, options.device, options.evaluator.as_deref()).map(Chosen::Device);
        }
        let Some(name) = &options.evaluator else { return Ok(Chosen::Kept(&self.evaluator)) };
        let made = py.detach(|| AnyEvaluator::new(Some(name), self.program.clone()));
        Ok(Chosen::Made(made.map_err(bad_value)?))
    }

    /// The evaluator on a device other than the CPU, compiled at its first use and kept. `evaluator` is the CPU's for the rays that
    /// the device leaves to it; all give the same answers, so that of the first use is kept.
    pub fn on_device(
        &self,
        py: Python<'_>,
        device: Device,
        evaluator: Option<&str>,
    ) -> PyResult<&DeviceEvaluator> {
        let place = &self.devices[usize::from(device == Device::Auto)];
        if let Some(known) = place.get() {
            return Ok(known);
        }
        let options = DeviceOptions { device, adapter: None };
        let made = py
            .detach(|| DeviceEvaluator::new(options, evaluator, self.program.clone()))
            .map_err(bad_value)?;
        warn(py, made.notice())?;
        Ok(place.get_or_init(|| made))
    }

    /// The number of the medium of a region; 0 is that of the world.
    pub fn medium_of(&self, region: RegionId) -> Medium {
        match &self.region_media {
            Some(media) => media[region.index()],
            None => self.program.medium_of(region),
        }
    }

    /// Whether a region is inside: its medium is not that of the world.
    pub fn is_inside(&self, region: RegionId) -> bool {
        self.medium_of(region) != 0
    }

    /// True if no region has the medium of the world.
    pub fn is_plain(&self) -> bool {
        self.is_plain
    }

    /// True if solids are placed, so that a face may be at several positions.
    pub fn has_placements(&self) -> bool {
        self.program.prototypes().iter().any(|group| group.placements > 1)
    }

    /// Writes for each region whether its medium differs from that of the world.
    pub fn put_inside(&self, regions: &[u32], flags: &mut [bool]) {
        let pairs = flags.iter_mut().zip(regions);
        match self.is_plain {
            true => pairs.for_each(|(flag, &region)| *flag = region != 0),
            false => pairs.for_each(|(flag, &region)| *flag = self.is_inside(RegionId(region))),
        }
    }

    /// The leaf of each face, by face number, with -1 for face -1 at the end.
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

    /// The names of all faces, by number.
    pub fn surface_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names =
            || Ok::<_, PyErr>(PyTuple::new(py, self.program.face_names().collect::<Vec<_>>())?.unbind());
        Ok(self.surface_names.get_or_try_init(py, names)?.bind(py).clone())
    }

    /// The names of the media, by number.
    pub fn medium_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = || {
            let names: Vec<_> = self.media.iter().flat_map(|media| media.iter()).collect();
            Ok::<_, PyErr>(PyTuple::new(py, names)?.unbind())
        };
        Ok(self.medium_names.get_or_try_init(py, names)?.bind(py).clone())
    }

    /// The names of the regions, by number; 0 is the world.
    pub fn region_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = || {
            let regions = || self.program.regions().iter().map(|region| region.name.as_str());
            let names: Vec<_> = std::iter::once(world_name(regions())).chain(regions()).collect();
            Ok::<_, PyErr>(PyTuple::new(py, names)?.unbind())
        };
        Ok(self.region_names.get_or_try_init(py, names)?.bind(py).clone())
    }
}

/// Options of any query.
pub struct QueryOptions {
    /// The time window.
    pub window: Window,
    /// `None` for the default, which is cached.
    evaluator: Option<String>,
    threads: Option<NonZeroUsize>,
    device: Device,
}

/// The value of a cell, computed at the first use. `compute` releases the GIL.
pub fn computed<T>(cell: &OnceLock<T>, compute: impl FnOnce() -> PyResult<T>) -> PyResult<&T> {
    if let Some(value) = cell.get() {
        return Ok(value);
    }
    let value = compute()?;
    // another thread may have computed it first
    Ok(cell.get_or_init(|| value))
}

/// The argument `t_min` or `t_max`.
pub fn time_argument(object: &Bound<'_, PyAny>) -> PyResult<f64> {
    object.extract().map_err(|_| {
        bad_type(format!(
            "t_min or t_max is {}: each is one number for all rays. For an end point of each ray, use direction = end - origin \
             and t from 0 to 1.",
            shown(object)
        ))
    })
}

impl QueryOptions {
    /// Parses the arguments that all queries share.
    pub fn new(
        t_min: f64,
        t_max: f64,
        evaluator: Option<&str>,
        threads: Option<&Bound<'_, PyAny>>,
        device: &str,
    ) -> PyResult<Self> {
        let device = device_argument(device)?;
        let window = Window::new(t_min, t_max)
            .map_err(|error| bad_value(format!("t_min = {t_min}, t_max = {t_max}: {error}")))?;
        if let Some(other) = evaluator.filter(|name| !AnyEvaluator::NAMES.contains(name)) {
            let names = AnyEvaluator::NAMES.map(|name| format!("'{name}'")).join(", ");
            let near = Message::unknown("evaluator", other, AnyEvaluator::NAMES);
            let hint = near.suggestion().map_or(String::new(), |near| format!(" {near}"));
            return Err(bad_value(format!("evaluator is '{other}': it must be one of {names}.{hint}")));
        }
        let evaluator = evaluator.filter(|&name| name != AnyEvaluator::NAMES[0]).map(str::to_owned);
        let threads = threads.map(thread_argument).transpose()?;
        Ok(QueryOptions { window, evaluator, threads, device })
    }

    /// The options of a query at points, which has no window.
    pub fn of_points(
        evaluator: Option<&str>,
        threads: Option<&Bound<'_, PyAny>>,
        device: &str,
    ) -> PyResult<Self> {
        QueryOptions::new(f64::NEG_INFINITY, f64::INFINITY, evaluator, threads, device)
    }
}

/// The error for a value that is not a whole number, or one too large for any use.
pub fn not_whole(value: &Bound<'_, PyAny>, name: &str) -> PyErr {
    match value.is_instance_of::<PyInt>() && !value.is_instance_of::<PyBool>() {
        true => bad_value(format!("{name} is {value}: it must be below 2^63.")),
        false => bad_type(format!("{name} is {}: it must be a whole number.", shown(value))),
    }
}

/// Parses a number of threads.
pub fn thread_argument(threads: &Bound<'_, PyAny>) -> PyResult<NonZeroUsize> {
    let number: i64 = threads.extract().map_err(|_| not_whole(threads, "threads"))?;
    usize::try_from(number)
        .ok()
        .and_then(NonZeroUsize::new)
        .ok_or_else(|| bad_value(format!("threads is {number}: it must be at least 1.")))
}

/// Division of rays or points into chunks for threads.
#[derive(Clone, Copy)]
pub struct Chunking {
    /// The number of rays or points.
    pub len: usize,
    /// Chunk size, at least 1.
    pub chunk: usize,
    /// The number of rays or points that the evaluator processes at a time.
    block: usize,
    threads: NonZeroUsize,
}

impl Chunking {
    /// The ranges of the chunks.
    pub fn ranges(self) -> impl Iterator<Item = Range<usize>> + Send {
        (0..self.len).step_by(self.chunk).map(move |start| start..self.len.min(start + self.chunk))
    }
}

impl Chunking {
    /// A single chunk.
    pub fn whole(len: usize) -> Self {
        Chunking { len, chunk: len.max(1), block: BLOCK, threads: NonZeroUsize::MIN }
    }

    /// The same with smaller chunks, as small as the overhead permits.
    pub fn small(self) -> Self {
        Chunking { chunk: self.block.max(MIN_CHUNK), ..self }
    }

    /// The number of chunks.
    pub fn chunks(self) -> usize {
        self.len.div_ceil(self.chunk)
    }
}

impl QueryOptions {
    /// Division of `len` rays or points into chunks for an evaluator.
    pub fn chunking(&self, len: usize, evaluator: &AnyEvaluator) -> Chunking {
        // querying the number of threads takes longer than many small queries
        if len <= MIN_CHUNK {
            return Chunking { len, chunk: MIN_CHUNK, block: BLOCK, threads: NonZeroUsize::MIN };
        }
        let threads = thread_count(self.threads);
        let block = block_of(evaluator);
        let chunk = match block > BLOCK {
            true => block,
            false => (len / (threads.get() * PIECES)).clamp(MIN_CHUNK, MAX_CHUNK).next_multiple_of(BLOCK),
        };
        Chunking {
            len,
            chunk,
            block,
            threads: NonZeroUsize::new(len.div_ceil(chunk)).map_or(threads, |n| threads.min(n)),
        }
    }
}

/// The state of a thread that processes a query.
pub struct Worker<'e, S> {
    /// Evaluator.
    pub evaluator: &'e AnyEvaluator,
    /// The scratch memory of the evaluator.
    pub memory: AnyScratch,
    /// Additional state of the query.
    pub scratch: S,
}

/// The number of rays or points that an evaluator processes at a time.
fn block_of(evaluator: &AnyEvaluator) -> usize {
    evaluator.preferred_batch().map_or(BLOCK, NonZeroUsize::get)
}

impl<S> Worker<'_, S> {
    /// The number of rays or points that the evaluator processes at a time.
    pub fn block(&self) -> usize {
        block_of(self.evaluator)
    }
}

/// Processes a query chunk by chunk without the GIL; `merge` receives the results in order. `work`
/// returns `None` if a ray or point of the chunk is invalid; the result is then false.
pub fn run_query<C: Send, A: Send, S: Default>(
    py: Python<'_>,
    chosen: &Chosen<'_>,
    chunking: Chunking,
    chunks: impl Iterator<Item = C> + Send,
    work: impl Fn(&mut Worker<'_, S>, C) -> Option<A> + Send + Sync,
    mut merge: impl FnMut(A) -> PyResult<()> + Send,
) -> PyResult<bool> {
    let evaluator: &AnyEvaluator = chosen;
    let worker = || Worker { evaluator, memory: evaluator.scratch(), scratch: S::default() };
    let merge = |answer: Option<A>| Ok(merge(answer.ok_or(Halt::Refused)?)?);
    let done = py.detach(|| run(chunking.threads, chunks, worker, work, merge))?;
    chosen.finish(py)?;
    Ok(done)
}

/// Processes chunks that are always valid, without the GIL.
pub fn share<C: Send>(
    py: Python<'_>,
    chunking: Chunking,
    chunks: impl Iterator<Item = C> + Send,
    work: impl Fn(C) + Send + Sync,
) -> PyResult<()> {
    py.detach(|| run(chunking.threads, chunks, || (), |(), chunk| work(chunk), |()| Ok(())))?;
    Ok(())
}

/// The reason why a query ends early.
enum Halt {
    /// A ray or point is invalid.
    Refused,
    /// An exception for Python.
    Raised(PyErr),
}

impl From<PyErr> for Halt {
    fn from(error: PyErr) -> Halt {
        Halt::Raised(error)
    }
}

/// Processes items by index, `step` at a time, on several threads; `merge` receives the results in
/// order. The caller must have released the GIL; Ctrl-C is checked between chunks.
pub fn in_chunks<A: Send, M>(
    len: usize,
    chunk: usize,
    requested: Option<NonZeroUsize>,
    memory: impl Fn() -> M + Sync,
    work: impl Fn(&mut M, Range<usize>) -> A + Sync,
    mut merge: impl FnMut(A) -> PyResult<()>,
) -> PyResult<()> {
    let threads = NonZeroUsize::new(len.div_ceil(chunk)).unwrap_or(NonZeroUsize::MIN);
    let threads = if threads.get() > 1 { thread_count(requested).min(threads) } else { threads };
    run(threads, Chunking { len, chunk, block: BLOCK, threads }.ranges(), memory, work, |answer| {
        Ok(merge(answer)?)
    })?;
    Ok(())
}

/// Processes chunks on several threads; false if one was invalid. Ctrl-C is checked between chunks.
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

/// The number of the face of a crossing.
pub fn surface(program: &Program, crossing: &Crossing) -> i32 {
    program.face_number(crossing.face.leaf, crossing.face.facet) as i32
}
