//! Trajectories r(t) in R^d.

use crate::Point;

/// A trajectory with a bounded second derivative.
pub trait Curve<const D: usize> {
    /// r(t).
    fn position(&self, t: f64) -> Point<D>;

    /// r'(t).
    fn velocity(&self, t: f64) -> Point<D>;

    /// A number that `|r''|` (Euclidean) nowhere exceeds between two times, `t0 < t1`. 0 for a straight line.
    fn acceleration_bound(&self, t0: f64, t1: f64) -> f64;
}
