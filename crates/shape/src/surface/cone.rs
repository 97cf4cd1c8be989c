//! Double cone `|perp(p - apex)| = slope |h|` with h the height above the apex; the inside is that of both nappes.

use super::along::{Coefficients, Departure, SQUARE_NOISE, quadratic_crossings, recentred, taxicab};
use super::cylinder::{circular, perpendicular};
use super::{Quadric, Surface};
use crate::Ray;
use rayweave_math::roots::Crossings;
use rayweave_math::{Transform, UNIT_ROUNDOFF, Vec3, any_perpendicular, unit};

/// An unbounded circular double cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The common point of both nappes.
    pub apex: Vec3,
    /// Unit vector along the axis; both senses describe the same cone.
    pub axis: Vec3,
    /// Radius per height, > 0: the tangent of the half angle.
    pub slope: f64,
}

impl Cone {
    /// The cone with this apex, axis (of any length) and slope.
    pub fn new(apex: Vec3, axis: Vec3, slope: f64) -> Cone {
        Cone { apex, axis: unit(axis), slope }
    }

    /// Roots of `|perp|^2 - slope^2 h^2`: at most two, and none through the apex, where the ray changes nappes.
    pub fn crossings(&self, ray: &Ray) -> Crossings<2> {
        let (shift, q) = recentred(ray, self.apex);
        let (height, from) = self.split(q);
        let (rise, along) = self.split(ray.direction);
        // both components are differences and dot products with terms as large as these
        let terms = self.slope * self.axis.abs().dot(ray.direction.abs());
        let noise = SQUARE_NOISE * (taxicab(along) * taxicab(ray.direction) + rise.abs() * terms);
        quadratic_crossings(shift, noise, |s| {
            Self::coefficients((height + s * rise, from + s * along), (rise, along))
        })
    }

    /// The slope times the axial component, and the perpendicular component.
    fn split(&self, v: Vec3) -> (f64, Vec3) {
        let height = self.axis.dot(v);
        (self.slope * height, v - height * self.axis)
    }

    fn coefficients((height, from): (f64, Vec3), (rise, along): (f64, Vec3)) -> Coefficients {
        [
            along.length_squared() - rise * rise,
            from.dot(along) - height * rise,
            from.length_squared() - height * height,
        ]
    }

    /// Departure of a ray that starts on the cone.
    pub(super) fn departure(&self, ray: &Ray) -> Departure {
        let [a, b, _] = Self::coefficients(self.split(ray.origin - self.apex), self.split(ray.direction));
        Departure::quadratic(a, b)
    }

    /// `|perp|^2 - slope^2 h^2` and its gradient.
    pub fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let q = point - self.apex;
        let height = self.axis.dot(q);
        let offset = perpendicular(q, self.axis);
        let radius = self.slope * height;
        (offset.length_squared() - radius * radius, 2.0 * (offset - (self.slope * radius) * self.axis))
    }

    /// The image: a circular cone under a similarity, possibly with a scale along the axis, else an elliptic cone.
    pub fn transformed(&self, to: &Transform) -> Surface {
        let map = &to.world_from_local;
        if map.similarity().is_some() {
            return Surface::Cone(Cone::new(map.point(self.apex), map.vector(self.axis), self.slope));
        }
        let side = any_perpendicular(self.axis);
        let rows = [side, self.axis.cross(side), self.slope * self.axis];
        let turned = to.local_from_world.linear.transpose();
        let [a, b, axis] = [rows[0], rows[1], self.axis].map(|row| turned * row);
        if let Some(shrink) = circular(a, b)
            && a.dot(axis).abs().max(b.dot(axis).abs()) <= 64.0 * UNIT_ROUNDOFF * shrink * axis.length()
        {
            return Surface::Cone(Cone::new(map.point(self.apex), axis, self.slope * axis.length() / shrink));
        }
        let here = Quadric::from_squares(self.apex, rows, [1.0, 1.0, -1.0], Vec3::ZERO, 0.0);
        Surface::Quadric(Box::new(here.transformed(to)))
    }
}
