//! Straight line `r(t) = origin + t direction`.

use crate::point::{add_scaled, length};
use crate::{Curve, Point};

/// A straight line in R^d; `t` is counted in units of the direction, of any length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<const D: usize> {
    /// r(0).
    pub origin: Point<D>,
    /// The displacement per unit of t.
    pub direction: Point<D>,
}

impl<const D: usize> Line<D> {
    /// The line from `origin` along `direction`.
    pub fn new(origin: Point<D>, direction: Point<D>) -> Line<D> {
        Line { origin, direction }
    }
}

impl<const D: usize> Curve<D> for Line<D> {
    fn position(&self, t: f64) -> Point<D> {
        add_scaled(&self.origin, t, &self.direction)
    }

    fn velocity(&self, _: f64) -> Point<D> {
        self.direction
    }

    fn acceleration_bound(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn size(&self, t: f64) -> f64 {
        length(&self.origin) + t.abs() * length(&self.direction)
    }
}
