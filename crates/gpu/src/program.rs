//! A program on a GPU: nearest crossings with the answers of the CPU.

use crate::adapter::Adapter;
use crate::error::{GpuError, Unsupported};
use crate::flat::{Flat, MOST_NODES};
use crate::frame::{Clock, Frame, Sender, Sent};
use crate::kernel::{Answer, Kernel, RAY_BYTES, Slot, Tables};
use crate::layout::{Layout, magnitude_of};
use crate::prepared::Others;
use crate::shader::Entry;
use crate::terms::Top;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::weld::local_ray;
use rayweave_model::{
    Crossing, Evaluator, Face, FirstHits, PlacementId, Program, PrototypeId, RayBatch, Rays, RegionId,
    Window, attributes,
};
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

mod queries;

/// Rays that are on the device at a time, per slot.
const BATCH: usize = 1 << 20;

/// Rays that a thread prepares or completes at a time.
const CHUNK: usize = 1 << 14;

/// Bits of the first word of an answer.
const UNCERTAIN: u32 = 1 << 31;
const MISS: u32 = 1 << 30;
const SHARED: u32 = 1 << 29;

/// A compiled model on a device.
///
/// The device computes in single precision with error bounds. Where they settle which face a ray meets first, the CPU computes
/// the time in f64 with the kernel of that face; all other rays are *uncertain* and are traced by the CPU. The answers are
/// those of every [`Evaluator`], bit for bit.
#[derive(Debug)]
pub struct GpuProgram {
    program: Arc<Program>,
    cpu: Packets,
    kernel: Kernel,
    sender: Sender,
    layout: Layout,
    /// One query at a time uses them.
    slots: Mutex<[Slot; 2]>,
    batch: usize,
    /// Kernels with an answer of several rows per ray, or none for crossings, compiled on first use.
    others: Others,
}

/// What a query cost.
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
    /// Bytes moved to the device and back.
    pub bytes: u64,
}

