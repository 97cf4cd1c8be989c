//! Queries other than the nearest crossing from t = 0: windows, all crossings, and the regions of points.

use super::{BATCH, CHUNK, GpuProgram, GpuReport, SHARED, UNCERTAIN, run};
use crate::error::GpuError;
use crate::frame::{Clock, Sender, Sent};
use crate::kernel::{Answer, Kernel, RAY_BYTES};
use crate::prepared::Prepared;
use crate::shader::Entry;
use rayweave_math::Vec3;
use rayweave_model::{
    Collected, Crossing, Evaluator, Limit, Query, RayAnswer, RayBatch, Rays, RegionId, Sink,
};
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::PoisonError;

/// The bit of the first word of an answer for a ray with more crossings than rows.
const MORE: u32 = 1 << 28;

/// The direction of the rays that start at points whose region is asked for. Any is valid; this unit vector is parallel to no
/// axis, diagonal or coordinate plane, along which models have most of their faces.
const DIRECTION: Vec3 = Vec3::new(0.48, 0.6, 0.64);

type CpuScratch = <Packets as Evaluator>::Scratch;

impl GpuProgram {
    /// All crossings after t = 0 of every ray: [`GpuProgram::collect`] with the window from 0 on.
    ///
    /// # Errors
    ///
    /// Those of [`GpuProgram::collect`].
    pub fn crossings(&self, rays: Rays<'_>, most: NonZeroUsize) -> Result<(Collected, GpuReport), GpuError> {
        self.collect(rays, &Query { limit: Limit::All, ..Query::nearest() }, most)
    }

    /// The crossings of every ray in a window, all or the first, as [`Evaluator::collect`] computes them. Rays with more than `most`
    /// crossings after the start of the window are traced by the CPU and counted as uncertain, unless the query asks for the first
    /// only. A kernel is compiled when it is first used, and that for all crossings also when `most` changes. The CPU traces all rays
    /// of a query with start lists, and counts them as distant.
    ///
    /// # Errors
    ///
    /// [`GpuError::Ray`], [`GpuError::Lost`] and [`GpuError::TooLarge`], like [`GpuProgram::nearest`].
    pub fn collect(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        most: NonZeroUsize,
    ) -> Result<(Collected, GpuReport), GpuError> {
        self.program.check_rays(rays)?;
        let (mut collected, mut report) = (Collected::default(), GpuReport::default());
        if query.starts.is_some_and(|starts| !starts.entries.is_empty()) {
            self.cpu.crossings(rays, query, &mut self.cpu.scratch(), &mut collected);
            report.rays = rays.len() as u64;
            report.distant = report.rays;
            return Ok((collected, report));
        }
        let entry = match query.limit {
            Limit::First => Entry::First,
            Limit::All => Entry::All(most.get()),
        };
        let sender = Sender { from: query.window.t_min(), ..self.sender };
        let bytes = self.ask(entry, &sender, &rays, |part, answers| {
            let work = |scratch: &mut CpuScratch, (rays, rows): (Rays<'_>, &[Answer])| {
                self.collect_part(&rays, rows, (&sender, query, entry.rows()), scratch)
            };
            let chunks = chunks(part, answers, entry.rows());
            for (found, cost) in run(part.len(), chunks, || self.cpu.scratch(), work) {
                collected.append(&found);
                report.add(cost);
            }
        })?;
        report.bytes += bytes;
        Ok((collected, report))
    }

    /// The region that contains each point, as [`Evaluator::regions_at`] computes it. Points closer to a surface than the error
    /// bounds are uncertain, and the CPU decides. The slices must have one length.
    ///
    /// # Errors
    ///
    /// [`GpuError::Ray`] for the first point out of range, [`GpuError::Lost`] and [`GpuError::TooLarge`], like
    /// [`GpuProgram::nearest`].
    pub fn regions_at(&self, points: [&[f64]; 3], out: &mut [RegionId]) -> Result<GpuReport, GpuError> {
        let mut report = GpuReport::default();
        let mut first = 0;
        for out in out.chunks_mut(BATCH) {
            let points = points.map(|column| &column[first..first + out.len()]);
            let at = |i: usize| Vec3::new(points[0][i], points[1][i], points[2][i]);
            let rays: RayBatch = (0..out.len()).map(|i| Ray::new(at(i), DIRECTION)).collect();
            report.add(self.regions_of(points, &rays.rays(), out)?);
            first += out.len();
        }
        Ok(report)
    }

