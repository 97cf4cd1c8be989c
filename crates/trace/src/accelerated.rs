//! An evaluator that passes batches to a device, such as a graphics card, and answers everything else on the CPU.

use crate::packets::{Packets, PacketsScratch};
use rayweave_model::{
    Collected, Evaluator, FirstHits, PixelRays, Program, Query, RayAnswer, Rays, RegionId, Sink, StartLists,
    Window,
};
use std::fmt::Debug;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// A device that answers queries about one program with the answers of every [`Evaluator`], bit for bit.
///
/// A method that cannot answer says so, and [`Accelerated`] asks the CPU. The rays have no start lists.
pub trait RayDevice: Debug + Send + Sync {
    /// The number of rays per batch that keeps the device busy.
    fn batch(&self) -> NonZeroUsize;

    /// Fills the columns with the first crossing of each ray in the window, like [`Evaluator::nearest`]. Returns false if it
    /// cannot; the columns are then arbitrary.
    fn nearest(&self, rays: Rays<'_>, window: Window, hits: &mut FirstHits<'_>) -> bool;

    /// Fills the columns like [`RayDevice::nearest`] for rays through pixels, which the device can compute from their description.
    /// `rays` has the same rays as arrays.
    fn nearest_through(
        &self,
        (_, rays): (&PixelRays<'_>, Rays<'_>),
        window: Window,
        hits: &mut FirstHits<'_>,
    ) -> bool {
        self.nearest(rays, window, hits)
    }

    /// Computes the crossings of each ray, like [`Evaluator::crossings`]; `None` if it cannot.
    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>) -> Option<Collected>;

    /// Computes the region of each point, like [`Evaluator::regions_at`]. Returns false if it cannot; `out` is then arbitrary.
    fn regions_at(&self, points: [&[f64]; 3], out: &mut [RegionId]) -> bool;
}

/// An evaluator that passes queries to a device, and to [`Packets`] where the device cannot answer them.
#[derive(Clone, Debug)]
pub struct Accelerated {
    cpu: Packets,
    device: Arc<dyn RayDevice>,
}

impl Accelerated {
    /// The evaluator of a program with a device that holds the same program.
    pub fn new(program: Arc<Program>, device: Arc<dyn RayDevice>) -> Accelerated {
        Accelerated { cpu: Packets::new(program), device }
    }
}

impl Evaluator for Accelerated {
    type Scratch = PacketsScratch;

    fn name(&self) -> &'static str {
        "device"
    }

    fn program(&self) -> &Program {
        self.cpu.program()
    }

    fn scratch(&self) -> PacketsScratch {
        self.cpu.scratch()
    }

    fn preferred_batch(&self) -> Option<NonZeroUsize> {
        Some(self.device.batch())
    }

    fn crossings(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut PacketsScratch,
        sink: &mut dyn Sink,
    ) {
        let found = if has_starts(query) { None } else { self.device.crossings(rays, query) };
        let Some(found) = found else { return self.cpu.crossings(rays, query, scratch, sink) };
        for (ray, &start) in found.starts.iter().enumerate() {
            sink.ray(RayAnswer { ray, start, crossings: found.of(ray) });
        }
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut PacketsScratch, out: &mut [RegionId]) {
        if !self.device.regions_at(points, out) {
            self.cpu.regions_at(points, scratch, out);
        }
    }

    fn nearest(
        &self,
        rays: Rays<'_>,
        window: Window,
        scratch: &mut PacketsScratch,
        hits: &mut FirstHits<'_>,
    ) {
        if !self.device.nearest(rays, window, hits) {
            self.cpu.nearest(rays, window, scratch, hits);
        }
    }

    fn nearest_through(
        &self,
        (pixels, rays): (&PixelRays<'_>, Rays<'_>),
        window: Window,
        scratch: &mut PacketsScratch,
        hits: &mut FirstHits<'_>,
    ) {
        if !self.device.nearest_through((pixels, rays), window, hits) {
            self.cpu.nearest(rays, window, scratch, hits);
        }
    }
}

/// True if a ray of the query starts on a surface.
fn has_starts(query: &Query<'_>) -> bool {
    query.starts.is_some_and(|StartLists { entries, .. }| !entries.is_empty())
}
