//! Cones in SIMD lanes, equal to [`Cone::crossings`].

use super::quadratic::{Form, Roots, Size};
use super::ray::{LaneRay, Uncertain};
use super::vector::{Lanes, Vec3Lanes, splat};
use crate::surface::cone::split;
use crate::surface::{Cone, SQUARE_NOISE};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A cone for each ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConeLanes<S: Simd> {
    pub apex: Vec3Lanes<S>,
    pub axis: Vec3Lanes<S>,
    pub slope: Lanes<S>,
}

impl<S: Simd> ConeLanes<S> {
    /// The same cone for all rays.
    #[inline(always)]
    pub fn same(simd: S, cone: &Cone) -> Self {
        let [apex, axis] = [cone.apex, cone.axis];
        ConeLanes {
            apex: Vec3Lanes::splat(simd, apex),
            axis: Vec3Lanes::splat(simd, axis),
            slope: splat(simd, cone.slope),
        }
    }

    /// Half of the largest change of the gradient per unit of length.
    #[inline(always)]
    pub fn bend(&self) -> Lanes<S> {
        self.slope * self.slope + 1.0
    }
}

/// Rays in cone coordinates: the slope times the axial component, and the perpendicular component.
struct Line<S: Simd> {
    shift: Lanes<S>,
    height: Lanes<S>,
    from: Vec3Lanes<S>,
    rise: Lanes<S>,
    along: Vec3Lanes<S>,
    slope: Lanes<S>,
}

/// Roots of the rays with the cone.
#[inline(always)]
pub(super) fn roots<S: Simd>(
    simd: S,
    cone: &ConeLanes<S>,
    ray: &LaneRay<S>,
    uncertain: &mut Uncertain<S>,
) -> Roots<S> {
    let &ConeLanes { apex, axis, slope } = cone;
    let shift = apex.minus(ray.origin).dot(ray.direction) / ray.square;
    let place = ray.origin.minus(apex).plus(ray.direction.times(shift));
    let ((height, from), (rise, along)) = (split(place, axis, slope), split(ray.direction, axis, slope));
    let zero = splat(simd, 0.0);
    let size = Size { place, bend: cone.bend(), linear: zero, constant: zero };
    Line { shift, height, from, rise, along, slope }.roots(simd, ray, Some(size), uncertain)
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
        let at = (self.height + s * self.rise, self.from.plus(self.along.times(s)));
        let [_, b, c] = Cone::coefficients(at, (self.rise, self.along));
        [b, c]
    }
}
