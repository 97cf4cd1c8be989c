//! Ray: a straight line in space with a parameter t.

use rayweave_error::{Classified, ErrorKind, short_number};
use rayweave_math::{Affine, Vec3};
use std::fmt;

/// A ray `r(t) = origin + t * direction`. The direction need not have unit length; `t` is in units of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at t = 0.
    pub origin: Vec3,
    /// The displacement per unit of t.
    pub direction: Vec3,
}

/// A part of a ray: origin or direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayPart {
    /// The point at t = 0.
    Origin,
    /// The displacement per unit of t.
    Direction,
}

impl fmt::Display for RayPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            RayPart::Origin => "origin",
            RayPart::Direction => "direction",
        })
    }
}

/// The reason why a ray cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RayError {
    /// A component is NaN or infinite.
    #[error("the {part} is {}: its components must be finite.", text(.vector))]
    NotFinite {
        /// The vector at fault.
        part: RayPart,
        /// Its value.
        vector: Vec3,
    },
    /// A component exceeds [`Ray::MAX_COMPONENT`].
    #[error("the {part} is {}: components beyond 1e100 overflow in computations. Is the unit far too small?", text(.vector))]
    TooLarge {
        /// The vector at fault.
        part: RayPart,
        /// Its value.
        vector: Vec3,
    },
    /// The direction is zero.
    #[error("the direction is zero: it must have a length.")]
    NoDirection,
    /// All components of the direction are below [`Ray::MIN_DIRECTION`].
    #[error("the direction is {}: components below 1e-100 vanish in computations. Give it a length near 1.", text(.direction))]
    TooShort {
        /// The direction.
        direction: Vec3,
    },
    /// The ray's points are too inaccurate, at its closest approach to the model, to resolve the model: a query would silently
    /// miss it.
    #[error(
        "the ray is too far from the model: at its closest point, {} from its origin, coordinates are accurate to {}, and the model \
         is {} thick. Start the ray closer to the model, and keep the model close to the origin of the coordinates.",
        short_number(*.distance),
        short_number(*.accuracy),
        short_number(*.size)
    )]
    TooFar {
        /// The distance from the origin of the ray to its point closest to the model.
        distance: f64,
        /// The tolerance there.
        accuracy: f64,
        /// The shortest side of the box around the model.
        size: f64,
    },
}

impl Classified for RayError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

fn text(v: &Vec3) -> String {
    format!("({:?}, {:?}, {:?})", v.x, v.y, v.z)
}

impl Ray {
    /// Largest absolute value of a component of an origin or a direction. Its square, and products with the square of any
    /// sensible surface dimension, are far from the end of the range of f64.
    pub const MAX_COMPONENT: f64 = 1e100;

    /// Smallest value of the largest component of a direction. Its square, and the inverse of that, are far from the ends
    /// of the range of f64.
    pub const MIN_DIRECTION: f64 = 1.0 / Ray::MAX_COMPONENT;

    /// Checks that the ray can be traced: finite, components at most [`Ray::MAX_COMPONENT`], and a largest component of the
    /// direction of at least [`Ray::MIN_DIRECTION`]. Callers check rays once, on input.
    ///
    /// # Errors
    /// [`RayError`] with the reason.
    pub fn check(&self) -> Result<(), RayError> {
        // false for NaN
        let is_in_range =
            |v: Vec3| v.to_array().iter().all(|x| (-Ray::MAX_COMPONENT..=Ray::MAX_COMPONENT).contains(x));
        for (part, vector) in [(RayPart::Origin, self.origin), (RayPart::Direction, self.direction)] {
            match () {
                () if is_in_range(vector) => {}
                () if vector.is_finite() => return Err(RayError::TooLarge { part, vector }),
                () => return Err(RayError::NotFinite { part, vector }),
            }
        }
        match self.direction.abs().max_element() {
            0.0 => Err(RayError::NoDirection),
            length if length < Ray::MIN_DIRECTION => Err(RayError::TooShort { direction: self.direction }),
            _ => Ok(()),
        }
    }

    /// The ray from `origin` along `direction`, unchecked; see [`Ray::check`].
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction }
    }

    /// The point at time `t`.
    pub fn at(&self, t: f64) -> Vec3 {
        self.origin + t * self.direction
    }

    /// The same ray in other coordinates, with the same times.
    pub fn transformed(&self, local_from_world: &Affine) -> Ray {
        Ray {
            origin: local_from_world.point(self.origin),
            direction: local_from_world.vector(self.direction),
        }
    }

    /// The same line with its direction scaled by 2^-k so that the largest component is about 1, and the factor 2^-k;
    /// `None` if squares of the direction can neither overflow nor underflow. Times of the scaled ray, multiplied by the
    /// factor, are times of this one.
    pub(crate) fn rescaled(&self) -> Option<(Ray, f64)> {
        let largest = self.direction.abs().max_element();
        if (1e-90..1e90).contains(&largest) || largest == 0.0 || !largest.is_finite() {
            return None;
        }
        // in two steps, because 2^1074 is not representable
        let half = libm::ldexp(1.0, -libm::ilogb(largest) / 2);
        let direction = self.direction * half * half;
        let again = libm::ldexp(1.0, -libm::ilogb(direction.abs().max_element()));
        Some((Ray::new(self.origin, direction * again), half * half * again))
    }

    /// The time of closest approach to a point.
    pub fn closest_time(&self, point: Vec3) -> f64 {
        (point - self.origin).dot(self.direction) / self.direction.length_squared()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_out_of_range_are_rejected_with_a_reason() {
        let check = |o: [f64; 3], d: [f64; 3]| Ray::new(o.into(), d.into()).check();
        let message = |o, d| check(o, d).unwrap_err().to_string();
        let x = [1.0, 0.0, 0.0];
        assert_eq!(
            message([0.0, f64::NAN, 0.0], x),
            "the origin is (0.0, NaN, 0.0): its components must be finite."
        );
        assert!(message(x, [0.0, 0.0, f64::INFINITY]).starts_with("the direction is (0.0, 0.0, inf): its"));
        assert!(
            message([0.0, -1e200, 0.0], x)
                .starts_with("the origin is (0.0, -1e200, 0.0): components beyond 1e100")
        );
        assert!(message(x, [1e101, 0.0, 0.0]).ends_with("Is the unit far too small?"));
        assert_eq!(check(x, [0.0, -0.0, 0.0]), Err(RayError::NoDirection));
        assert!(message(x, [0.0, -9e-101, 5e-324]).ends_with("Give it a length near 1."));
        for (o, d) in [([1e100, -1e100, 0.0], x), (x, [1e-100, 0.0, 0.0]), (x, [0.0, -1e100, 1e-300])] {
            assert_eq!(check(o, d), Ok(()));
        }
    }
}
