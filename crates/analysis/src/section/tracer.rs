//! Rays along scan lines.

use super::scan_line::{ScanCrossing, ScanLine};
use super::{Cut, SectionWindow};
use rayweave_model::{Crossing, Evaluator, Query, RayAnswer, RayBatch, RegionId, Window};
use rayweave_shape::Ray;

/// The query of scan lines.
pub struct ScanLineTracer<'a, E: Evaluator> {
    evaluator: &'a E,
    cut: &'a Cut,
    ends: [f64; 2],
}

impl<'a, E: Evaluator> ScanLineTracer<'a, E> {
    pub fn new(evaluator: &'a E, cut: &'a Cut, window: &SectionWindow) -> ScanLineTracer<'a, E> {
        ScanLineTracer { evaluator, cut, ends: [window.lo[1], window.hi[1]] }
    }

    /// The coordinates of the ends of scan lines.
    pub fn ends(&self) -> [f64; 2] {
        self.ends
    }

    /// The scan lines at some positions.
    pub fn scan_lines(&self, places: &[f64], scratch: &mut E::Scratch) -> Vec<ScanLine> {
        let mut scan_lines = Vec::with_capacity(places.len());
        self.trace(places, self.ends, scratch, &mut |answer| {
            scan_lines.push(scan_line(places[answer.ray], self.ends, answer));
        });
        scan_lines
    }

    /// The parts of scan lines between two coordinates along them, with the region at the lower one.
    pub fn parts(
        &self,
        places: &[f64],
        ends: [f64; 2],
        scratch: &mut E::Scratch,
    ) -> Vec<(RegionId, ScanLine)> {
        let mut parts = Vec::with_capacity(places.len());
        self.trace(places, ends, scratch, &mut |answer| {
            let passes = answer.crossings.iter().map(scan_crossing).collect();
            parts.push((answer.start, ScanLine { u: places[answer.ray], passes }));
        });
        parts
    }

    fn trace(
        &self,
        places: &[f64],
        ends: [f64; 2],
        scratch: &mut E::Scratch,
        take: &mut dyn FnMut(&RayAnswer<'_>),
    ) {
        let mut batch = RayBatch::default();
        let direction = self.cut.point([0.0, 1.0]) - self.cut.point([0.0, 0.0]);
        places.iter().for_each(|&u| batch.push(Ray::new(self.cut.point([u, 0.0]), direction)));
        // the window was checked before
        let window = Window::new(ends[0], ends[1]).unwrap_or(Window::ALL);
        let query = Query { window, ..Query::default() };
        let mut sink = |answer: RayAnswer<'_>| take(&answer);
        self.evaluator.crossings(batch.rays(), &query, scratch, &mut sink);
    }
}

fn scan_crossing(crossing: &Crossing) -> ScanCrossing {
    let Crossing { t, before, after, face, .. } = *crossing;
    ScanCrossing { v: t, before, after, face: Some(face) }
}

/// The crossings of a ray, with the world beyond both ends of the window.
fn scan_line(u: f64, [lo, hi]: [f64; 2], answer: &RayAnswer<'_>) -> ScanLine {
    let world = RegionId(0);
    let end = |v: f64, before: RegionId, after: RegionId| ScanCrossing { v, before, after, face: None };
    let mut passes = Vec::new();
    passes.extend((answer.start != world).then(|| end(lo, world, answer.start)));
    passes.extend(answer.crossings.iter().map(scan_crossing));
    let last = passes.last().map_or(world, |pass: &ScanCrossing| pass.after);
    passes.extend((last != world).then(|| end(hi, last, world)));
    ScanLine { u, passes }
}
