//! Circular cylinder, unbounded: `|perp(p - point)|^2 = radius^2`; the inside is nearer to the axis.

use super::along::{Approach, DOT_NOISE};
use super::{Quadric, Surface};
use crate::Ray;
use crate::real::{Real, Vector};
use rayweave_math::roots::Crossings;
use rayweave_math::{Bounds, Transform, UNIT_ROUNDOFF, Vec3, any_perpendicular, unit};

/// Ratio of squared speeds below which a ray is examined for being parallel to the axis.
const SLOW_SQUARE: f64 = 1e-4;

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
        let slow = SLOW_SQUARE * ray.direction.length_squared();
        self.approach(ray.origin.into(), ray.direction.into(), slow).crossings()
    }

    /// Closest approach to the axis, in the plane perpendicular to it. `slow` is any number between the squared length of the
    /// direction times 1e-28 and infinity: only rays with a smaller squared speed across the axis can be parallel to it.
    #[inline(always)]
    pub(crate) fn approach<R: Real>(&self, origin: Vector<R>, direction: Vector<R>, slow: R) -> Approach<R> {
        let line = (origin.same(self.point), origin.same(self.axis));
        approach((origin, direction), slow, line, slow.splat(self.radius))
    }

    /// Components perpendicular to the axis: origin (relative to the axis) and direction.
    #[inline(always)]
    fn across<R: Real>(&self, origin: Vector<R>, direction: Vector<R>) -> [Vector<R>; 2] {
        [origin.minus_all(self.point).perpendicular(self.axis), direction.perpendicular(self.axis)]
    }

    /// `[a, b]` of f along a ray that starts on the cylinder, `a t^2 + 2 b t`.
    #[inline(always)]
    pub(crate) fn departure<R: Real>(&self, origin: Vector<R>, direction: Vector<R>) -> [R; 2] {
        let [from, along] = self.across(origin, direction);
        [along.length_squared(), from.dot(along)]
    }

    /// `|perp|^2 - radius^2` and its gradient.
    #[inline(always)]
    pub(crate) fn value_and_gradient<R: Real>(&self, point: Vector<R>) -> (R, Vector<R>) {
        let offset = point.minus_all(self.point).perpendicular(self.axis);
        (offset.length_squared() - self.radius * self.radius, offset.times_number(2.0))
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

/// [`Cylinder::approach`] with a cylinder for each ray, given by its line and its radius.
#[inline(always)]
pub(crate) fn approach<R: Real>(
    (origin, direction): (Vector<R>, Vector<R>),
    slow: R,
    (point, axis): (Vector<R>, Vector<R>),
    radius: R,
) -> Approach<R> {
    let (from, along) = (origin.minus(point).perpendicular_to(axis), direction.perpendicular_to(axis));
    let mut square = along.length_squared();
    if R::any(square.is_below(slow)) {
        square = R::select(is_along(direction, along, axis), square.splat(0.0), square);
    }
    let time = Approach::time(square, from.dot(along));
    let apart = from.plus(along.times(time)).length_squared();
    Approach { time, square, inside: radius * radius - apart }
}

/// True if a direction is parallel to an axis up to rounding: its perpendicular component `across` consists of rounding errors.
#[inline(always)]
fn is_along<R: Real>(direction: Vector<R>, across: Vector<R>, axis: Vector<R>) -> R::Mask {
    let (size, axis, across) = (direction.abs(), axis.abs(), across.abs());
    let along = size.dot(axis);
    let is_noise = |component: R, size: R, axis: R| component.is_at_most((size + along * axis) * DOT_NOISE);
    is_noise(across.x, size.x, axis.x)
        & is_noise(across.y, size.y, axis.y)
        & is_noise(across.z, size.z, axis.z)
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
