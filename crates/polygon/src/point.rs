//! Points of the plane.

/// A point or a vector of the plane: x and y.
pub type Point = [f64; 2];
