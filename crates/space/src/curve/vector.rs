//! Validation of arguments of curves, and unit vectors of space.

use crate::point::{dot, is_finite};
use crate::vector::{largest, unit};
use crate::{CurveError, Point};

/// Rejects NaN and infinite components.
pub fn finite<const D: usize>(what: &'static str, v: &Point<D>) -> Result<(), CurveError> {
    let why = "it has a number that is NaN or infinite";
    if is_finite(v) { Ok(()) } else { Err(CurveError::InvalidArgument { what, why }) }
}

/// A unit vector in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction(Point<3>);

impl Direction {
    /// The direction of a nonzero vector.
    pub fn new(what: &'static str, v: &Point<3>) -> Result<Direction, CurveError> {
        finite(what, v)?;
        if largest(v) == 0.0 {
            return Err(CurveError::InvalidArgument { what, why: "a vector of length 0 has no direction" });
        }
        Ok(Direction(unit(v).0))
    }

    /// The component of a vector along the direction.
    pub fn dot(&self, v: &Point<3>) -> f64 {
        dot(&self.0, v)
    }

    /// The direction times a number.
    pub fn times(&self, s: f64) -> Point<3> {
        self.0.map(|x| s * x)
    }

    /// The part of a vector perpendicular to the direction.
    pub fn across(&self, v: &Point<3>) -> Point<3> {
        let s = self.dot(v);
        std::array::from_fn(|k| v[k] - s * self.0[k])
    }

    /// The cross product, the direction first.
    pub fn cross(&self, v: &Point<3>) -> Point<3> {
        let u = &self.0;
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    }
}
