//! Where a curve is: boxes that hold its pieces, against which leaves are tested.

use crate::Curve;
use crate::curve::CurveError;
use crate::model::view::View;
use crate::point::{is_finite, length};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::MARGIN;

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
        let mut waiting = std::collections::VecDeque::from([(t0, t1)]);
        while let Some((a, b)) = waiting.pop_front() {
            let piece = Straight::new(curve, a, b)?;
            boxes.size = boxes.size.max(curve.size(a)).max(curve.size(b)).max(curve.size(piece.t));
            let room = boxes.pieces.len() + waiting.len() + 2 <= MOST;
            if room && piece.worth_halving() && a < piece.t && piece.t < b {
                waiting.extend([(a, piece.t), (piece.t, b)]);
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
    t: f64,
    at: Vec3,
    along: Vec3,
    stray: f64,
}

impl Straight {
    fn new(curve: &dyn Curve<3>, a: f64, b: f64) -> Result<Straight, CurveError> {
        let t = 0.5 * a + 0.5 * b;
        let (at, velocity, bound) = (curve.position(t), curve.velocity(t), curve.acceleration_bound(a, b));
        if !(is_finite(&at) && is_finite(&velocity)) {
            return Err(CurveError::NotFinite { t });
        }
        if !(bound >= 0.0 && bound.is_finite()) {
            return Err(CurveError::BadBound { t0: a, t1: b, bound });
        }
        let h = (b - t).max(t - a).next_up();
        let along = Vec3::from_array(velocity).abs() * h;
        Ok(Straight { t, at: Vec3::from_array(at), along, stray: 0.5 * bound * h * h })
    }

    fn bounds(&self) -> Bounds {
        let half = self.along + Vec3::splat(self.stray);
        // a box too large for numbers is all of space
        let bounds = Bounds::centred(self.at, half);
        if half.is_finite() { bounds } else { Bounds::ALL }
    }

    /// Half as long it may be much smaller: a piece parallel to an axis alone is not.
    fn worth_halving(&self) -> bool {
        let longest = self.along.max_element();
        length(&self.along.to_array()) > 1.01 * longest || self.stray > 0.01 * longest
    }
}
