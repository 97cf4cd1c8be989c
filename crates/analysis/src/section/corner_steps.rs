//! Steps over corners: the changes between two scan lines that cross flat faces only, by short parts of scan lines at each corner.
//!
//! Flat faces are crossed in straight lines, so that only the crossings at the corners between two scan lines need rays. The crossings
//! of the left scan line, changed at each corner, must be those of the right one, and those of a scan line in the middle if the gap is
//! wide. A whole scan line on both sides of each corner would take time in proportion to the square of the number of corners.

use super::corners::{Corner, Corners};
use super::scan_line::{ScanCrossing, ScanLine};
use super::tracer::ScanLineTracer;
use rayweave_model::{Evaluator, RegionId};
use rayweave_shape::surface::Surface;

/// The change of the crossings at a corner.
#[derive(Clone, Debug)]
pub struct CornerStep {
    /// The number of crossings below the corner.
    pub first: usize,
    /// The region below the corner.
    pub below: RegionId,
    /// The crossings at the corner, on both sides of it.
    pub sides: [ScanLine; 2],
}

impl CornerStep {
    /// The memory that it takes.
    pub fn bytes(&self) -> u64 {
        let crossings: usize = self.sides.iter().map(|side| size_of_val(side.passes.as_slice())).sum();
        (size_of::<CornerStep>() + crossings) as u64
    }
}

/// The most corners of a gap: one with more is divided.
const MAX_CORNERS: usize = 4096;

/// The search for steps in gaps.
pub struct CornerSteps<'a, E: Evaluator> {
    pub corners: Corners<'a>,
    pub tracer: ScanLineTracer<'a, E>,
    /// A gap wider than this needs a scan line in the middle.
    pub sampled: f64,
}

impl<E: Evaluator> CornerSteps<'_, E> {
    /// True if all faces of a scan line are flat.
    pub fn may_step(&self, scan_line: &ScanLine) -> bool {
        scan_line.passes.iter().all(|pass| self.is_flat(pass))
    }

    fn is_flat(&self, pass: &ScanCrossing) -> bool {
        let program = self.corners.program;
        pass.face.is_some_and(|face| matches!(program.surface(face.surface).surface, Surface::Plane(_)))
    }

    /// The steps from one scan line to another, in ascending order; `None` if they do not explain all differences.
    pub fn between(
        &self,
        left: &ScanLine,
        right: &ScanLine,
        scratch: &mut E::Scratch,
    ) -> Option<Vec<CornerStep>> {
        if !self.may_step(left) || !self.may_step(right) {
            return None;
        }
        let corners = merged(self.corners.of_flat_faces(left, right)?)?;
        if corners.is_empty() {
            return None;
        }
        let (ends, places) = (self.tracer.ends(), [0.5 * (left.u + right.u)]);
        let middle = match right.u - left.u > self.sampled {
            true => self.tracer.scan_lines(&places, scratch).pop(),
            false => None,
        };
        let mut middle = middle.iter().peekable();
        let mut front = Front { corners: &self.corners, passes: left.passes.clone(), order: Vec::new() };
        front.order = (0..front.passes.len() as u32).collect();
        let mut steps = Vec::new();
        for corner in &corners {
            if let Some(middle) = middle.next_if(|middle| middle.u < corner.between[1]) {
                let is_beside = middle.u < corner.between[0];
                (is_beside && front.is_like(middle)).then_some(())?;
            }
            let place = front.place(corner, ends)?;
            let mut parts = self.tracer.parts(&corner.between, place.ends, scratch);
            let (Some((below, after)), Some((start, before))) = (parts.pop(), parts.pop()) else {
                return None;
            };
            let is_known = start == place.below && below == place.below && front.has(&place, &before);
            let above = after.passes.last().map_or(below, |last| last.after);
            (is_known && above == place.above && self.may_step(&after)).then_some(())?;
            if front.has(&place, &after) {
                continue;
            }
            let first = place.passes.start;
            front.replace(&place, &after.passes);
            steps.push(CornerStep { first, below, sides: [before, after] });
        }
        let is_explained = middle.all(|middle| front.is_like(middle)) && front.is_like(right);
        is_explained.then_some(steps)
    }
}

