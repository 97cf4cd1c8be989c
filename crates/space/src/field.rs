//! What is asked of a surface in R^d.

use crate::Point;
use rayweave_math::Interval;

/// A function f on R^d: its surface is where f = 0, its inside where f < 0.
pub trait Field<const D: usize> {
    /// f and its gradient at a point.
    fn value_and_gradient(&self, point: &Point<D>) -> (f64, Point<D>);

    /// Bounds of f and of each component of its gradient over all points of a box.
    fn ranges(&self, cell: &[Interval; D]) -> (Interval, [Interval; D]);

    /// The size and position of the surface: how far from the origin the numbers that describe it reach.
    fn reach(&self) -> f64;
}