    /// The regions of points, through rays that start there.
    fn regions_of(
        &self,
        points: [&[f64]; 3],
        rays: &Rays<'_>,
        out: &mut [RegionId],
    ) -> Result<GpuReport, GpuError> {
        self.program.check_rays(*rays)?;
        let mut report = GpuReport::default();
        let (mut first, mut again) = (0, Vec::new());
        let bytes = self.ask(Entry::Start, &self.sender, rays, |part, answers| {
            let work = |(): &mut (), (rays, rows): (Rays<'_>, &[Answer])| {
                (0..rays.len()).map(|i| self.start_of(&rays, i, &rows[i])).collect::<Vec<_>>()
            };
            for known in run(part.len(), chunks(part, answers, 1), || (), work) {
                for start in known {
                    report.rays += 1;
                    match start {
                        Start::Known(region) => out[first] = region,
                        Start::Uncertain => report.uncertain += 1,
                        Start::Distant => report.distant += 1,
                    }
                    if !matches!(start, Start::Known(_)) {
                        again.push(first);
                    }
                    first += 1;
                }
            }
        })?;
        report.bytes += bytes;
        let at = points.map(|column| again.iter().map(|&i| column[i]).collect::<Vec<_>>());
        let mut regions = vec![RegionId(0); again.len()];
        self.cpu.regions_at(at.each_ref().map(Vec::as_slice), &mut self.cpu.scratch(), &mut regions);
        again.iter().zip(regions).for_each(|(&i, region)| out[i] = region);
        Ok(report)
    }

    fn start_of(&self, rays: &Rays<'_>, i: usize, answer: &Answer) -> Start {
        match self.sender.send(rays, i) {
            Sent::Passes => Start::Known(RegionId(0)),
            Sent::Cpu => Start::Distant,
            Sent::Device(..) if answer[0] & UNCERTAIN != 0 => Start::Uncertain,
            Sent::Device(..) => match self.layout.regions.get(answer[1] as usize) {
                Some(&region) => Start::Known(RegionId(region)),
                None => Start::Uncertain,
            },
        }
    }

    /// Destroys the device, as if its driver had been lost.
    #[cfg(test)]
    pub(crate) fn destroy(&self) {
        self.kernel.device().device.destroy();
    }