/// The corners without repetitions: those within rounding of each other are one. `None` if there are too many.
fn merged(corners: Vec<Corner>) -> Option<Vec<Corner>> {
    let mut found: Vec<Corner> = Vec::with_capacity(corners.len());
    // those before it end left of all further corners
    let mut first = 0;
    for corner in corners {
        while found.get(first).is_some_and(|own| own.between[1] < corner.between[0]) {
            first += 1;
        }
        let is_same = |own: &&mut Corner| (own.v - corner.v).abs() <= own.reach + corner.reach;
        match found[first..].iter_mut().find(is_same) {
            Some(own) => {
                own.between[1] = own.between[1].max(corner.between[1]);
                own.reach = own.reach.max(corner.reach) + (own.v - corner.v).abs();
            }
            None => found.push(corner),
        }
        if found.len() > MAX_CORNERS || found.len() - first > super::corners::MAX_CORNERS {
            return None;
        }
    }
    Some(found)
}

/// The crossings of a scan line that moves across a gap.
struct Front<'a> {
    corners: &'a Corners<'a>,
    /// All crossings so far.
    passes: Vec<ScanCrossing>,
    /// The numbers of the present ones, from bottom to top.
    order: Vec<u32>,
}

/// The crossings at a corner, the part of a scan line around them, and the regions at its ends.
struct Place {
    passes: std::ops::Range<usize>,
    ends: [f64; 2],
    below: RegionId,
    above: RegionId,
}

impl Front<'_> {
    fn get(&self, k: usize) -> Option<&ScanCrossing> {
        self.passes.get(*self.order.get(k)? as usize)
    }

    /// The coordinate along a scan line at which it crosses the face of a crossing.
    fn v(&self, k: usize, u: f64) -> Option<f64> {
        let [a, b, c] = self.corners.line(self.get(k)?.face?)?;
        Some((c - a * u) / b)
    }

    /// The number of crossings below a coordinate.
    fn below(&self, u: f64, v: f64) -> Option<usize> {
        let (mut lo, mut hi) = (0, self.order.len());
        while lo < hi {
            let middle = (lo + hi) / 2;
            match self.v(middle, u)? < v {
                true => lo = middle + 1,
                false => hi = middle,
            }
        }
        Some(lo)
    }

    fn place(&self, corner: &Corner, [lowest, highest]: [f64; 2]) -> Option<Place> {
        let u = corner.between[0];
        // twice: the coordinate of the corner has the rounding errors of its computation as well
        let [lo, hi] = [-2.0, 2.0].map(|k| corner.v + k * corner.reach);
        let passes = self.below(u, lo)?..self.below(u, hi)?;
        let before = passes.start.checked_sub(1);
        let lo = before.map_or(Some(lowest), |k| Some(0.5 * (self.v(k, u)? + lo)))?;
        let hi = match passes.end < self.order.len() {
            true => 0.5 * (self.v(passes.end, u)? + hi),
            false => highest,
        };
        let below = before.and_then(|k| self.get(k)).map_or(RegionId(0), |pass| pass.after);
        let above = self.get(passes.end).map_or(RegionId(0), |pass| pass.before);
        (lo < hi).then_some(Place { passes, ends: [lo, hi], below, above })
    }

    /// True if the crossings at a place are those of a part of a scan line.
    fn has(&self, place: &Place, part: &ScanLine) -> bool {
        let own = place.passes.clone().map(|k| self.get(k));
        place.passes.len() == part.passes.len()
            && own.zip(&part.passes).all(|(own, pass)| own.is_some_and(|own| own.is_like(pass)))
    }

    fn replace(&mut self, place: &Place, passes: &[ScanCrossing]) {
        let first = self.passes.len() as u32;
        self.passes.extend_from_slice(passes);
        self.order.splice(place.passes.clone(), first..self.passes.len() as u32);
    }

    fn is_like(&self, scan_line: &ScanLine) -> bool {
        let own = (0..self.order.len()).map(|k| self.get(k));
        self.order.len() == scan_line.passes.len()
            && own.zip(&scan_line.passes).all(|(own, pass)| own.is_some_and(|own| own.is_like(pass)))
    }
}
