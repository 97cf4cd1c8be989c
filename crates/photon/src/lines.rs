//! Random lines through a box.

use crate::philox::{Stream, perpendicular};
use rayweave_math::Bounds;
use rayweave_shape::Ray;

/// A line through the ball around a box: a uniform direction, and a uniform point of the disc perpendicular to it. Such lines
/// cross each part of a surface in proportion to its area (Cauchy-Crofton).
pub(crate) fn random_line(bounds: &Bounds, stream: &mut Stream) -> Ray {
    let radius = 0.5 * bounds.size().length();
    let direction = stream.direction();
    let distance = radius * stream.uniform().sqrt();
    let azimuth = std::f64::consts::TAU * stream.uniform();
    let (x, y) = perpendicular(direction);
    let across = distance * (libm::cos(azimuth) * x + libm::sin(azimuth) * y);
    Ray::new(bounds.centre() + across - 2.0 * radius * direction, direction)
}
