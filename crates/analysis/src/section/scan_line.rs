//! One scan line: a ray in the plane with its crossings.

use super::{Cut, SectionWindow};
use rayweave_math::Vec3;
use rayweave_model::{Crossing, Evaluator, Query, RayAnswer, RayBatch, RegionId, Window, attributes};
use rayweave_shape::Ray;

/// A crossing of a scan line from one region into another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanCrossing {
    /// The coordinate along the scan line.
    pub v: f64,
    pub before: RegionId,
    pub after: RegionId,
    /// The leaf and the facet; `None` at the ends of the window.
    face: Option<(u32, u32)>,
    /// The slope of the edge: the change of `v` across the scan lines. NaN if it is not known.
    pub slope: f64,
}

impl ScanCrossing {
    /// True for crossings between the same regions through the same face.
    pub fn is_like(&self, other: &ScanCrossing) -> bool {
        (self.before, self.after, self.face) == (other.before, other.after, other.face)
    }
}

/// A ray in the plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScanLine {
    pub u: f64,
    /// The crossings from bottom to top; below the first and above the last is the world.
    pub passes: Vec<ScanCrossing>,
}

impl ScanLine {
    /// The memory of its crossings, in bytes.
    pub fn size(&self) -> u64 {
        (self.passes.len() * size_of::<ScanCrossing>()) as u64
    }
}

/// The window of scan lines, along them, with the regions at its ends.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub ends: [f64; 2],
    pub below: RegionId,
    pub above: RegionId,
}

/// The query of scan lines.
pub struct ScanLineTracer<'a, E: Evaluator> {
    evaluator: &'a E,
    cut: &'a Cut,
    /// The whole window.
    pub frame: Frame,
    /// The direction of the rays, and that across them.
    along: Vec3,
    across: Vec3,
}

impl<'a, E: Evaluator> ScanLineTracer<'a, E> {
    pub fn new(evaluator: &'a E, cut: &'a Cut, window: &SectionWindow) -> ScanLineTracer<'a, E> {
        let frame = Frame { ends: [window.lo[1], window.hi[1]], below: RegionId(0), above: RegionId(0) };
        let [across, along] = [[1.0, 0.0], [0.0, 1.0]].map(|axis| cut.point(axis) - cut.point([0.0; 2]));
        ScanLineTracer { evaluator, cut, frame, along, across }
    }

    /// The scan lines of the whole window at some positions.
    pub fn scan_lines(&self, places: &[f64], scratch: &mut E::Scratch) -> Vec<ScanLine> {
        let mut batch = RayBatch::default();
        places.iter().for_each(|&u| batch.push(self.ray(u)));
        // the window was checked before
        let [lo, hi] = self.frame.ends;
        let window = Window::new(lo, hi).unwrap_or(Window::ALL);
        let query = Query { window, ..Query::default() };
        let mut scan_lines = Vec::with_capacity(places.len());
        let mut take =
            |answer: RayAnswer<'_>| scan_lines.push(scan_line(places[answer.ray], &self.frame, &answer));
        self.evaluator.crossings(batch.rays(), &query, scratch, &mut take);
        scan_lines
    }

    fn ray(&self, u: f64) -> Ray {
        Ray::new(self.cut.point([u, 0.0]), self.along)
    }

    /// The scan line at `u` within a frame, with the slopes of the edges; `None` if the regions at its ends are not those of the
    /// frame.
    pub fn within(&self, u: f64, frame: &Frame, scratch: &mut E::Scratch) -> Option<ScanLine> {
        let (ray, mut batch) = (self.ray(u), RayBatch::default());
        batch.push(ray);
        let query = Query { window: Window::new(frame.ends[0], frame.ends[1]).ok()?, ..Query::default() };
        let mut found = None;
        let mut take = |answer: RayAnswer<'_>| {
            let mut own = scan_line(u, frame, &answer);
            let is_end = |pass: Option<&ScanCrossing>| pass.is_some_and(|pass| pass.face.is_none());
            let at_ends = [is_end(own.passes.first()), is_end(own.passes.last())];
            let is_cut = (0..2).any(|k| at_ends[k] && frame.ends[k] != self.frame.ends[k]);
            let passes = own.passes.iter_mut().skip(usize::from(at_ends[0]));
            let slopes = answer.crossings.iter().map(|crossing| self.slope(&ray, crossing));
            passes.zip(slopes).for_each(|(pass, slope)| pass.slope = slope);
            found = (!is_cut).then_some(own);
        };
        self.evaluator.crossings(batch.rays(), &query, scratch, &mut take);
        found
    }

    /// The slope of the edge at a crossing.
    fn slope(&self, ray: &Ray, crossing: &Crossing) -> f64 {
        let normal = attributes::normal(self.evaluator.program(), ray, crossing);
        -normal.dot(self.across) / normal.dot(self.along)
    }
}

/// The crossings of a ray, with the regions of the frame beyond both of its ends.
fn scan_line(u: f64, frame: &Frame, answer: &RayAnswer<'_>) -> ScanLine {
    let pass = |v: f64, [before, after]: [RegionId; 2], face| ScanCrossing {
        v,
        before,
        after,
        face,
        slope: f64::NAN,
    };
    let mut passes = Vec::new();
    passes.extend(
        (answer.start != frame.below).then(|| pass(frame.ends[0], [frame.below, answer.start], None)),
    );
    passes.extend(answer.crossings.iter().map(|crossing| {
        let face = (crossing.face.leaf.0, crossing.face.facet);
        pass(crossing.t, [crossing.before, crossing.after], Some(face))
    }));
    let last = passes.last().map_or(frame.below, |pass: &ScanCrossing| pass.after);
    passes.extend((last != frame.above).then(|| pass(frame.ends[1], [last, frame.above], None)));
    ScanLine { u, passes }
}
