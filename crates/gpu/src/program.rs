//! A program on a GPU: nearest crossings with the answers of the CPU.

use crate::adapter::Adapter;
use crate::codes::{COMPLETED, DISTANT, FACET_BITS, MISS, PASSES, SHARED, TIED, UNCERTAIN};
use crate::double::Doubles;
use crate::error::{GpuError, Unsupported};
use crate::flat::{Flat, MOST_NODES, Tori};
use crate::frame::{Clock, Frame, Route, Sender};
use crate::kernel::{Answer, Kernel, Slot, Tables};
use crate::layout::{Layout, magnitude_of};
use crate::prepared::Others;
use crate::shader::{self, Entry};
use crate::terms::Top;
use crate::tied::{MOST_TIED, Tied, TiedEvent};
use crate::trial::rounds_like_the_cpu;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::weld::local_ray;
use rayweave_model::{
    BadRay, Crossing, Evaluator, Face, FirstHits, PixelRays, PlacementId, Program, PrototypeId, RayBatch,
    RaySource, Rays, RegionId, Window, attributes,
};
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

mod queries;
#[cfg(test)]
mod tests;

/// The largest and the smallest number of rays of a batch. A small batch leaves much of a large card idle; a thread prepares and
/// completes a batch alone, so a query needs at least one batch for each thread.
const MOST_RAYS: usize = 1 << 16;
const FEWEST_RAYS: usize = 1 << 14;

/// Threads per core: while one waits for the device, another prepares or completes a batch.
const THREADS_PER_CORE: NonZeroUsize = NonZeroUsize::new(2).unwrap();

/// Kernels whose buffers a worker keeps.
const MOST_SLOTS: usize = 3;

/// Interval, in rays, at which the CPU computes a time of the device again.
const CHECKED: usize = 256;

/// A compiled model on a device.
///
/// The device finds faces in single precision with error bounds. Where they settle which face a ray meets first, the kernel of
/// that face computes the time in f64, on the device or on the CPU; all other rays are *uncertain* and are traced by the CPU. The
/// answers are those of every [`Evaluator`], bit for bit.
#[derive(Debug)]
pub struct GpuProgram {
    program: Arc<Program>,
    cpu: Packets,
    kernel: Kernel,
    sender: Sender,
    layout: Layout,
    /// The number of the face, and its placement relative to that of the item, by facet.
    labels: Vec<(i32, u32)>,
    /// Kernels with an answer of several rows per ray, or none for crossings, compiled on first use.
    others: Others,
    /// The memory of earlier queries: new memory costs more time than the conversion of rays.
    idle: Mutex<Vec<Worker>>,
    /// Called with the number of the first ray of each batch of first crossings that is complete, in tests of the order.
    #[cfg(test)]
    completed: fn(usize),
}

/// The cost of a query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GpuReport {
    /// The number of rays.
    pub rays: u64,
    /// Rays that the bounds did not settle, so that the CPU traced them.
    pub uncertain: u64,
    /// Rays that the CPU traced since their origin is too far away for the device. They are not part of `uncertain`.
    pub distant: u64,
    /// Rays whose prediction the kernel of the named surface contradicts, so that the CPU traced them. A number above 0 is an
    /// error in the bounds or the driver.
    pub contradicted: u64,
    /// Crossings whose time the device computed, in double precision.
    pub timed: u64,
    /// Bytes moved to the device and back.
    pub bytes: u64,
    /// The time of the threads that converted rays for the device, summed over threads.
    pub prepare: Duration,
    /// The time of the threads that waited for the device, transfers included, summed over threads.
    pub device: Duration,
    /// The time of the threads that completed answers of [`GpuProgram::nearest`] in f64, summed over threads.
    pub complete: Duration,
}

impl GpuReport {
    /// Adds the costs of another query.
    pub fn add(&mut self, other: GpuReport) {
        self.rays += other.rays;
        self.uncertain += other.uncertain;
        self.distant += other.distant;
        self.contradicted += other.contradicted;
        self.timed += other.timed;
        self.bytes += other.bytes;
        self.prepare += other.prepare;
        self.device += other.device;
        self.complete += other.complete;
    }

