//! Sphere `|p - centre|^2 = radius^2`, with the inside at smaller distances.

use super::along::Departure;
use super::{Quadric, Surface};
use crate::Ray;
use rayweave_math::roots::Crossings;
use rayweave_math::{Transform, Vec3};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre.
    pub centre: Vec3,
    /// The radius, > 0.
    pub radius: f64,
}

impl Sphere {
    /// Roots, computed about the closest approach, so that a distant origin costs no digits.
    pub fn crossings(&self, ray: &Ray) -> Crossings<2> {
        let closest = ray.closest_time(self.centre);
        let offset = ray.at(closest) - self.centre;
        let inside = self.radius * self.radius - offset.length_squared();
        if inside.is_nan() || inside <= 0.0 {
            return Crossings::constant(false);
        }
        let half = (inside / ray.direction.length_squared()).sqrt();
        Crossings::new(false, &[closest - half, closest + half])
    }

    /// `|p - centre|^2 - radius^2` and its gradient.
    pub fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let offset = point - self.centre;
        (offset.length_squared() - self.radius * self.radius, 2.0 * offset)
    }

    /// Distance of the centre from the origin plus the radius.
    pub fn magnitude(&self) -> f64 {
        self.centre.length() + self.radius
    }

    /// Departure of a ray that starts on the sphere.
    pub(super) fn departure(&self, ray: &Ray) -> Departure {
        let from = ray.origin - self.centre;
        Departure::quadratic(ray.direction.length_squared(), from.dot(ray.direction))
    }

    /// The image: a sphere under a similarity, else an ellipsoid.
    pub fn transformed(&self, to: &Transform) -> Surface {
        let map = &to.world_from_local;
        if let Some(scale) = map.similarity() {
            return Surface::sphere(map.point(self.centre), scale * self.radius);
        }
        let square = self.radius * self.radius;
        let here = Quadric::from_squares(self.centre, Vec3::AXES, [1.0; 3], Vec3::ZERO, -square);
        Surface::Quadric(Box::new(here.transformed(to)))
    }
}
