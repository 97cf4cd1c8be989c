//! Scalar fields on R^d (implicit surfaces), with interval bounds of value and gradient.

use crate::Point;
use rayweave_math::Interval;

/// A scalar field f on R^d: the surface is f = 0, the inside f < 0.
pub trait Field<const D: usize> {
    /// The value and the gradient of f at a point.
    fn value_and_gradient(&self, point: &Point<D>) -> (f64, Point<D>);

    /// Enclosures of f and of each component of its gradient over a box.
    fn ranges(&self, cell: &[Interval; D]) -> (Interval, [Interval; D]);

    /// The magnitude of the surface: an upper bound of the lengths in its description, for rounding errors.
    fn magnitude(&self) -> f64;
}