    /// The share of rays that the CPU traced, 0 to 1.
    pub fn cpu_share(&self) -> f64 {
        (self.uncertain + self.distant + self.contradicted) as f64 / self.rays.max(1) as f64
    }
}

/// Columns of a chunk of rays.
struct Part<'a> {
    first: usize,
    t: &'a mut [f64],
    face: &'a mut [i32],
    placement: &'a mut [u32],
    before: &'a mut [u32],
    after: &'a mut [u32],
    normal: Option<[&'a mut [f64]; 3]>,
}

/// Memory of a thread that prepares and completes batches.
#[derive(Debug, Default)]
struct Worker {
    /// Buffers for each kernel that the worker has used.
    slots: Vec<Slot>,
    bytes: Vec<u8>,
    routes: Vec<Route>,
    answers: Vec<Answer>,
    /// Bits of times, or tied events.
    times: Vec<u64>,
    scratch: Option<<Packets as Evaluator>::Scratch>,
    again: Vec<usize>,
    batch: RayBatch,
}

/// The answer to a ray.
enum Outcome {
    Crossing(Crossing),
    /// No crossing, and the region at the start.
    Miss(u32),
    /// The CPU traces the ray.
    Again,
}

/// A worker in use, which returns to the idle ones when it is dropped.
struct Busy<'a> {
    worker: Worker,
    program: &'a GpuProgram,
}

impl Drop for Busy<'_> {
    fn drop(&mut self) {
        let worker = std::mem::take(&mut self.worker);
        self.program.idle().push(worker);
    }
}

impl GpuProgram {
    /// Compiles a program for an adapter and uploads it.
    ///
    /// # Errors
    ///
    /// [`GpuError::Unsupported`] for models without a form for the device, [`GpuError::TooLarge`] for those that exceed its
    /// memory, [`GpuError::Open`] and [`GpuError::Lost`] for problems of the device.
    pub fn new(adapter: &Adapter, program: Arc<Program>) -> Result<GpuProgram, GpuError> {
        let (layout, sender) = compile(&program)?;
        let device = adapter.open()?;
        let doubles =
            rounds_like_the_cpu(adapter, &device)?.then(|| Doubles::new(&program, &layout, &sender));
        let entry = if doubles.is_some() { Entry::Completed } else { Entry::Nearest };
        let tables = Tables::new(device, &layout, sender.bounded, doubles)?;
        let kernel = Kernel::new(tables, &layout, entry)?;
        let cpu = Packets::new(program.clone());
        let (others, idle) = (Others::default(), Mutex::default());
        let label = |face: &Face| (program.face_number(face.leaf, face.facet) as i32, face.placement.0);
        let labels = layout.faces.iter().map(label).collect();
        Ok(GpuProgram {
            program,
            cpu,
            kernel,
            sender,
            layout,
            labels,
            others,
            idle,
            #[cfg(test)]
            completed: |_| (),
        })
    }

    /// The program.
    pub fn program(&self) -> &Arc<Program> {
        &self.program
    }

    /// Bytes of the tables on the device.
    pub fn table_bytes(&self) -> u64 {
        self.layout.bytes()
    }

