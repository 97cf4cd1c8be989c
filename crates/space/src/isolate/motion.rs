//! A curve at one time, and whether it keeps its promises between times.

use crate::curve::TRUST;
use crate::point::{along, is_finite, length, minus};
use crate::{Curve, CurveError, Point};

/// Where a curve is at a time and how it goes on.
#[derive(Clone, Copy, Debug)]
pub struct Motion<const D: usize> {
    pub t: f64,
    pub position: Point<D>,
    pub velocity: Point<D>,
    /// The lengths from which the position is computed.
    pub size: f64,
}

impl<const D: usize> Motion<D> {
    /// The curve at a time.
    pub fn at<C: Curve<D> + ?Sized>(curve: &C, t: f64) -> Result<Motion<D>, CurveError> {
        let (position, velocity, size) = (curve.position(t), curve.velocity(t), curve.size(t));
        if !(is_finite(&position) && is_finite(&velocity)) || size.is_nan() {
            return Err(CurveError::NotFinite { t });
        }
        Ok(Motion { t, position, velocity, size })
    }

    /// True if the curve here and at another time are no farther apart than an acceleration bound allows; `span` is the
    /// length of the window.
    fn keeps(&self, bound: f64, other: &Motion<D>, span: f64) -> bool {
        let h = other.t - self.t;
        let aside = length(&minus(&other.position, &along(&self.position, h, &self.velocity)));
        let turn = length(&minus(&other.velocity, &self.velocity));
        let (size, speed) = (self.size.max(other.size), length(&self.velocity) + length(&other.velocity));
        let slack = bound * (self.t.abs() + span);
        aside <= 0.5 * bound * h * h + TRUST * (size + speed * h.abs())
            && turn <= bound * h.abs() + TRUST * (speed + slack)
    }
}

/// The acceleration bound of a curve between two times, checked against the curve at both of them and in the middle.
pub fn checked_bound<const D: usize, C: Curve<D> + ?Sized>(
    curve: &C,
    [a, middle, b]: [&Motion<D>; 3],
    span: f64,
) -> Result<f64, CurveError> {
    let (t0, t1) = (a.t, b.t);
    let bound = curve.acceleration_bound(t0, t1);
    if !(bound >= 0.0 && bound.is_finite()) {
        return Err(CurveError::BadBound { t0, t1, bound });
    }
    if !(middle.keeps(bound, a, span) && middle.keeps(bound, b, span)) {
        return Err(CurveError::BoundBroken { t0, t1, bound });
    }
    Ok(bound)
}
