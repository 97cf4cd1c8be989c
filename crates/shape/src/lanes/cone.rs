//! Cones in SIMD lanes, equal to [`Cone::crossings`].

use super::quadratic::{Form, Roots, Size};
use super::ray::{LaneRay, Uncertain};
use super::vector::{Lanes, Vec3Lanes};
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
    let ((height, from), (rise, along)) = (cone.split(place), cone.split(ray.direction));
    let size = Size { place, bend: bend(cone), linear: 0.0, constant: 0.0 };
    Line { shift, height, from, rise, along, slope: cone.slope }.roots(simd, ray, Some(size), uncertain)
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
