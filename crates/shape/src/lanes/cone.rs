//! Cones along eight rays, as [`Cone::crossings`].

use super::quadratic::{Form, Roots, Size};
use super::ray::{Doubt, LaneRay};
use super::vector::{Lanes, Vec3Lanes};
use crate::surface::Cone;
use fearless_simd::Simd;

/// The most by which the gradient changes over a unit of length, halved.
pub(super) fn bend(cone: &Cone) -> f64 {
    1.0 + cone.slope * cone.slope
}

/// Where the rays are inside the cone, or outside.
#[inline(always)]
pub(super) fn roots<S: Simd>(simd: S, cone: &Cone, ray: &LaneRay<S>, doubt: &mut Doubt<S>) -> Roots<S> {
    let shift = ray.origin.taken_from(cone.apex).dot(ray.direction) / ray.square;
    let place = ray.origin.minus_all(cone.apex).plus(ray.direction.times(shift));
    let (height, from) = split(cone, place);
    let (rise, along) = split(cone, ray.direction);
    let form = Form {
        shift,
        square: along.length_squared() - rise * rise,
        at: |s: Lanes<S>| {
            let (height, from) = (height + s * rise, from.plus(along.times(s)));
            [from.dot(along) - height * rise, from.length_squared() - height * height]
        },
    };
    let size = Size { place, bend: bend(cone), linear: 0.0, constant: 0.0 };
    form.roots(simd, ray, Some(size), doubt)
}

/// The slope times the part along the axis, and the part across it.
#[inline(always)]
fn split<S: Simd>(cone: &Cone, v: Vec3Lanes<S>) -> (Lanes<S>, Vec3Lanes<S>) {
    let height = v.dot_all(cone.axis);
    (height * cone.slope, v.without(height, cone.axis))
}