    /// The first crossing after t = 0 of every ray, as [`Evaluator::nearest`] computes it with the window from 0 on. All
    /// columns must be as long as the batch. Rays through pixels ([`PixelRays`](rayweave_model::PixelRays)) are computed on the device
    /// if it has double precision and rounds like the CPU; the kernel for them is compiled when it is first used.
    ///
    /// # Errors
    ///
    /// [`GpuError::Ray`] for the first ray out of range, [`GpuError::Lost`] if the device fails. The columns are then
    /// incomplete.
    pub fn nearest<'r>(
        &self,
        rays: impl Into<RaySource<'r>>,
        hits: &mut FirstHits<'_>,
    ) -> Result<GpuReport, GpuError> {
        let rays = rays.into();
        let mut for_pixels = None;
        if let RaySource::Pixels(pixels) = &rays {
            self.program.check_pixels(pixels)?;
            if self.kernel.completes() {
                for_pixels = Some(self.kernel_of(Entry::Pixels)?);
            }
        }
        let kernel = for_pixels.as_deref().unwrap_or(&self.kernel);
        let mut report = GpuReport::default();
        let parts = parts(hits, rays.len(), self.batch(rays.len(), kernel));
        let work =
            |worker: &mut Worker, mut part: Part<'_>| self.nearest_part(kernel, &rays, &mut part, worker);
        for cost in self.run(parts.into_iter(), work) {
            report.add(cost?);
        }
        Ok(report)
    }

    /// The number of rays of a batch.
    fn batch(&self, rays: usize, kernel: &Kernel) -> usize {
        let fits = kernel.device().limit / kernel.answer_bytes().max(kernel.ray_bytes()) as u64;
        let most = usize::try_from(fits).unwrap_or(usize::MAX).min(MOST_RAYS / kernel.rows);
        rays.div_ceil(threads().get())
            .max(FEWEST_RAYS)
            .min(most.max(1))
            .next_multiple_of(shader::WORKGROUP as usize)
    }

    /// Seconds that the kernel alone takes for a batch that is already on the device, the least of several runs, and the number
    /// of rays in it. For benchmarks.
    ///
    /// # Errors
    ///
    /// [`GpuError::Ray`] and [`GpuError::Lost`], like [`GpuProgram::nearest`].
    pub fn kernel_seconds(&self, rays: Rays<'_>, repeats: usize) -> Result<(f64, usize), GpuError> {
        self.program.check_rays(rays)?;
        let fits = self.kernel.device().limit / self.kernel.ray_bytes() as u64;
        let count = rays.len().min(1 << 20).min(usize::try_from(fits).unwrap_or(usize::MAX));
        let (mut routes, mut bytes) = (Vec::new(), Vec::new());
        convert(&self.kernel, &self.sender, (&rays.into(), 0..count), &mut routes, &mut bytes);
        let mut slot = self.kernel.slot(count)?;
        self.kernel.fill(&mut slot, count, &bytes)?;
        let seconds = |repeats: usize| -> Result<f64, GpuError> {
            let mut best = f64::INFINITY;
            for _ in 0..4 {
                let clock = Instant::now();
                self.kernel.submit(&slot, repeats);
                self.kernel.device().wait()?;
                best = best.min(clock.elapsed().as_secs_f64());
            }
            Ok(best)
        };
        // the difference leaves out the transfers
        let repeats = repeats.max(1);
        Ok(((seconds(2 * repeats)? - seconds(repeats)?) / repeats as f64, count))
    }

    /// Runs work on batches on all threads; returns the results in order.
    fn run<I: Send, O: Send>(
        &self,
        batches: impl Iterator<Item = I> + Send,
        work: impl Fn(&mut Worker, I) -> O + Sync,
    ) -> Vec<O> {
        let worker = || {
            let idle = self.idle().pop();
            Busy { worker: idle.unwrap_or_default(), program: self }
        };
        let work = |busy: &mut Busy<'_>, batch| work(&mut busy.worker, batch);
        let mut results = Vec::new();
        let done = drive(threads(), &Cancel::new(), batches, worker, work, |result| {
            results.push(result);
            Ok::<(), std::convert::Infallible>(())
        });
        match done {
            Ok(()) => results,
            Err(Stopped::Cancelled) => unreachable!("the token is never cancelled"),
            Err(Stopped::Failed(never)) => match never {},
        }
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Worker>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Prepares a batch, runs a kernel on it and waits for the answers.
    ///
    /// `first` is the number of its first ray in the query. Rays through pixels have been checked.
    fn answers(
        &self,
        (kernel, sender): (&Kernel, &Sender),
        (rays, range): (&RaySource<'_>, Range<usize>),
        first: usize,
        worker: &mut Worker,
    ) -> Result<GpuReport, GpuError> {
        let clock = Instant::now();
        if let RaySource::Arrays(rays) = rays {
            self.program
                .check_rays(rays.slice(range.clone()))
                .map_err(|bad| BadRay { ray: first + bad.ray, problem: bad.problem })?;
        }
        let count = range.len();
        convert(kernel, sender, (rays, range), &mut worker.routes, &mut worker.bytes);
        let prepared = clock.elapsed();
        let known = worker.slots.iter().position(|slot| slot.is_of(kernel));
        let mut slot = match known.map(|k| worker.slots.remove(k)) {
            Some(slot) if slot.holds(count) => slot,
            _ => kernel.slot(count)?,
        };
        // those used last
        worker.slots.drain(..worker.slots.len().saturating_sub(MOST_SLOTS - 1));
        kernel.trace(&mut slot, (count, &worker.bytes), &mut worker.answers, &mut worker.times)?;
        worker.slots.push(slot);
        Ok(GpuReport {
            rays: count as u64,
            bytes: (worker.bytes.len() + count * kernel.answer_bytes()) as u64,
            prepare: prepared,
            device: clock.elapsed() - prepared,
            ..GpuReport::default()
        })
    }

    /// The first crossings of a batch.
    ///
    /// If the device computes times, the CPU computes every 256th of them again. If one has other bits, it computes all times of the
    /// batch, and that ray counts as contradicted.
    fn nearest_part(
        &self,
        kernel: &Kernel,
        rays: &RaySource<'_>,
        part: &mut Part<'_>,
        worker: &mut Worker,
    ) -> Result<GpuReport, GpuError> {
        let range = part.first..part.first + part.t.len();
        let mut report = self.answers((kernel, &self.sender), (rays, range), part.first, worker)?;
        let clock = Instant::now();
        worker.again.clear();
        let mut is_trusted = true;
        let mut k = 0;
        while let Some(answer) = worker.answers.get(k) {
            let extra = worker.times.get(k).copied();
            let is_completed = is_trusted && answer[0] < MISS && answer[0] & COMPLETED != 0;
            let time = extra.filter(|_| is_completed).map(f64::from_bits);
            if let Some(t) = time
                && !k.is_multiple_of(CHECKED)
                && self.put_completed(rays, part, k, (answer, t)).is_some()
            {
                report.timed += 1;
                k += 1;
                continue;
            }
            let ray = || rays.get(part.first + k);
            let outcome = self.outcome(ray, (answer, worker.routes.get(k), extra), &mut report);
            let is_same = |t: f64| matches!(&outcome, Outcome::Crossing(c) if c.t.to_bits() == t.to_bits());
            if time.is_some_and(|t| !is_same(t)) {
                // starts again without the times of the device
                is_trusted = false;
                (report.uncertain, report.distant, report.timed, report.contradicted) = (0, 0, 0, 1);
                worker.again.clear();
                k = 0;
                continue;
            }
            match outcome {
                Outcome::Crossing(crossing) => self.put(&ray(), part, k, &crossing),
                Outcome::Miss(region) => miss(part, k, region),
                Outcome::Again => worker.again.push(k),
            }
            k += 1;
        }
        self.trace(rays, part, worker);
        report.complete = clock.elapsed();
        #[cfg(test)]
        (self.completed)(part.first);
        Ok(report)
    }

    /// The answer to a ray, with the time of the CPU.
    fn outcome(
        &self,
        ray: impl Fn() -> Ray,
        (answer, route, extra): (&Answer, Option<&Route>, Option<u64>),
        report: &mut GpuReport,
    ) -> Outcome {
        // kernels that take rays in double precision write the route into the answer
        let (passes, is_distant) = match route {
            Some(route) => (matches!(route, Route::Passes), matches!(route, Route::Cpu)),
            None => (
                answer[0] & MISS != 0 && answer[1] == PASSES,
                answer[0] & UNCERTAIN != 0 && answer[1] == DISTANT,
            ),
        };
        if passes {
            return Outcome::Miss(0);
        }
        if is_distant || answer[0] & UNCERTAIN != 0 {
            *(if is_distant { &mut report.distant } else { &mut report.uncertain }) += 1;
            return Outcome::Again;
        }
        let known = if answer[0] & MISS != 0 {
            self.layout.regions.get((answer[2] & 0xffff) as usize).map(|&region| Outcome::Miss(region))
        } else {
            let ray = ray();
            match (route.copied().unwrap_or_else(|| self.sender.send(&ray).0), extra) {
                (Route::Device(clock), Some(bits)) if answer[0] & TIED != 0 => {
                    self.first_of(Tied::new(bits), &ray, answer, clock).map(Outcome::Crossing)
                }
                (Route::Device(clock), _) => self.polished(&ray, answer, clock).map(Outcome::Crossing),
                (Route::Passes | Route::Cpu, _) => None,
            }
        };
        known.unwrap_or_else(|| {
            // among several events, the root nearest to the middle of their intervals may be that of another
            let is_shared = answer[0] & (MISS | SHARED) == SHARED;
            *(if is_shared { &mut report.uncertain } else { &mut report.contradicted }) += 1;
            Outcome::Again
        })
    }

    /// Writes an answer with the time of the device; `None`, without writing, if it names something that the model does not have.
    fn put_completed(
        &self,
        rays: &RaySource<'_>,
        part: &mut Part<'_>,
        k: usize,
        (answer, t): (&Answer, f64),
    ) -> Option<()> {
        let facet = (answer[0] & FACET_BITS) as usize;
        let &(number, placement) = self.labels.get(facet)?;
        let placement = placement + self.layout.placements.get(answer[1] as usize)?;
        let region = |number: u32| self.layout.regions.get(number as usize).copied();
        let (before, after) = (region(answer[2] >> 16)?, region(answer[2] & 0xffff)?);
        part.t[k] = t;
        part.face[k] = number;
        part.placement[k] = placement;
        part.before[k] = before;
        part.after[k] = after;
        if let Some(normal) = &mut part.normal {
            // there is a label for each face
            let face = Face { placement: PlacementId(placement), ..self.layout.faces[facet] };
            let (before, after) = (RegionId(before), RegionId(after));
            let crossing = Crossing { t, face, left: face, entered: face, before, after };
            let unit = attributes::normal(&self.program, &rays.get(part.first + k), &crossing).to_array();
            normal.iter_mut().zip(unit).for_each(|(column, x)| column[k] = x);
        }
        Some(())
    }

    /// The crossing that an answer predicts, with the time of the CPU's kernel; `None` if that has no such root.
    fn polished(&self, ray: &Ray, answer: &Answer, clock: Clock) -> Option<Crossing> {
        let face = self.face_of((answer[0] & FACET_BITS) as usize, answer)?;
        let t = self.time_of(face, ray, answer, clock)?;
        self.crossing_at(t, face, answer)
    }

    /// The face of a facet of the item that an answer names.
    fn face_of(&self, facet: usize, answer: &Answer) -> Option<Face> {
        let face = *self.layout.faces.get(facet)?;
        let placement = PlacementId(face.placement.0 + self.layout.placements.get(answer[1] as usize)?);
        Some(Face { placement, ..face })
    }

    /// A crossing of a face, between the regions that an answer names.
    fn crossing_at(&self, t: f64, face: Face, answer: &Answer) -> Option<Crossing> {
        let region = |number: u32| self.layout.regions.get(number as usize).copied().map(RegionId);
        let (before, after) = (region(answer[2] >> 16)?, region(answer[2] & 0xffff)?);
        Some(Crossing { t, face, left: face, entered: face, before, after })
    }

    /// The time of the CPU's kernel near the predicted one; `None` if there is no such root.
    fn time_of(&self, face: Face, ray: &Ray, answer: &Answer, clock: Clock) -> Option<f64> {
        let surface = &self.program.surface(face.surface).surface;
        let crossings = if face.placement.0 == 0 {
            surface.crossings(ray)
        } else {
            surface.crossings(&local_ray(&self.program, ray, face.placement).0)
        };
        let on_device = f64::from(f32::from_bits(answer[3]));
        let predicted = clock.shift + on_device * clock.rate;
        let times = crossings.times();
        let distance = |t: f64| (t - predicted).abs();
        let &nearest = times.iter().min_by(|a, b| distance(**a).total_cmp(&distance(**b)))?;
        // the interval of the device holds one root; a prediction about halfway between two is not its middle
        let is_clear = |&t: &f64| t == nearest || distance(t) > 2.0 * distance(nearest);
        // a ray that is nearly parallel to a plane far away has an interval of up to twice its time
        let is_near = nearest > clock.from && distance(nearest) < (1.0 + on_device.abs()) * clock.rate;
        (is_near && times.iter().all(is_clear)).then_some(nearest)
    }

    /// The crossing among tied events, with the times of the CPU; `None` if it is not clear.
    fn first_of(&self, tied: Tied, ray: &Ray, answer: &Answer, clock: Clock) -> Option<Crossing> {
        let mut events = [TiedEvent::default(); MOST_TIED];
        let mut faces = [None; MOST_TIED];
        let count = tied.count();
        for k in 0..count {
            let facet = tied.facet((answer[0] & FACET_BITS) as usize, k);
            let face = self.face_of(facet, answer)?;
            let is_known = |other: &Option<Face>| {
                other.is_some_and(|other| (other.leaf, other.placement) == (face.leaf, face.placement))
            };
            if faces[..k].iter().any(is_known) {
                // the events of one leaf follow other rules
                return None;
            }
            faces[k] = Some(face);
            let t = self.time_of(face, ray, answer, clock)?;
            events[k] = TiedEvent { t, facet, instance: *self.layout.instances.get(facet)? };
        }
        let (k, t) = tied.crossing(&events[..count])?;
        self.crossing_at(t, faces[k]?, answer)
    }

    fn put(&self, ray: &Ray, part: &mut Part<'_>, k: usize, crossing: &Crossing) {
        part.t[k] = crossing.t;
        part.face[k] = self.program.face_number(crossing.face.leaf, crossing.face.facet) as i32;
        part.placement[k] = crossing.face.placement.0;
        part.before[k] = crossing.before.0;
        part.after[k] = crossing.after.0;
        if let Some(normal) = &mut part.normal {
            let unit = attributes::normal(&self.program, ray, crossing).to_array();
            normal.iter_mut().zip(unit).for_each(|(column, x)| column[k] = x);
        }
    }

    /// Traces the rays of `again` on the CPU.
    fn trace(&self, rays: &RaySource<'_>, part: &mut Part<'_>, worker: &mut Worker) {
        let Worker { scratch, again, batch, .. } = worker;
        if again.is_empty() {
            return;
        }
        batch.clear();
        again.iter().for_each(|&k| batch.push(rays.get(part.first + k)));
        let count = again.len();
        let (mut t, mut face, mut normal) = (vec![0.0; count], vec![0; count], vec![0.0; 3 * count]);
        let (mut placement, mut before, mut after) = (vec![0; count], vec![0; count], vec![0; count]);
        let (x, rest) = normal.split_at_mut(count);
        let (y, z) = rest.split_at_mut(count);
        let mut hits = FirstHits {
            t: &mut t,
            face: &mut face,
            placement: &mut placement,
            before: &mut before,
            after: &mut after,
            normal: part.normal.is_some().then_some([x, y, z]),
        };
        let Ok(window) = Window::new(0.0, f64::INFINITY) else { return };
        let scratch = scratch.get_or_insert_with(|| self.cpu.scratch());
        self.cpu.nearest(batch.rays(), window, scratch, &mut hits);
        for (n, &k) in again.iter().enumerate() {
            part.t[k] = t[n];
            part.face[k] = face[n];
            part.placement[k] = placement[n];
            part.before[k] = before[n];
            part.after[k] = after[n];
            if let Some(columns) = &mut part.normal {
                columns
                    .iter_mut()
                    .enumerate()
                    .for_each(|(axis, column)| column[k] = normal[axis * count + n]);
            }
        }
    }
}

fn miss(part: &mut Part<'_>, k: usize, region: u32) {
    part.t[k] = f64::INFINITY;
    part.face[k] = -1;
    part.placement[k] = 0;
    part.before[k] = region;
    part.after[k] = region;
    if let Some(normal) = &mut part.normal {
        normal.iter_mut().for_each(|column| column[k] = f64::NAN);
    }
}

/// The tables of a program, and how rays are sent to it.
pub(crate) fn compile(program: &Program) -> Result<(Layout, Sender), GpuError> {
    let model = program.prototype(PrototypeId(0));
    let frame = Frame::of(model);
    let sent = Sender {
        frame,
        bounded: is_bounded(program, &frame),
        magnitude: magnitude_of(program, PrototypeId(0)),
        from: 0.0,
    };
    if program.regions().len() > 0xfffe {
        return Err(GpuError::Unsupported(Unsupported::Regions));
    }
    let layout = match Flat::new(program, PrototypeId(0), model.expression.outputs(), Tori::Chords) {
        Ok(flat) => Layout::small(program, &flat, &frame),
        Err(Unsupported::Nodes { .. }) => {
            let top = Top::new(program).map_err(GpuError::Unsupported)?;
            Layout::large(program, &top, &frame).map_err(GpuError::Unsupported)?
        }
        Err(problem) => return Err(GpuError::Unsupported(problem)),
    };
    debug_assert!(layout.nodes <= MOST_NODES, "{} nodes", layout.nodes);
    Ok((layout, sent))
}

/// True if the model lies within the ball of radius 1 of its frame.
fn is_bounded(program: &Program, frame: &Frame) -> bool {
    let bounds = program.bounds();
    bounds.is_empty()
        || bounds.is_finite()
            && bounds.corners().into_iter().all(|corner| frame.point(corner).length() <= 1.0 + 1e-9)
}

/// A range of rays as a kernel reads them: columns in double precision, pixels, or rays in the frame of the model.
fn convert(
    kernel: &Kernel,
    sender: &Sender,
    (rays, range): (&RaySource<'_>, Range<usize>),
    routes: &mut Vec<Route>,
    bytes: &mut Vec<u8>,
) {
    routes.clear();
    bytes.clear();
    match rays {
        _ if !kernel.completes() => {
            // in the frame of the model
            for i in range {
                let (route, ray) = sender.send(&rays.get(i));
                bytes.extend_from_slice(&ray.bytes());
                routes.push(route);
            }
        }
        RaySource::Arrays(rays) => {
            let rays = rays.slice(range);
            for column in rays.origins.iter().chain(&rays.directions) {
                bytes.extend(column.iter().flat_map(|x| x.to_le_bytes()));
            }
        }
        RaySource::Pixels(rays) => put_pixels(rays, range, bytes),
    }
}

/// A camera and the pixels of a range of rays, as `pixels.wgsl` reads them.
pub(crate) fn put_pixels(rays: &PixelRays<'_>, range: Range<usize>, bytes: &mut Vec<u8>) {
    let PixelRays { camera, per_side, pixels } = *rays;
    for vector in [camera.position, camera.forward, camera.right, camera.up] {
        bytes.extend(vector.to_array().into_iter().flat_map(f64::to_le_bytes));
    }
    bytes.extend(camera.half_height.to_le_bytes());
    let left_out = (range.start % rays.per_pixel()) as u32;
    let [w, h] = camera.size;
    bytes.extend([w, h, u32::from(camera.is_perspective), per_side, left_out].map(u32::to_le_bytes).concat());
    debug_assert_eq!(bytes.len(), 4 * shader::PIXELS);
    let used = range.start / rays.per_pixel()..range.end.div_ceil(rays.per_pixel());
    bytes.extend(pixels[used].iter().flat_map(|pixel| pixel.to_le_bytes()));
}

/// The number of threads that prepare and complete batches.
fn threads() -> NonZeroUsize {
    thread_count(None).saturating_mul(THREADS_PER_CORE)
}

/// The columns of `count` rays, in batches.
fn parts<'a>(hits: &'a mut FirstHits<'_>, count: usize, batch: usize) -> Vec<Part<'a>> {
    let mut t = hits.t[..count].chunks_mut(batch);
    let mut face = hits.face[..count].chunks_mut(batch);
    let mut placement = hits.placement[..count].chunks_mut(batch);
    let mut before = hits.before[..count].chunks_mut(batch);
    let mut after = hits.after[..count].chunks_mut(batch);
    let mut normal = hits
        .normal
        .as_mut()
        .map(|columns| columns.each_mut().map(|column| column[..count].chunks_mut(batch)));
    let mut parts = Vec::new();
    while let (Some(t), Some(face), Some(placement), Some(before), Some(after)) =
        (t.next(), face.next(), placement.next(), before.next(), after.next())
    {
        let normal = normal.as_mut().map(|columns| columns.each_mut().map(|c| c.next().unwrap_or_default()));
        parts.push(Part { first: parts.len() * batch, t, face, placement, before, after, normal });
    }
    parts
}
