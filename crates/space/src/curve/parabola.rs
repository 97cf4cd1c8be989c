//! Parabola, the path of a projectile under constant acceleration: `r(t) = p + t (v + t a / 2)`.

use crate::point::{add_scaled, length};
use crate::{Curve, Point};

/// A parabola in R^d as a motion with position and velocity at t = 0 and constant acceleration. It is a straight line if the
/// acceleration is 0 or parallel to the velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parabola<const D: usize> {
    /// r(0).
    pub position: Point<D>,
    /// r'(0).
    pub velocity: Point<D>,
    /// r''.
    pub acceleration: Point<D>,
}

impl<const D: usize> Parabola<D> {
    /// The motion from `position` with `velocity` under `acceleration`.
    pub fn new(position: Point<D>, velocity: Point<D>, acceleration: Point<D>) -> Parabola<D> {
        Parabola { position, velocity, acceleration }
    }
}

impl<const D: usize> Curve<D> for Parabola<D> {
    fn position(&self, t: f64) -> Point<D> {
        add_scaled(&self.position, t, &add_scaled(&self.velocity, 0.5 * t, &self.acceleration))
    }

    fn velocity(&self, t: f64) -> Point<D> {
        add_scaled(&self.velocity, t, &self.acceleration)
    }

    fn acceleration_bound(&self, _: f64, _: f64) -> f64 {
        length(&self.acceleration)
    }

    fn size(&self, t: f64) -> f64 {
        length(&self.position)
            + t.abs() * (length(&self.velocity) + 0.5 * t.abs() * length(&self.acceleration))
    }
}
