//! An evaluator for tests that counts the work of searches.

use rayweave_model::{Evaluator, Program, Query, RayAnswer, Rays, RegionId, Sink};
use rayweave_trace::Packets;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Counts rays and their crossings, and points whose regions are found.
pub(crate) struct Counted {
    inner: Packets,
    rays: AtomicU64,
    crossings: AtomicU64,
    points: AtomicU64,
}

impl Counted {
    pub fn new(program: Arc<Program>) -> Counted {
        let [rays, crossings, points] = [0; 3].map(AtomicU64::new);
        Counted { inner: Packets::new(program), rays, crossings, points }
    }

    /// The numbers of rays and points so far; they begin again from 0.
    pub fn take(&self) -> [u64; 2] {
        [&self.rays, &self.points].map(|count| count.swap(0, Ordering::Relaxed))
    }
}

impl Counted {
    /// The number of crossings so far; it begins again from 0.
    pub fn take_crossings(&self) -> u64 {
        self.crossings.swap(0, Ordering::Relaxed)
    }
}

impl Evaluator for Counted {
    type Scratch = <Packets as Evaluator>::Scratch;

    fn name(&self) -> &'static str {
        "counted"
    }

    fn program(&self) -> &Program {
        self.inner.program()
    }

    fn scratch(&self) -> Self::Scratch {
        self.inner.scratch()
    }

    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>, scratch: &mut Self::Scratch, sink: &mut dyn Sink) {
        self.rays.fetch_add(rays.len() as u64, Ordering::Relaxed);
        let mut counting = |answer: RayAnswer<'_>| {
            self.crossings.fetch_add(answer.crossings.len() as u64, Ordering::Relaxed);
            sink.ray(answer);
        };
        self.inner.crossings(rays, query, scratch, &mut counting);
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut Self::Scratch, out: &mut [RegionId]) {
        self.points.fetch_add(out.len() as u64, Ordering::Relaxed);
        self.inner.regions_at(points, scratch, out);
    }
}
