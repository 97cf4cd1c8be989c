//! Where a curve is: boxes that hold its pieces, against which leaves are tested.

use crate::isolate::{Motion, checked_bound};
use crate::model::view::View;
use crate::point::length;
use crate::{Curve, CurveError};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::MARGIN;
use std::collections::VecDeque;

/// Boxes around the pieces of a curve, in the world.
pub struct Boxes {
    pieces: Vec<Bounds>,
    /// The largest size of the curve that was met: its share in the growth of boxes.
    size: f64,
}

/// No more pieces than this: they are compared with every leaf.
const MOST: usize = 64;

impl Boxes {
    /// Boxes of pieces that are halved until they are nearly straight, or there are enough of them.
    pub fn new(curve: &dyn Curve<3>, t0: f64, t1: f64) -> Result<Boxes, CurveError> {
        let mut boxes = Boxes { pieces: Vec::new(), size: 0.0 };
        let mut waiting = VecDeque::from([(Motion::at(curve, t0)?, Motion::at(curve, t1)?)]);
        while let Some((a, b)) = waiting.pop_front() {
            let piece = Straight::new(curve, &a, &b, t1 - t0)?;
            let middle = piece.middle;
            boxes.size = boxes.size.max(a.size).max(b.size).max(middle.size);
            let room = boxes.pieces.len() + waiting.len() + 2 <= MOST;
            if room && piece.worth_halving() && a.t < middle.t && middle.t < b.t {
                waiting.extend([(a, middle), (middle, b)]);
            } else {
                boxes.pieces.push(piece.bounds());
            }
        }
        Ok(boxes)
    }

    /// True if the curve may pass a box of a group, grown by what carrying the curve there can err: see
    /// [`rayweave_model::Prototype::condition`].
    pub fn meet(&self, bounds: &Bounds, condition: f64, view: &View<'_>) -> bool {
        if bounds.is_empty() {
            return false;
        }
        let stretch = view.map.stretch();
        let margin = MARGIN * condition * (stretch * self.size + view.map.translation.length() + view.reach);
        let grown = bounds.grown(margin);
        self.pieces.iter().any(|piece| !piece.transformed(&view.map).intersection(&grown).is_empty())
    }
}

/// A piece by its tangent in the middle and how far it may be from it.
struct Straight {
    middle: Motion<3>,
    along: Vec3,
    stray: f64,
}

impl Straight {
    fn new(curve: &dyn Curve<3>, a: &Motion<3>, b: &Motion<3>, span: f64) -> Result<Straight, CurveError> {
        let middle = Motion::at(curve, 0.5 * a.t + 0.5 * b.t)?;
        let bound = checked_bound(curve, [a, &middle, b], span)?;
        let h = (b.t - middle.t).max(middle.t - a.t).next_up();
        let along = Vec3::from_array(middle.velocity).abs() * h;
        Ok(Straight { middle, along, stray: 0.5 * bound * h * h })
    }

    fn bounds(&self) -> Bounds {
        let half = self.along + Vec3::splat(self.stray);
        // a box too large for numbers is all of space
        let bounds = Bounds::centred(Vec3::from_array(self.middle.position), half);
        if half.is_finite() { bounds } else { Bounds::ALL }
    }

    /// Half as long it may be much smaller: a piece parallel to an axis alone is not.
    fn worth_halving(&self) -> bool {
        let longest = self.along.max_element();
        length(&self.along.to_array()) > 1.01 * longest || self.stray > 0.01 * longest
    }
}
