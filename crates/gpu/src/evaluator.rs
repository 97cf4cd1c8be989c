//! A model on a device as part of an evaluator.

use crate::error::GpuError;
use crate::program::{GpuProgram, GpuReport};
use rayweave_model::{Collected, FirstHits, PixelRays, Query, RayAnswer, Rays, RegionId, Window};
use rayweave_trace::RayDevice;
use std::num::NonZeroUsize;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The number of rays per batch: a few milliseconds of work of a fast card, and few enough for several batches per picture.
const BATCH: NonZeroUsize = NonZeroUsize::new(1 << 16).unwrap();

/// Crossings of a ray that the device returns; rays with more are traced by the CPU.
const MOST: NonZeroUsize = NonZeroUsize::new(16).unwrap();

/// A [`GpuProgram`] as the device of an evaluator: [`Accelerated`](rayweave_trace::Accelerated) passes its queries to it.
///
/// Evaluators cannot fail, and devices can. After the first problem the device answers no more queries, so that the CPU traces
/// the rest, with the same answers; [`GpuDevice::problem`] then states the reason.
#[derive(Debug)]
pub struct GpuDevice {
    program: GpuProgram,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    report: GpuReport,
    problem: Option<GpuError>,
}

impl GpuDevice {
    /// The device of a program.
    pub fn new(program: GpuProgram) -> GpuDevice {
        GpuDevice { program, state: Mutex::default() }
    }

    /// The program.
    pub fn program(&self) -> &GpuProgram {
        &self.program
    }

    /// The costs of all queries so far.
    pub fn report(&self) -> GpuReport {
        self.state().report
    }

    /// The problem after which the device answered no more queries.
    pub fn problem(&self) -> Option<GpuError> {
        self.state().problem.clone()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // the state is consistent after every statement
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The result of a query, unless the device has failed before.
    fn ask<T>(&self, query: impl FnOnce(&GpuProgram) -> Result<(T, GpuReport), GpuError>) -> Option<T> {
        if self.state().problem.is_some() {
            return None;
        }
        let answer = query(&self.program);
        let mut state = self.state();
        match answer {
            Ok((answer, report)) => {
                state.report.add(report);
                Some(answer)
            }
            // the caller checks its rays; the answer to others is arbitrary
            Err(GpuError::Ray(_)) => None,
            Err(problem) => {
                state.problem.get_or_insert(problem);
                None
            }
        }
    }
}

impl RayDevice for GpuDevice {
    fn batch(&self) -> NonZeroUsize {
        BATCH
    }

    fn nearest(&self, rays: Rays<'_>, window: Window, hits: &mut FirstHits<'_>) -> bool {
        if window == Query::nearest().window {
            return self.ask(|gpu| gpu.nearest(rays, hits).map(|report| ((), report))).is_some();
        }
        let query = Query { window, ..Query::nearest() };
        let Some(found) = self.crossings(rays, &query) else { return false };
        let program = self.program.program();
        for (ray, &start) in found.starts.iter().enumerate() {
            hits.put(program, &rays, &RayAnswer { ray, start, crossings: found.of(ray) });
        }
        true
    }

    fn nearest_through(
        &self,
        (pixels, rays): (&PixelRays<'_>, Rays<'_>),
        window: Window,
        hits: &mut FirstHits<'_>,
    ) -> bool {
        if window != Query::nearest().window {
            return self.nearest(rays, window, hits);
        }
        self.ask(|gpu| gpu.nearest(*pixels, hits).map(|report| ((), report))).is_some()
    }

    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>) -> Option<Collected> {
        self.ask(|gpu| gpu.collect(rays, query, MOST))
    }

    fn regions_at(&self, points: [&[f64]; 3], out: &mut [RegionId]) -> bool {
        self.ask(|gpu| gpu.regions_at(points, out).map(|report| ((), report))).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapter::Gpu;
    use rayweave_math::Vec3;
    use rayweave_model::{Evaluator, Program, RayBatch};
    use rayweave_shape::Ray;
    use rayweave_shape::primitive::build;
    use rayweave_trace::{Accelerated, Packets};
    use std::sync::Arc;

    /// The CPU answers after the device is lost, and the reason is kept. Skipped with a message where there is no adapter.
    #[test]
    fn a_lost_device_is_reported_and_the_cpu_answers() {
        let gpu = Gpu::new();
        let adapter = match gpu.adapter(0) {
            Ok(adapter) => adapter,
            Err(problem) => return rayweave_conformance::skipped(problem),
        };
        let ball = build("sphere", &[("radius", 1.0.into())]).unwrap();
        let program = Arc::new(Program::compile(&ball.into()).unwrap());
        let device = Arc::new(GpuDevice::new(GpuProgram::new(adapter, program.clone()).unwrap()));
        let evaluator = Accelerated::new(program.clone(), device.clone());
        let rays: RayBatch =
            (0..50).map(|k| Ray::new(Vec3::new(-5.0, 0.05 * f64::from(k), 0.0), Vec3::X)).collect();
        let cpu = Packets::new(program).collect(rays.rays(), &Query::default()).unwrap();
        assert_eq!(evaluator.collect(rays.rays(), &Query::default()).unwrap(), cpu);
        assert_eq!((device.report().rays, device.problem()), (50, None));
        device.program().destroy();
        assert_eq!(evaluator.collect(rays.rays(), &Query::default()).unwrap(), cpu);
        let problem = device.problem().unwrap();
        assert!(matches!(problem, GpuError::Lost { .. }), "{problem}");
        assert!(problem.to_string().contains("was lost: the driver gives no reason"), "{problem}");
        assert!(evaluator.contains(Vec3::ZERO).unwrap());
        assert_eq!(device.report().rays, 50);
    }
}