impl GpuReport {
    /// Adds the costs of another query.
    pub fn add(&mut self, other: GpuReport) {
        self.rays += other.rays;
        self.uncertain += other.uncertain;
        self.distant += other.distant;
        self.contradicted += other.contradicted;
        self.bytes += other.bytes;
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

/// Memory of a thread that completes answers.
struct Completion {
    scratch: <Packets as Evaluator>::Scratch,
    again: Vec<usize>,
    batch: RayBatch,
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
        let tables = Tables::new(adapter.open()?, &layout, sender.bounded)?;
        let kernel = Kernel::new(tables, &layout, Entry::Nearest)?;
        let batch = BATCH.min((kernel.device().limit / RAY_BYTES as u64) as usize);
        let slots = [kernel.slot(batch)?, kernel.slot(batch)?];
        Ok(GpuProgram {
            cpu: Packets::new(program.clone()),
            program,
            kernel,
            sender,
            layout,
            slots: Mutex::new(slots),
            batch,
            others: Others::default(),
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
    /// columns must be as long as the batch.
    ///
    /// # Errors
    ///
    /// [`GpuError::Ray`] for the first ray out of range, [`GpuError::Lost`] if the device fails. The columns are then
    /// incomplete.
    pub fn nearest(&self, rays: Rays<'_>, hits: &mut FirstHits<'_>) -> Result<GpuReport, GpuError> {
        self.program.check_rays(rays)?;
        let slots = self.slots();
        let mut report = GpuReport::default();
        let mut waiting = None;
        let mut answers = Vec::new();
        for (k, first) in (0..rays.len()).step_by(self.batch).enumerate() {
            let count = self.batch.min(rays.len() - first);
            let bytes = self.prepare(&rays.slice(first..first + count));
            let pending = self.kernel.start(&slots[k % 2], &bytes);
            report.bytes += (count * (RAY_BYTES + self.kernel.answer_bytes())) as u64;
            if let Some((slot, first, pending)) = waiting.replace((k % 2, first, pending)) {
                self.kernel.finish(&slots[slot], pending, &mut answers)?;
                report.add(self.complete(&rays, first, &answers, hits));
            }
        }
        if let Some((slot, first, pending)) = waiting {
            self.kernel.finish(&slots[slot], pending, &mut answers)?;
            report.add(self.complete(&rays, first, &answers, hits));
        }
        Ok(report)
    }

    /// Seconds that the kernel alone takes for a batch that is already on the device, the least of several runs, and the number
    /// of rays in it. For benchmarks.
    ///
    /// # Errors
    ///
    /// [`GpuError::Ray`] and [`GpuError::Lost`], like [`GpuProgram::nearest`].
    pub fn kernel_seconds(&self, rays: Rays<'_>, repeats: usize) -> Result<(f64, usize), GpuError> {
        self.program.check_rays(rays)?;
        let count = rays.len().min(self.batch);
        let bytes = self.prepare(&rays.slice(0..count));
        let slots = self.slots();
        self.kernel.upload(&slots[0], &bytes);
        self.kernel.run(&slots[0], count, 1, false);
        self.kernel.device().wait()?;
        let mut best = f64::INFINITY;
        for _ in 0..3 {
            let clock = std::time::Instant::now();
            self.kernel.run(&slots[0], count, repeats, false);
            self.kernel.device().wait()?;
            best = best.min(clock.elapsed().as_secs_f64() / repeats as f64);
        }
        Ok((best, count))
    }

    /// The buffers of batches, for one query.
    fn slots(&self) -> MutexGuard<'_, [Slot; 2]> {
        // a query that panicked left no answer that a later one reads
        self.slots.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The rays as the kernel reads them. A ray that is not sent has an error bound that leaves it uncertain.
    fn prepare(&self, rays: &Rays<'_>) -> Vec<u8> {
        let mut bytes = vec![0; RAY_BYTES * rays.len()];
        let chunks = bytes.chunks_mut(RAY_BYTES * CHUNK).enumerate();
        run(
            rays.len(),
            chunks,
            || (),
            |(), (chunk, bytes): (usize, &mut [u8])| {
                for (k, place) in bytes.chunks_exact_mut(RAY_BYTES).enumerate() {
                    if let Sent::Device(ray, _) = self.sender.send(rays, chunk * CHUNK + k) {
                        place.copy_from_slice(&ray.bytes());
                    }
                }
            },
        );
        bytes
    }

    /// Completes the answers of a batch that starts at ray `first`.
    fn complete(
        &self,
        rays: &Rays<'_>,
        first: usize,
        answers: &[Answer],
        hits: &mut FirstHits<'_>,
    ) -> GpuReport {
        let parts = parts(hits, first, answers.len());
        let mut report = GpuReport { rays: answers.len() as u64, ..GpuReport::default() };
        let scratch =
            || Completion { scratch: self.cpu.scratch(), again: Vec::new(), batch: RayBatch::default() };
        let costs = run(answers.len(), parts.into_iter(), scratch, |memory, mut part: Part<'_>| {
            let at = part.first - first;
            self.complete_part(rays, &answers[at..at + part.t.len()], &mut part, memory)
        });
        costs.into_iter().for_each(|cost| report.add(cost));
        report
    }

    fn complete_part(
        &self,
        rays: &Rays<'_>,
        answers: &[Answer],
        part: &mut Part<'_>,
        memory: &mut Completion,
    ) -> GpuReport {
        let mut report = GpuReport::default();
        memory.again.clear();
        for (k, answer) in answers.iter().enumerate() {
            let i = part.first + k;
            let region = match self.sender.send(rays, i) {
                Sent::Passes => Some(0),
                Sent::Cpu => {
                    report.distant += 1;
                    memory.again.push(k);
                    continue;
                }
                Sent::Device(_, clock) => {
                    if answer[0] & UNCERTAIN != 0 {
                        report.uncertain += 1;
                        memory.again.push(k);
                        continue;
                    }
                    if answer[0] & MISS == 0 {
                        match self.polished(&rays.get(i), answer, clock) {
                            Some(crossing) => self.put(rays, part, k, &crossing),
                            None => {
                                report.contradicted += 1;
                                memory.again.push(k);
                            }
                        }
                        continue;
                    }
                    self.layout.regions.get((answer[2] & 0xffff) as usize).copied()
                }
            };
            match region {
                Some(region) => miss(part, k, region),
                None => {
                    report.contradicted += 1;
                    memory.again.push(k);
                }
            }
        }
        self.trace(rays, part, memory);
        report
    }

    /// The crossing that an answer predicts, with the time of the CPU's kernel; `None` if that has no such root.
    fn polished(&self, ray: &Ray, answer: &Answer, clock: Clock) -> Option<Crossing> {
        let face = *self.layout.faces.get((answer[0] & !SHARED) as usize)?;
        let placement = PlacementId(face.placement.0 + self.layout.placements.get(answer[1] as usize)?);
        let face = Face { placement, ..face };
        let region = |number: u32| self.layout.regions.get(number as usize).copied().map(RegionId);
        let (before, after) = (region(answer[2] >> 16)?, region(answer[2] & 0xffff)?);
        let surface = &self.program.surface(face.surface).surface;
        let crossings = if placement.0 == 0 {
            surface.crossings(ray)
        } else {
            surface.crossings(&local_ray(&self.program, ray, placement).0)
        };
        let predicted = clock.shift + f64::from(f32::from_bits(answer[3])) * clock.rate;
        let times = crossings.times();
        let distance = |t: f64| (t - predicted).abs();
        let &nearest = times.iter().min_by(|a, b| distance(**a).total_cmp(&distance(**b)))?;
        // the interval of the device holds one root; a prediction about halfway between two is not its middle
        let is_clear = |&t: &f64| t == nearest || distance(t) > 2.0 * distance(nearest);
        let is_near = nearest > clock.from && distance(nearest) < clock.rate;
        (is_near && times.iter().all(is_clear)).then_some(Crossing {
            t: nearest,
            face,
            left: face,
            entered: face,
            before,
            after,
        })
    }

    fn put(&self, rays: &Rays<'_>, part: &mut Part<'_>, k: usize, crossing: &Crossing) {
        part.t[k] = crossing.t;
        part.face[k] = self.program.face_number(crossing.face.leaf, crossing.face.facet) as i32;
        part.placement[k] = crossing.face.placement.0;
        part.before[k] = crossing.before.0;
        part.after[k] = crossing.after.0;
        if let Some(normal) = &mut part.normal {
            let unit = attributes::normal(&self.program, &rays.get(part.first + k), crossing).to_array();
            normal.iter_mut().zip(unit).for_each(|(column, x)| column[k] = x);
        }
    }

    /// Traces the rays of `again` on the CPU.
    fn trace(&self, rays: &Rays<'_>, part: &mut Part<'_>, memory: &mut Completion) {
        let Completion { scratch, again, batch } = memory;
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
    let layout = match Flat::new(program, PrototypeId(0), model.expression.outputs()) {
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

/// Runs work on chunks on as many threads as there are cores; returns the results in order.
fn run<I: Send, O: Send, S>(
    rays: usize,
    chunks: impl Iterator<Item = I> + Send,
    scratch: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, I) -> O + Sync,
) -> Vec<O> {
    let threads = if rays > CHUNK { thread_count(None) } else { NonZeroUsize::MIN };
    let mut results = Vec::new();
    let done = drive(threads, &Cancel::new(), chunks, scratch, work, |result| {
        results.push(result);
        Ok::<(), std::convert::Infallible>(())
    });
    match done {
        Ok(()) => results,
        Err(Stopped::Cancelled) => unreachable!("the token is never cancelled"),
        Err(Stopped::Failed(never)) => match never {},
    }
}

/// The columns of `count` rays from `first` on, in chunks.
fn parts<'a>(hits: &'a mut FirstHits<'_>, first: usize, count: usize) -> Vec<Part<'a>> {
    let range = first..first + count;
    let mut t = hits.t[range.clone()].chunks_mut(CHUNK);
    let mut face = hits.face[range.clone()].chunks_mut(CHUNK);
    let mut placement = hits.placement[range.clone()].chunks_mut(CHUNK);
    let mut before = hits.before[range.clone()].chunks_mut(CHUNK);
    let mut after = hits.after[range.clone()].chunks_mut(CHUNK);
    let mut normal = hits
        .normal
        .as_mut()
        .map(|columns| columns.each_mut().map(|column| column[range.clone()].chunks_mut(CHUNK)));
    let mut parts = Vec::new();
    while let (Some(t), Some(face), Some(placement), Some(before), Some(after)) =
        (t.next(), face.next(), placement.next(), before.next(), after.next())
    {
        let normal = normal.as_mut().map(|columns| columns.each_mut().map(|c| c.next().unwrap_or_default()));
        parts.push(Part { first: first + parts.len() * CHUNK, t, face, placement, before, after, normal });
    }
    parts
}
