//! The sphere `|p - centre|^2 = radius^2`, inside where the distance is smaller.

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
    /// Roots about the point of closest approach, where no digits of a distant origin are lost.
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
        (
            offset.length_squared() - self.radius * self.radius,
            2.0 * offset,
        )
    }

    /// Distance of the centre from the origin plus the radius.
    pub fn reach(&self) -> f64 {
        self.centre.length() + self.radius
    }

    /// The image under a similarity.
    pub fn transformed(&self, to: &Transform) -> Sphere {
        let scale = to.world_from_local.similarity().unwrap_or(f64::NAN);
        Sphere {
            centre: to.world_from_local.point(self.centre),
            radius: scale * self.radius,
        }
    }
}
