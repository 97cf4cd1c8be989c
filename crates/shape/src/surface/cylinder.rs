//! Circular cylinder, unbounded: `|perp(p - point)|^2 = radius^2`; the inside is nearer to the axis.

use super::along::{DOT_NOISE, Departure};
use super::{Quadric, Surface};
use crate::Ray;
use rayweave_math::roots::Crossings;
use rayweave_math::{Bounds, Transform, UNIT_ROUNDOFF, Vec3, any_perpendicular, unit};

/// An unbounded circular cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// The point of the axis nearest to the frame's origin.
    pub point: Vec3,
    /// Unit vector along the axis; both senses describe the same cylinder.
    pub axis: Vec3,
    /// The radius, > 0.
    pub radius: f64,
}

impl Cylinder {
    /// The cylinder about the line through `point` along `axis`, which need not have unit length.
    pub fn new(point: Vec3, axis: Vec3, radius: f64) -> Cylinder {
        let axis = unit(axis);
        Cylinder { point: perpendicular(point, axis), axis, radius }
    }

    /// Roots, computed about the closest approach to the axis. A ray parallel to the axis up to rounding has none.
    pub fn crossings(&self, ray: &Ray) -> Crossings<2> {
        let from = perpendicular(ray.origin - self.point, self.axis);
        let along = perpendicular(ray.direction, self.axis);
        let square = along.length_squared();
        if square == 0.0 || self.is_along(ray.direction, along) {
            return Crossings::constant(from.length_squared() < self.radius * self.radius);
        }
        let closest = -from.dot(along) / square;
        let offset = from + closest * along;
        let inside = self.radius * self.radius - offset.length_squared();
        if inside.is_nan() || inside <= 0.0 {
            return Crossings::constant(false);
        }
        let half = (inside / square).sqrt();
        // a ray that diverges from the axis by 1e-150 per unit of time has a finite interval, although its square overflows
        let half = if half.is_finite() { half } else { inside.sqrt() / square.sqrt() };
        Crossings::new(false, &[closest - half, closest + half])
    }

    /// True if a direction is parallel to the axis up to rounding: its perpendicular component `across` consists of rounding errors.
    fn is_along(&self, direction: Vec3, across: Vec3) -> bool {
        let (size, axis) = (direction.abs(), self.axis.abs());
        across.abs().cmple(DOT_NOISE * (size + axis.dot(size) * axis)).all()
    }

    /// Departure of a ray that starts on the cylinder.
    pub(super) fn departure(&self, ray: &Ray) -> Departure {
        let from = perpendicular(ray.origin - self.point, self.axis);
        let along = perpendicular(ray.direction, self.axis);
        Departure::quadratic(along.length_squared(), from.dot(along))
    }

    /// `|perp|^2 - radius^2` and its gradient.
    pub fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let offset = perpendicular(point - self.point, self.axis);
        (offset.length_squared() - self.radius * self.radius, 2.0 * offset)
    }

    /// Distance of the axis from the origin plus the radius.
    pub fn magnitude(&self) -> f64 {
        self.point.length() + self.radius
    }

    /// Bounding box, finite along coordinate axes that are perpendicular to the cylinder's axis.
    pub fn inside_bounds(&self) -> Bounds {
        let half = self.axis.map(|u| if u == 0.0 { self.radius } else { f64::INFINITY });
        Bounds::centred(self.point, half)
    }

    /// The image: a circular cylinder under a similarity, possibly with a scale along the axis, else an elliptic cylinder.
    pub fn transformed(&self, to: &Transform) -> Surface {
        let map = &to.world_from_local;
        if let Some(scale) = map.similarity() {
            return Surface::Cylinder(Cylinder::new(
                map.point(self.point),
                map.vector(self.axis),
                scale * self.radius,
            ));
        }
        let side = any_perpendicular(self.axis);
        let rows = [side, self.axis.cross(side), self.axis];
        // n . q equals (L^-T n) . p in the image
        let turned = to.local_from_world.linear.transpose();
        if let Some(shrink) = circular(turned * rows[0], turned * rows[1]) {
            let (point, axis) = (map.point(self.point), map.vector(self.axis));
            return Surface::Cylinder(Cylinder::new(point, axis, self.radius / shrink));
        }
        let here =
            Quadric::from_squares(self.point, rows, [1.0, 1.0, 0.0], Vec3::ZERO, -self.radius * self.radius);
        let there = here.transformed(to);
        let axis = unit(map.vector(self.axis));
        Surface::Quadric(Box::new(Quadric { centre: perpendicular(there.centre, axis), ..there }))
    }
}

/// The length of two vectors that are perpendicular and equally long within 64 roundings, the tolerance for similarities;
/// then `(a . p)^2 + (b . p)^2` depends only on the distance of p from the origin in their plane.
pub(super) fn circular(a: Vec3, b: Vec3) -> Option<f64> {
    let (square, other) = (a.length_squared(), b.length_squared());
    let off = (square - other).abs().max(2.0 * a.dot(b).abs());
    (off <= 64.0 * UNIT_ROUNDOFF * square).then(|| square.sqrt())
}

/// The component of `v` perpendicular to a unit vector.
pub(super) fn perpendicular(v: Vec3, axis: Vec3) -> Vec3 {
    v - v.dot(axis) * axis
}
