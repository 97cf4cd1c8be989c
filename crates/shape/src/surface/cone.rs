//! Double cone `|perp(p - apex)| = slope |h|` with h the height above the apex; the inside is that of both nappes.

use super::along::{SQUARE_NOISE, quadratic_crossings, recentred, taxicab};
use super::cylinder::circular;
use super::{Quadric, Surface};
use crate::Ray;
use crate::real::{Real, Vector};
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
        let (height, from) = self.split(q.into());
        let (rise, along) = self.split(ray.direction.into());
        // both components are differences and dot products with terms as large as these
        let terms = self.slope * self.axis.abs().dot(ray.direction.abs());
        let noise = SQUARE_NOISE * (along.taxicab() * taxicab(ray.direction) + rise.abs() * terms);
        quadratic_crossings(shift, noise, |s| {
            Self::coefficients((height + s * rise, from.plus(along.times(s))), (rise, along))
        })
    }

    /// The slope times the axial component, and the perpendicular component.
    #[inline(always)]
    pub(crate) fn split<R: Real>(&self, v: Vector<R>) -> (R, Vector<R>) {
        split(v, v.same(self.axis), v.x.splat(self.slope))
    }

    /// `[a, b, c]` of f along a ray, `a t^2 + 2 b t + c`, from the components of its point and direction.
    #[inline(always)]
    pub(crate) fn coefficients<R: Real>(
        (height, from): (R, Vector<R>),
        (rise, along): (R, Vector<R>),
    ) -> [R; 3] {
        [
            along.length_squared() - rise * rise,
            from.dot(along) - height * rise,
            from.length_squared() - height * height,
        ]
    }

    /// `[a, b]` of f along a ray that starts on the cone, `a t^2 + 2 b t`.
    #[inline(always)]
    pub(crate) fn departure<R: Real>(&self, origin: Vector<R>, direction: Vector<R>) -> [R; 2] {
        let [a, b, _] = Self::coefficients(self.split(origin.minus_all(self.apex)), self.split(direction));
        [a, b]
    }

    /// `|perp|^2 - slope^2 h^2` and its gradient.
    #[inline(always)]
    pub(crate) fn value_and_gradient<R: Real>(&self, point: Vector<R>) -> (R, Vector<R>) {
        let (radius, offset) = self.split(point.minus_all(self.apex));
        let gradient = offset.without(radius * self.slope, self.axis).times_number(2.0);
        (offset.length_squared() - radius * radius, gradient)
    }

    /// The change of the gradient per unit of time along a line with this direction.
    pub(super) fn gradient_rate(&self, direction: Vec3) -> Vec3 {
        let (rise, along) = self.split(Vector::from(direction));
        Vec3::from(along.without(rise * self.slope, self.axis).times_number(2.0))
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

/// [`Cone::split`] with an axis and a slope for each ray.
#[inline(always)]
pub(crate) fn split<R: Real>(v: Vector<R>, axis: Vector<R>, slope: R) -> (R, Vector<R>) {
    let height = v.dot(axis);
    (height * slope, v.minus(axis.times(height)))
}
