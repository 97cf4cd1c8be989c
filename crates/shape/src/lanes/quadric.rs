//! Quadrics in SIMD lanes, equal to [`Quadric::crossings`].

use super::quadratic::{Form, Roots, Size};
use super::ray::{LaneRay, Uncertain};
use super::vector::{Lanes, Vec3Lanes, splat};
use crate::surface::quadric::{coefficients, time_of_least_terms};
use crate::surface::{Quadric, SQUARE_NOISE};
use fearless_simd::Simd;
use rayweave_math::Vec3;

/// A quadric, with precomputed data for its kernel.
#[derive(Clone, Copy, Debug)]
pub struct LaneQuadric {
    quadric: Quadric,
    pub(super) is_ruled: bool,
    /// Length of the linear part.
    pub(super) linear: f64,
    /// True if f may be negative far away.
    pub(super) may_open: bool,
}

impl LaneQuadric {
    pub(super) fn of(quadric: &Quadric) -> LaneQuadric {
        LaneQuadric {
            quadric: *quadric,
            is_ruled: quadric.is_ruled(),
            linear: quadric.linear.length(),
            may_open: quadric.weights.min_element() < 0.0,
        }
    }

    /// The point between the two pieces of the inside of a cone or a hyperboloid of two sheets.
    pub(super) fn waist(&self) -> Option<Vec3> {
        let Quadric { centre, axes, weights, linear, constant } = &self.quadric;
        let downwards = weights.to_array().iter().filter(|&&w| w < 0.0).count();
        if downwards != 1 || weights.to_array().contains(&0.0) {
            return None;
        }
        let shift = Vec3::from_array(std::array::from_fn(|k| -0.5 * axes[k].dot(*linear) / weights[k]));
        let squares = (*weights * shift).dot(shift);
        let has_two = constant - squares >= -1e-12 * (constant.abs() + squares.abs());
        has_two.then(|| *centre + shift.x * axes[0] + shift.y * axes[1] + shift.z * axes[2])
    }

    /// Roots of the rays with the quadric.
    #[inline(always)]
    pub(super) fn roots<S: Simd>(&self, simd: S, ray: &LaneRay<S>, uncertain: &mut Uncertain<S>) -> Roots<S> {
        QuadricLanes::same(simd, self).roots(simd, ray, self.is_ruled, uncertain)
    }

    /// The surface.
    pub(super) fn quadric(&self) -> &Quadric {
        &self.quadric
    }
}

/// A quadric for each ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct QuadricLanes<S: Simd> {
    pub centre: Vec3Lanes<S>,
    pub axes: [Vec3Lanes<S>; 3],
    pub weights: Vec3Lanes<S>,
    pub linear: Vec3Lanes<S>,
    pub constant: Lanes<S>,
    /// Length of the linear part.
    pub slope: Lanes<S>,
}

impl<S: Simd> QuadricLanes<S> {
    /// The same quadric for all rays.
    #[inline(always)]
    fn same(simd: S, of: &LaneQuadric) -> Self {
        let Quadric { centre, axes: [a, b, c], weights, linear, constant } = of.quadric;
        let axes = [Vec3Lanes::splat(simd, a), Vec3Lanes::splat(simd, b), Vec3Lanes::splat(simd, c)];
        QuadricLanes {
            centre: Vec3Lanes::splat(simd, centre),
            axes,
            weights: Vec3Lanes::splat(simd, weights),
            linear: Vec3Lanes::splat(simd, linear),
            constant: splat(simd, constant),
            slope: splat(simd, of.linear),
        }
    }

    /// Roots of the rays with the quadrics; `is_ruled` is that of all of them.
    #[inline(always)]
    pub fn roots(&self, simd: S, ray: &LaneRay<S>, is_ruled: bool, uncertain: &mut Uncertain<S>) -> Roots<S> {
        let &QuadricLanes { centre, weights, linear, constant, slope, .. } = self;
        let mut shift = centre.minus(ray.origin).dot(ray.direction) / ray.square;
        let mut place = ray.origin.minus(centre).plus(ray.direction.times(shift));
        let (mut level, rise) = (place.dot(linear) + constant, ray.direction.dot(linear));
        let (mut x, v) = (self.coordinates(place), self.coordinates(ray.direction));
        if is_ruled {
            // if noise matters, it exceeds the square term, and the lane is uncertain
            let later = time_of_least_terms(weights, (x, v), rise, splat(simd, 0.0));
            shift += later;
            place = place.plus(ray.direction.times(later));
            x = x.plus(v.times(later));
            level += later * rise;
        }
        let size = Size { place, bend: splat(simd, 1.0), linear: slope, constant };
        let line = Line { shift, weights, x, v, level, rise };
        line.roots(simd, ray, is_ruled.then_some(size), uncertain)
    }

    /// Coordinates along the principal axes.
    #[inline(always)]
    fn coordinates(&self, v: Vec3Lanes<S>) -> Vec3Lanes<S> {
        let [x, y, z] = &self.axes;
        Vec3Lanes { x: v.dot(*x), y: v.dot(*y), z: v.dot(*z) }
    }
}

/// Rays in quadric coordinates: points and directions along the principal axes, and the non-square part of f with its rate.
struct Line<S: Simd> {
    shift: Lanes<S>,
    weights: Vec3Lanes<S>,
    x: Vec3Lanes<S>,
    v: Vec3Lanes<S>,
    level: Lanes<S>,
    rise: Lanes<S>,
}

impl<S: Simd> Form<S> for Line<S> {
    #[inline(always)]
    fn shift(&self) -> Lanes<S> {
        self.shift
    }

    #[inline(always)]
    fn square(&self) -> Lanes<S> {
        self.v.times_each(self.weights).dot(self.v)
    }

    #[inline(always)]
    fn noise(&self, ray: &LaneRay<S>) -> Lanes<S> {
        // terms of a dot product with a unit vector add up to less than the taxicab length
        self.v.abs().dot(self.weights.abs()) * ray.speed * (1.01 * SQUARE_NOISE)
    }

    #[inline(always)]
    fn at(&self, s: Lanes<S>) -> [Lanes<S>; 2] {
        let (x, level) = (self.x.plus(self.v.times(s)), self.level + s * self.rise);
        let [_, b, c] = coefficients(self.weights, (x, self.v), (level, self.rise));
        [b, c]
    }
}