    /// Runs a kernel for all rays, batch by batch; `take` receives the answers. Returns the number of bytes moved.
    fn ask(
        &self,
        entry: Entry,
        sender: &Sender,
        rays: &Rays<'_>,
        mut take: impl FnMut(&Rays<'_>, &[Answer]),
    ) -> Result<u64, GpuError> {
        let place = match entry {
            Entry::First | Entry::Nearest => &self.others.first,
            Entry::All(_) => &self.others.all,
            Entry::Start => &self.others.start,
        };
        // a query that panicked left no answer that a later one reads
        let mut place = place.lock().unwrap_or_else(PoisonError::into_inner);
        let prepared = match place.take().filter(|known| known.entry == entry) {
            Some(known) => known,
            None => self.prepared(entry)?,
        };
        let Prepared { kernel, slot, batch, .. } = place.insert(prepared);
        let (mut answers, mut bytes) = (Vec::new(), 0);
        for first in (0..rays.len()).step_by(*batch) {
            let part = rays.slice(first..rays.len().min(first + *batch));
            let pending = kernel.start(slot, &as_bytes(sender, &part));
            kernel.finish(slot, pending, &mut answers)?;
            bytes += (part.len() * (RAY_BYTES + kernel.answer_bytes())) as u64;
            take(&part, &answers);
        }
        Ok(bytes)
    }

    /// Compiles a kernel.
    fn prepared(&self, entry: Entry) -> Result<Prepared, GpuError> {
        let kernel = Kernel::new(self.kernel.tables.clone(), &self.layout, entry)?;
        let fits = (kernel.device().limit / kernel.answer_bytes().max(RAY_BYTES) as u64) as usize;
        let batch = (BATCH / kernel.rows).clamp(1, fits.max(1));
        let slot = kernel.slot(batch)?;
        Ok(Prepared { entry, kernel, slot, batch })
    }

    /// The crossings of some rays from the rows of their answers.
    fn collect_part(
        &self,
        rays: &Rays<'_>,
        answers: &[Answer],
        (sender, query, rows): (&Sender, &Query<'_>, usize),
        scratch: &mut CpuScratch,
    ) -> (Collected, GpuReport) {
        let (mut found, mut report) = (Collected::default(), GpuReport::default());
        let mut crossings = Vec::new();
        for (i, answer) in answers.chunks_exact(rows).enumerate() {
            report.rays += 1;
            crossings.clear();
            let start = match sender.send(rays, i) {
                Sent::Passes => Some(0),
                Sent::Cpu => {
                    report.distant += 1;
                    None
                }
                Sent::Device(..) if answer[0][0] & (UNCERTAIN | MORE) != 0 => {
                    report.uncertain += 1;
                    None
                }
                Sent::Device(_, clock) => {
                    let ray = rays.get(i);
                    let predicted = answer.iter().skip(1).take(answer[0][0] as usize);
                    crossings.extend(predicted.map_while(|row| self.polished_between(&ray, row, clock)));
                    let ordered = crossings.windows(2).all(|pair: &[Crossing]| pair[0].t < pair[1].t);
                    let complete = ordered && crossings.len() == answer[0][0] as usize;
                    let shared = answer.iter().skip(1).take(answer[0][0] as usize).any(is_between);
                    match (complete, shared) {
                        (true, _) => self.layout.regions.get(answer[0][1] as usize).copied(),
                        (false, shared) => {
                            let count = if shared { &mut report.uncertain } else { &mut report.contradicted };
                            *count += 1;
                            None
                        }
                    }
                }
            };
            match start {
                Some(start) => {
                    // a settled crossing is not welded, so that those after the window change nothing
                    let end = crossings.partition_point(|crossing| crossing.t < query.window.t_max());
                    let start = RegionId(start);
                    found.ray(RayAnswer { ray: i, start, crossings: &crossings[..end] });
                }
                None => self.cpu.crossings(rays.slice(i..i + 1), query, scratch, &mut found),
            }
        }
        (found, report)
    }

    /// Like [`GpuProgram::polished`]; `None` also for a crossing between two regions at which several leaves change: each side
    /// may have a face of its own.
    fn polished_between(&self, ray: &Ray, answer: &Answer, clock: Clock) -> Option<Crossing> {
        if is_between(answer) { None } else { self.polished(ray, answer, clock) }
    }
}

/// The region of a point.
enum Start {
    Known(RegionId),
    /// The bounds do not settle it.
    Uncertain,
    /// The point is too far away for the bounds.
    Distant,
}

/// Chunks of a batch with their answers.
fn chunks<'a>(
    rays: &'a Rays<'_>,
    answers: &'a [Answer],
    rows: usize,
) -> impl Iterator<Item = (Rays<'a>, &'a [Answer])> + Send {
    let ranges = (0..rays.len()).step_by(CHUNK).map(|at| at..rays.len().min(at + CHUNK));
    ranges.map(move |range: Range<usize>| {
        let answers = &answers[range.start * rows..range.end * rows];
        (rays.slice(range), answers)
    })
}

/// The rays as the kernel reads them. A ray that is not sent has an error bound that leaves it uncertain.
fn as_bytes(sender: &Sender, rays: &Rays<'_>) -> Vec<u8> {
    let mut bytes = vec![0; RAY_BYTES * rays.len()];
    let places = bytes.chunks_mut(RAY_BYTES * CHUNK).enumerate();
    let work = |(): &mut (), (chunk, bytes): (usize, &mut [u8])| {
        for (k, place) in bytes.chunks_exact_mut(RAY_BYTES).enumerate() {
            if let Sent::Device(ray, _) = sender.send(rays, chunk * CHUNK + k) {
                place.copy_from_slice(&ray.bytes());
            }
        }
    };
    run(rays.len(), places, || (), work);
    bytes
}

/// True if several leaves change at a crossing between two regions.
fn is_between(answer: &Answer) -> bool {
    answer[0] & SHARED != 0 && answer[2] >> 16 != 0 && answer[2] & 0xffff != 0
}
