//! Queries other than the nearest crossing from t = 0: windows, all crossings, and the regions of points.

use super::{GpuProgram, GpuReport, Worker};
use crate::codes::{MORE, SHARED, UNCERTAIN};
use crate::error::GpuError;
use crate::frame::{Clock, Route, Sender};
use crate::kernel::{Answer, Kernel};
use crate::shader::Entry;
use rayweave_math::Vec3;
use rayweave_model::{
    Collected, Crossing, Evaluator, Limit, Query, RayAnswer, RayBatch, Rays, RegionId, Sink,
};
use rayweave_shape::Ray;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::{Arc, PoisonError};

/// The direction of the rays that start at the points of a query for regions. Any is valid; this unit vector is parallel to no
/// axis, diagonal or coordinate plane, along which models have most of their faces.
const DIRECTION: Vec3 = Vec3::new(0.48, 0.6, 0.64);

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
        let (mut collected, mut report) = (Collected::default(), GpuReport::default());
        if query.starts.is_some_and(|starts| !starts.entries.is_empty()) {
            self.program.check_rays(rays)?;
            self.cpu.crossings(rays, query, &mut self.cpu.scratch(), &mut collected);
            report.rays = rays.len() as u64;
            report.distant = report.rays;
            return Ok((collected, report));
        }
        let kernel = self.kernel_of(match query.limit {
            Limit::First => Entry::First,
            Limit::All => Entry::All(most.get()),
        })?;
        let sender = Sender { from: query.window.t_min(), ..self.sender };
        let batch = self.batch(rays.len(), &kernel);
        let ranges = (0..rays.len()).step_by(batch).map(|at| at..rays.len().min(at + batch));
        let work = |worker: &mut Worker, range: Range<usize>| {
            self.collect_part(&rays, range, ((&kernel, &sender), query), worker)
        };
        for part in self.run(ranges, work) {
            let (found, cost) = part?;
            collected.append(&found);
            report.add(cost);
        }
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
        let kernel = self.kernel_of(Entry::Start)?;
        let batch = self.batch(out.len(), &kernel);
        let chunks = out.chunks_mut(batch).enumerate();
        let work = |worker: &mut Worker, (k, out): (usize, &mut [RegionId])| {
            let points = points.map(|column| &column[k * batch..k * batch + out.len()]);
            self.regions_of((points, k * batch), &kernel, out, worker)
        };
        let mut report = GpuReport::default();
        for cost in self.run(chunks, work) {
            report.add(cost?);
        }
        Ok(report)
    }

    /// The regions of a batch of points, the first of which has the number `first`, through rays that start there.
    fn regions_of(
        &self,
        (points, first): ([&[f64]; 3], usize),
        kernel: &Kernel,
        out: &mut [RegionId],
        worker: &mut Worker,
    ) -> Result<GpuReport, GpuError> {
        let at = |i: usize| Vec3::new(points[0][i], points[1][i], points[2][i]);
        let rays: RayBatch = (0..out.len()).map(|i| Ray::new(at(i), DIRECTION)).collect();
        let mut report =
            self.answers((kernel, &self.sender), (&rays.rays().into(), 0..rays.len()), first, worker)?;
        worker.again.clear();
        for (i, (route, answer)) in worker.routes.iter().zip(&worker.answers).enumerate() {
            let known = match *route {
                Route::Passes => Some(0),
                Route::Cpu => None,
                Route::Device(_) if answer[0] & UNCERTAIN != 0 => None,
                Route::Device(_) => self.layout.regions.get(answer[1] as usize).copied(),
            };
            match (known, route) {
                (Some(region), _) => {
                    out[i] = RegionId(region);
                    continue;
                }
                (None, Route::Cpu) => report.distant += 1,
                (None, _) => report.uncertain += 1,
            }
            worker.again.push(i);
        }
        let again = points.map(|column| worker.again.iter().map(|&i| column[i]).collect::<Vec<_>>());
        let mut regions = vec![RegionId(0); worker.again.len()];
        let scratch = worker.scratch.get_or_insert_with(|| self.cpu.scratch());
        self.cpu.regions_at(again.each_ref().map(Vec::as_slice), scratch, &mut regions);
        worker.again.iter().zip(regions).for_each(|(&i, region)| out[i] = region);
        Ok(report)
    }

    /// Destroys the device, as if its driver had been lost.
    #[cfg(test)]
    pub(crate) fn destroy(&self) {
        self.kernel.device().device.destroy();
    }

    /// The kernel with an entry point, compiled unless it was the last of its kind.
    pub(super) fn kernel_of(&self, entry: Entry) -> Result<Arc<Kernel>, GpuError> {
        let place = match entry {
            Entry::First | Entry::Nearest | Entry::Completed => &self.others.first,
            Entry::Pixels => &self.others.pixels,
            Entry::All(_) => &self.others.all,
            Entry::Start => &self.others.start,
        };
        let mut place = place.lock().unwrap_or_else(PoisonError::into_inner);
        match &*place {
            Some((known, kernel)) if *known == entry => Ok(kernel.clone()),
            _ => {
                let kernel = Kernel::new(self.kernel.tables.clone(), &self.layout, entry)?;
                Ok(place.insert((entry, Arc::new(kernel))).1.clone())
            }
        }
    }

    /// The crossings of a batch.
    fn collect_part(
        &self,
        rays: &Rays<'_>,
        range: Range<usize>,
        (device, query): ((&Kernel, &Sender), &Query<'_>),
        worker: &mut Worker,
    ) -> Result<(Collected, GpuReport), GpuError> {
        let first = range.start;
        let rays = rays.slice(range);
        let mut report = self.answers(device, (&rays.into(), 0..rays.len()), first, worker)?;
        let Worker { routes, answers, scratch, .. } = worker;
        let scratch = scratch.get_or_insert_with(|| self.cpu.scratch());
        let (mut found, mut crossings) = (Collected::default(), Vec::new());
        for (i, (route, answer)) in routes.iter().zip(answers.chunks_exact(device.0.rows)).enumerate() {
            crossings.clear();
            let start = match *route {
                Route::Passes => Some(0),
                Route::Cpu => {
                    report.distant += 1;
                    None
                }
                Route::Device(_) if answer[0][0] & (UNCERTAIN | MORE) != 0 => {
                    report.uncertain += 1;
                    None
                }
                Route::Device(clock) => {
                    let ray = rays.get(i);
                    let predicted = answer.iter().skip(1).take(answer[0][0] as usize);
                    let shared = predicted.clone().any(is_between);
                    crossings.extend(predicted.map_while(|row| self.polished_between(&ray, row, clock)));
                    let ordered = crossings.windows(2).all(|pair: &[Crossing]| pair[0].t < pair[1].t);
                    if ordered && crossings.len() == answer[0][0] as usize {
                        self.layout.regions.get(answer[0][1] as usize).copied()
                    } else {
                        *(if shared { &mut report.uncertain } else { &mut report.contradicted }) += 1;
                        None
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
        Ok((found, report))
    }

    /// Like [`GpuProgram::polished`]; `None` also for a crossing between two regions at which several leaves change: each side
    /// may have a face of its own.
    fn polished_between(&self, ray: &Ray, answer: &Answer, clock: Clock) -> Option<Crossing> {
        if is_between(answer) { None } else { self.polished(ray, answer, clock) }
    }
}

/// True if several leaves change at a crossing between two regions.
fn is_between(answer: &Answer) -> bool {
    answer[0] & SHARED != 0 && answer[2] >> 16 != 0 && answer[2] & 0xffff != 0
}
