//! A straight line in space with a time along it.

use rayweave_math::{Affine, Vec3};

/// `r(t) = origin + t * direction`; the direction need not be of unit length, and `t` is counted in units of
/// it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at t = 0.
    pub origin: Vec3,
    /// The displacement per unit of t; finite, not zero.
    pub direction: Vec3,
}

impl Ray {
    /// The ray from `origin` along `direction`.
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction }
    }

    /// The point at time `t`.
    pub fn at(&self, t: f64) -> Vec3 {
        self.origin + t * self.direction
    }

    /// The same ray in other coordinates; times stay what they are.
    pub fn transformed(&self, local_from_world: &Affine) -> Ray {
        Ray {
            origin: local_from_world.point(self.origin),
            direction: local_from_world.vector(self.direction),
        }
    }

    /// The same line with its direction times 2^-k, and 2^-k, such that the largest component is about 1 if
    /// squares of the direction might over- or underflow; `None` if they do not. Times of the other ray times
    /// that factor are times of this one.
    pub(crate) fn rescaled(&self) -> Option<(Ray, f64)> {
        let largest = self.direction.abs().max_element();
        if (1e-90..1e90).contains(&largest) || largest == 0.0 || !largest.is_finite() {
            return None;
        }
        // in two steps, because 2^1074 is no number
        let half = libm::ldexp(1.0, -libm::ilogb(largest) / 2);
        let direction = self.direction * half * half;
        let again = libm::ldexp(1.0, -libm::ilogb(direction.abs().max_element()));
        Some((Ray::new(self.origin, direction * again), half * half * again))
    }

    /// The time at which the ray is closest to a point.
    pub fn closest_time(&self, point: Vec3) -> f64 {
        (point - self.origin).dot(self.direction) / self.direction.length_squared()
    }
}
