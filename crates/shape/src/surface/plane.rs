//! Plane `n . p = c`, with the inside where `n . p < c`.

use super::along::certain_dot;
use crate::Ray;
use crate::real::{Real, Vector};
use rayweave_math::roots::Crossings;
use rayweave_math::{Bounds, Transform, Vec3};

/// A plane with unit normal; the inside is the half-space that the normal points away from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal, pointing outside.
    pub normal: Vec3,
    /// Signed distance of the plane from the origin along the normal.
    pub offset: f64,
}

impl Plane {
    /// The plane `normal . p = offset`, normalised. The normal must be finite and not zero.
    pub fn new(normal: Vec3, offset: f64) -> Plane {
        // division by the largest component first: exact for coordinate axes, and squares cannot over- or underflow
        let largest = normal.abs().max_element();
        let scaled = normal / largest;
        let length = scaled.length();
        Plane { normal: scaled / length, offset: offset / largest / length }
    }

    /// One root at `(c - n.o) / (n.d)`, with this order of operations for every solid with this plane. A ray that is parallel
    /// to the plane up to rounding (see `certain_dot` in `along.rs`) has none, and stays on the side of its origin. The lane
    /// form is in `lanes/facet.rs`; both give the same bits, tested by `tests/lanes.rs`.
    #[inline]
    pub fn crossings(&self, ray: &Ray) -> Crossings<1> {
        let height = self.offset - self.normal.dot(ray.origin);
        let speed = certain_dot(self.normal, ray.direction);
        let t = height / speed;
        if t.is_finite() { Crossings::new(speed > 0.0, &[t]) } else { Crossings::constant(height > 0.0) }
    }

    /// `n . p - c` and the normal.
    #[inline(always)]
    pub(crate) fn value_and_gradient<R: Real>(&self, point: Vector<R>) -> (R, Vector<R>) {
        (point.dot_all(self.normal) - self.offset, point.same(self.normal))
    }

    /// `[a, b]` of f along a ray that starts on the plane, up to a factor: `a` is 0, so no root remains.
    #[inline(always)]
    pub(crate) fn departure<R: Real>(&self, direction: Vector<R>) -> [R; 2] {
        let speed = direction.dot_all(self.normal);
        [speed.splat(0.0), speed]
    }

    /// Bounding box, finite on one side if the normal is a coordinate axis.
    pub fn inside_bounds(&self) -> Bounds {
        let mut bounds = Bounds::ALL;
        for (k, axis) in Vec3::AXES.into_iter().enumerate() {
            if self.normal == axis {
                bounds.hi[k] = self.offset;
            } else if self.normal == -axis {
                bounds.lo[k] = -self.offset;
            }
        }
        bounds
    }

    /// The distance from the origin.
    pub fn magnitude(&self) -> f64 {
        self.offset.abs()
    }

    /// The foot of the perpendicular from the origin.
    pub fn anchor(&self) -> Vec3 {
        self.normal * self.offset
    }

    /// The image of the plane. With p = L q + T, `n . q = c` becomes `(L^-T n) . p = c + (L^-T n) . T`.
    pub fn transformed(&self, to: &Transform) -> Plane {
        let map = &to.world_from_local;
        if let Some(scale) = map.uniform_scale() {
            // normalising a unit vector again may change its last bit
            let offset = scale * self.offset + self.normal.dot(map.translation);
            return Plane { normal: self.normal, offset };
        }
        let normal = to.local_from_world.linear.transpose() * self.normal;
        Plane::new(normal, self.offset + normal.dot(map.translation))
    }
}
