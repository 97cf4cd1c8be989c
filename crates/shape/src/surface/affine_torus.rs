//! Affine image of a torus that is not a torus: rays are transformed into the frame of the torus.

use super::along::{Departure, recentred};
use super::{Surface, Torus};
use crate::Ray;
use rayweave_math::roots::Crossings;
use rayweave_math::{Affine, Bounds, Mat3, Transform, Vec3};

/// A scaled or sheared torus: `q = local_from_world (p - centre)` lies on a torus about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AffineTorus {
    /// Image of the torus's centre.
    pub centre: Vec3,
    /// Linear map into the frame of the torus.
    pub local_from_world: Mat3,
    /// Its inverse.
    pub world_from_local: Mat3,
    /// The torus in its own frame, centred at the origin.
    pub torus: Torus,
}

impl AffineTorus {
    /// A torus as an image of itself.
    pub(super) fn of(torus: &Torus) -> AffineTorus {
        AffineTorus {
            centre: torus.centre,
            local_from_world: Mat3::IDENTITY,
            world_from_local: Mat3::IDENTITY,
            torus: Torus { centre: Vec3::ZERO, ..*torus },
        }
    }

    /// At most four roots.
    pub fn crossings(&self, ray: &Ray) -> Crossings<4> {
        let local = self.local(ray);
        let (shift, q) = recentred(&local, Vec3::ZERO);
        self.torus.crossings_about(shift, q, local.direction)
    }

    /// Departure of a ray that starts on the torus.
    pub(super) fn departure(&self, ray: &Ray) -> Departure {
        let local = self.local(ray);
        self.torus.departure_from(local.origin, local.direction)
    }

    pub(super) fn is_finite(&self) -> bool {
        self.centre.is_finite()
            && self.local_from_world.is_finite()
            && self.world_from_local.is_finite()
            && self.torus.is_finite()
    }

    fn local(&self, ray: &Ray) -> Ray {
        Ray::new(self.local_from_world * (ray.origin - self.centre), self.local_from_world * ray.direction)
    }

    /// g in the frame of the torus, and its gradient in the outer frame.
    pub fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let local = self.local_from_world * (point - self.centre);
        let (value, gradient) = self.torus.value_and_gradient(local);
        (value, self.local_from_world.transpose() * gradient)
    }

    /// Like [`Torus::value_and_steepest`].
    pub fn value_and_steepest(&self, point: Vec3) -> (f64, Vec3) {
        let local = self.local_from_world * (point - self.centre);
        let (value, gradient) = self.torus.value_and_steepest(local);
        (value, self.local_from_world.transpose() * gradient)
    }

    /// Upper bound of the distance from the origin to the farthest point of the torus.
    pub fn magnitude(&self) -> f64 {
        self.centre.length() + self.size()
    }

    /// Upper bound of the distance from the centre to the farthest point of the torus.
    pub(super) fn size(&self) -> f64 {
        Affine::from_linear(self.world_from_local).linear_norm() * self.torus.magnitude()
    }

    /// Smallest bounding box: `max n . L q = max (L^T n) . q`.
    pub fn inside_bounds(&self) -> Bounds {
        let turned = self.world_from_local.transpose();
        let half = Vec3::from_array(Vec3::AXES.map(|n| self.torus.support(turned * n)));
        Bounds::centred(self.centre, half)
    }

    /// The image; a plain torus if the composed map is a similarity.
    pub fn transformed(&self, to: &Transform) -> Surface {
        let centre = to.world_from_local.point(self.centre);
        let world_from_local = to.world_from_local.linear * self.world_from_local;
        let map = Affine::from_linear(world_from_local);
        if let Some(scale) = map.similarity() {
            let Torus { axis, major, minor, .. } = self.torus;
            let axis = map.vector(axis);
            return Surface::Torus(Torus::new(centre, axis, scale * major, scale * minor));
        }
        Surface::AffineTorus(Box::new(AffineTorus {
            centre,
            local_from_world: self.local_from_world * to.local_from_world.linear,
            world_from_local,
            torus: self.torus,
        }))
    }
}
