//! Cones in SIMD lanes, equal to [`Cone::crossings`].

use super::quadratic::{Form, Roots, Size};
use super::ray::{LaneRay, Uncertain};
use super::vector::{Lanes, Vec3Lanes, splat};
use crate::surface::{Cone, SQUARE_NOISE};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Half of the largest change of the gradient per unit of length.
pub(super) fn bend(cone: &Cone) -> f64 {
    1.0 + cone.slope * cone.slope
}

/// Rays in cone coordinates: the slope times the axial component, and the perpendicular component.
struct Line<S: Simd> {
    shift: Lanes<S>,
    height: Lanes<S>,
    from: Vec3Lanes<S>,
    rise: Lanes<S>,
    along: Vec3Lanes<S>,
    slope: f64,
}

/// Roots of the rays with the cone.
#[inline(always)]
pub(super) fn roots<S: Simd>(
    simd: S,
    cone: &Cone,
    ray: &LaneRay<S>,
    uncertain: &mut Uncertain<S>,
) -> Roots<S> {
    let shift = ray.origin.taken_from(cone.apex).dot(ray.direction) / ray.square;
    let place = ray.origin.minus_all(cone.apex).plus(ray.direction.times(shift));
    let (height, from) = split(cone, place);
    let (rise, along) = split(cone, ray.direction);
    let size = Size { place, bend: bend(cone), linear: 0.0, constant: 0.0 };
    Line { shift, height, from, rise, along, slope: cone.slope }.roots(simd, ray, Some(size), uncertain)
}

#[inline(always)]
fn split<S: Simd>(cone: &Cone, v: Vec3Lanes<S>) -> (Lanes<S>, Vec3Lanes<S>) {
    let height = v.dot_all(cone.axis);
    (height * cone.slope, v.without(height, cone.axis))
}

/// `[a, b]` of f along rays from the cone, `a t^2 + 2 b t`.
#[inline(always)]
pub(super) fn departure<S: Simd>(cone: &Cone, ray: &LaneRay<S>) -> [Lanes<S>; 2] {
    let (height, from) = split(cone, ray.origin.minus_all(cone.apex));
    let (rise, along) = split(cone, ray.direction);
    [along.length_squared() - rise * rise, from.dot(along) - height * rise]
}

/// Lane version of [`Cone::value_and_gradient`].
#[inline(always)]
pub(super) fn value_and_gradient<S: Simd>(
    simd: S,
    cone: &Cone,
    point: Vec3Lanes<S>,
) -> (Lanes<S>, Vec3Lanes<S>) {
    let from = point.minus_all(cone.apex);
    let (radius, offset) = (from.dot_all(cone.axis) * cone.slope, from.perpendicular(cone.axis));
    let gradient = offset.without(radius * cone.slope, cone.axis).times(splat(simd, 2.0));
    (offset.length_squared() - radius * radius, gradient)
}

impl<S: Simd> Form<S> for Line<S> {
    #[inline(always)]
    fn shift(&self) -> Lanes<S> {
        self.shift
    }

    #[inline(always)]
    fn square(&self) -> Lanes<S> {
        self.along.length_squared() - self.rise * self.rise
    }

    #[inline(always)]
    fn noise(&self, ray: &LaneRay<S>) -> Lanes<S> {
        // terms of a dot product with a unit vector add up to less than the taxicab length
        (self.along.taxicab() + self.rise.abs() * self.slope) * ray.speed * (1.01 * SQUARE_NOISE)
    }

    #[inline(always)]
    fn at(&self, s: Lanes<S>) -> [Lanes<S>; 2] {
        let (height, from) = (self.height + s * self.rise, self.from.plus(self.along.times(s)));
        [from.dot(self.along) - height * self.rise, from.length_squared() - height * height]
    }
}
