//! Sphere `|p - centre|^2 = radius^2`, with the inside at smaller distances.

use super::along::Approach;
use super::{Quadric, Surface};
use crate::Ray;
use crate::real::{Real, Vector};
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
        let (origin, direction) = (ray.origin.into(), ray.direction.into());
        self.approach(origin, direction, ray.direction.length_squared()).crossings()
    }

    /// Closest approach to the centre, where `square` is the squared length of the direction.
    #[inline(always)]
    pub(crate) fn approach<R: Real>(
        &self,
        origin: Vector<R>,
        direction: Vector<R>,
        square: R,
    ) -> Approach<R> {
        approach(origin, direction, square, (origin.same(self.centre), square.splat(self.radius)))
    }

    /// `|p - centre|^2 - radius^2` and its gradient.
    #[inline(always)]
    pub(crate) fn value_and_gradient<R: Real>(&self, point: Vector<R>) -> (R, Vector<R>) {
        let offset = point.minus_all(self.centre);
        (offset.length_squared() - self.radius * self.radius, offset.times_number(2.0))
    }

    /// `[a, b]` of f along a ray that starts on the sphere, `a t^2 + 2 b t`.
    #[inline(always)]
    pub(crate) fn departure<R: Real>(&self, origin: Vector<R>, direction: Vector<R>) -> [R; 2] {
        [direction.length_squared(), origin.minus_all(self.centre).dot(direction)]
    }

    /// Distance of the centre from the origin plus the radius.
    pub fn magnitude(&self) -> f64 {
        self.centre.length() + self.radius
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

/// [`Sphere::approach`] with a sphere for each ray.
#[inline(always)]
pub(crate) fn approach<R: Real>(
    origin: Vector<R>,
    direction: Vector<R>,
    square: R,
    (centre, radius): (Vector<R>, R),
) -> Approach<R> {
    let time = centre.minus(origin).dot(direction) / square;
    let offset = origin.plus(direction.times(time)).minus(centre);
    Approach { time, square, inside: radius * radius - offset.length_squared() }
}
