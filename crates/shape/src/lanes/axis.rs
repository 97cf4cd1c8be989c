//! Axis-parallel slabs and cylinders, the most frequent ones in machine parts, in SIMD lanes: the general kernels without
//! the operations that add zero or multiply by one.

use super::ray::LaneRay;
use super::vector::{Lanes, splat};
use crate::surface::{Approach, Cylinder, Plane};
use fearless_simd::Simd;
use rayweave_math::Vec3;

/// Two opposite faces of an axis-parallel box: parallel planes that face away from each other.
#[derive(Clone, Copy, Debug)]
pub struct AxisSlab {
    /// 0, 1 or 2.
    pub axis: u8,
    /// Offset of the plane with the normal against the axis, and the number of its face.
    pub low: (f64, f64),
    /// Offset of the plane with the normal along the axis, and the number of its face.
    pub high: (f64, f64),
    /// For the low and high plane: true if the leaf is the outside of the plane with the opposite sign.
    pub turned: [bool; 2],
}

/// A cylinder parallel to a coordinate axis.
#[derive(Clone, Copy, Debug)]
pub struct AxisCylinder {
    /// 0, 1 or 2.
    pub axis: u8,
    /// A point of its axis: the two coordinates perpendicular to the axis.
    pub point: [f64; 2],
    /// The radius, > 0.
    pub radius: f64,
}

/// Index of the coordinate axis that is parallel to a unit vector.
fn axis_of(v: Vec3) -> Option<usize> {
    (0..3).find(|&k| v.abs() == Vec3::AXES[k])
}

/// Indices of the two coordinates perpendicular to an axis.
const ACROSS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];

/// The axis of an axis-parallel plane, and the sign of its normal.
pub(super) fn axis_of_plane(plane: &Plane) -> Option<(u8, f64)> {
    axis_of(plane.normal).map(|axis| (axis as u8, plane.normal[axis]))
}

impl AxisCylinder {
    pub(super) fn of(cylinder: &Cylinder) -> Option<AxisCylinder> {
        let axis = axis_of(cylinder.axis)?;
        // the point nearest to the origin has a zero coordinate along the axis
        let point = ACROSS[axis].map(|k| cylinder.point[k]);
        (cylinder.point[axis] == 0.0).then_some(AxisCylinder {
            axis: axis as u8,
            point,
            radius: cylinder.radius,
        })
    }

    /// The general form of the cylinder.
    #[inline(always)]
    pub(super) fn general(&self) -> Cylinder {
        let mut point = Vec3::ZERO;
        let [first, second] = ACROSS[usize::from(self.axis)];
        (point[first], point[second]) = (self.point[0], self.point[1]);
        Cylinder { point, axis: Vec3::AXES[usize::from(self.axis)], radius: self.radius }
    }

    /// [`Cylinder::approach`] in the two coordinates perpendicular to the axis, where even the smallest speed is not a
    /// rounding error.
    #[inline(always)]
    pub(super) fn approach<S: Simd>(&self, ray: &LaneRay<S>) -> Approach<Lanes<S>> {
        let simd = ray.square.simd;
        let point = [splat(simd, self.point[0]), splat(simd, self.point[1])];
        approach(ray, self.axis, point, splat(simd, self.radius))
    }
}

/// [`AxisCylinder::approach`] with a cylinder for each ray, all parallel to one axis.
#[inline(always)]
pub(super) fn approach<S: Simd>(
    ray: &LaneRay<S>,
    axis: u8,
    point: [Lanes<S>; 2],
    radius: Lanes<S>,
) -> Approach<Lanes<S>> {
    let (o, d) = (&ray.origin, &ray.direction);
    let ([x, y], [u, v]) = match axis {
        0 => ([o.y, o.z], [d.y, d.z]),
        1 => ([o.x, o.z], [d.x, d.z]),
        _ => ([o.x, o.y], [d.x, d.y]),
    };
    let (x, y) = (x - point[0], y - point[1]);
    let square = u * u + v * v;
    let time = Approach::time(square, x * u + y * v);
    let (x, y) = (x + time * u, y + time * v);
    Approach { time, square, inside: radius * radius - (x * x + y * y) }
}
