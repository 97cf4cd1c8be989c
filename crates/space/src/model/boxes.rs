//! Bounding boxes of the pieces of a curve, for tests against leaves.

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
    /// The largest size of the curve, for the margin of boxes.
    size: f64,
}

/// The maximal number of pieces, each of which is tested against every leaf.
const MAX_PIECES: usize = 64;

impl Boxes {
    /// Halves pieces until they are nearly straight or the maximal number is reached.
    pub fn new(curve: &dyn Curve<3>, t0: f64, t1: f64) -> Result<Boxes, CurveError> {
        let mut boxes = Boxes { pieces: Vec::new(), size: 0.0 };
        let mut waiting = VecDeque::from([(Motion::at(curve, t0)?, Motion::at(curve, t1)?)]);
        while let Some((a, b)) = waiting.pop_front() {
            let piece = TangentPiece::new(curve, &a, &b, t1 - t0)?;
            let middle = piece.middle;
            boxes.size = boxes.size.max(a.size).max(b.size).max(middle.size);
            let room = boxes.pieces.len() + waiting.len() + 2 <= MAX_PIECES;
            if room && piece.worth_halving() && a.t < middle.t && middle.t < b.t {
                waiting.extend([(a, middle), (middle, b)]);
            } else {
                boxes.pieces.push(piece.bounds());
            }
        }
        Ok(boxes)
    }

    /// True if the curve may cross a box of a group, grown by the rounding error of transforming the curve: see
    /// [`rayweave_model::Prototype::condition`].
    pub fn may_cross(&self, bounds: &Bounds, condition: f64, view: &View<'_>) -> bool {
        if bounds.is_empty() {
            return false;
        }
        let norm = view.map.linear_norm();
        let magnitude = norm * self.size + view.map.translation.length() + view.magnitude;
        let margin = MARGIN * condition * magnitude;
        let grown = bounds.grown(margin);
        self.pieces.iter().any(|piece| !piece.transformed(&view.map).intersection(&grown).is_empty())
    }
}

/// A piece, given by its tangent in the middle and the maximal deviation from it.
struct TangentPiece {
    middle: Motion<3>,
    along: Vec3,
    deviation: f64,
}

impl TangentPiece {
    fn new(
        curve: &dyn Curve<3>,
        a: &Motion<3>,
        b: &Motion<3>,
        span: f64,
    ) -> Result<TangentPiece, CurveError> {
        let middle = Motion::at(curve, 0.5 * a.t + 0.5 * b.t)?;
        let bound = checked_bound(curve, [a, &middle, b], span)?;
        let h = (b.t - middle.t).max(middle.t - a.t).next_up();
        let along = Vec3::from_array(middle.velocity).abs() * h;
        Ok(TangentPiece { middle, along, deviation: 0.5 * bound * h * h })
    }

    fn bounds(&self) -> Bounds {
        let half = self.along + Vec3::splat(self.deviation);
        // an overflowing box is the whole space
        let bounds = Bounds::centred(Vec3::from_array(self.middle.position), half);
        if half.is_finite() { bounds } else { Bounds::ALL }
    }

    /// True if halving shrinks the box: the piece is not parallel to an axis, or strongly curved.
    fn worth_halving(&self) -> bool {
        let longest = self.along.max_element();
        length(&self.along.to_array()) > 1.01 * longest || self.deviation > 0.01 * longest
    }
}
