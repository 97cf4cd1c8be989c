//! State of a curve at one time, and checks of the curve's contract between times.

use crate::curve::CONTRACT_TOLERANCE;
use crate::point::{add_scaled, is_finite, length, minus};
use crate::{Curve, CurveError, Point};

/// Position and velocity of a curve at one time.
#[derive(Clone, Copy, Debug)]
pub struct Motion<const D: usize> {
    pub t: f64,
    pub position: Point<D>,
    pub velocity: Point<D>,
    /// The sum of the lengths from which the position is computed.
    pub size: f64,
}

impl<const D: usize> Motion<D> {
    /// Evaluates the curve.
    pub fn at<C: Curve<D> + ?Sized>(curve: &C, t: f64) -> Result<Motion<D>, CurveError> {
        let (position, velocity, size) = (curve.position(t), curve.velocity(t), curve.size(t));
        if !(is_finite(&position) && is_finite(&velocity)) || size.is_nan() {
            return Err(CurveError::NotFinite { t });
        }
        Ok(Motion { t, position, velocity, size })
    }

    /// True if position and velocity at two times are consistent with an acceleration bound; `span` is the length of the window.
    fn satisfies(&self, bound: f64, other: &Motion<D>, span: f64) -> bool {
        let h = other.t - self.t;
        let deviation = length(&minus(&other.position, &add_scaled(&self.position, h, &self.velocity)));
        let turn = length(&minus(&other.velocity, &self.velocity));
        let (size, speed) = (self.size.max(other.size), length(&self.velocity) + length(&other.velocity));
        let slack = bound * (self.t.abs() + span);
        deviation <= 0.5 * bound * h * h + CONTRACT_TOLERANCE * (size + speed * h.abs())
            && turn <= bound * h.abs() + CONTRACT_TOLERANCE * (speed + slack)
    }
}

/// The acceleration bound of a curve between two times, checked against the curve at both ends and in the middle.
pub fn checked_bound<const D: usize, C: Curve<D> + ?Sized>(
    curve: &C,
    [a, middle, b]: [&Motion<D>; 3],
    span: f64,
) -> Result<f64, CurveError> {
    let (t0, t1) = (a.t, b.t);
    let bound = curve.acceleration_bound(t0, t1);
    if !(bound >= 0.0 && bound.is_finite()) {
        return Err(CurveError::InvalidBound { t0, t1, bound });
    }
    if !(middle.satisfies(bound, a, span) && middle.satisfies(bound, b, span)) {
        return Err(CurveError::BoundViolated { t0, t1, bound });
    }
    Ok(bound)
}
