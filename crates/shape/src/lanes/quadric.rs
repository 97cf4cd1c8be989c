//! Quadrics in SIMD lanes, equal to [`Quadric::crossings`].

use super::quadratic::{Form, Roots, Size};
use super::ray::{LaneRay, Uncertain};
use super::vector::{Lanes, Vec3Lanes, splat};
use crate::surface::{Quadric, SQUARE_NOISE};
use fearless_simd::Simd;
use rayweave_math::Vec3;

/// A quadric, with precomputed data for its kernel.
#[derive(Clone, Copy, Debug)]
pub struct LaneQuadric {
    quadric: Quadric,
    is_ruled: bool,
    /// Length of the linear part.
    linear: f64,
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
        let Quadric { centre, weights, linear, constant, .. } = self.quadric;
        let shift = ray.origin.taken_from(centre).dot(ray.direction) / ray.square;
        let place = ray.origin.minus_all(centre).plus(ray.direction.times(shift));
        let (level, rise) = (place.dot_all(linear) + constant, ray.direction.dot_all(linear));
        let (x, v) = (self.coordinates(place), self.coordinates(ray.direction));
        let size = Size { place, bend: 1.0, linear: self.linear, constant };
        let line = Line { shift, weights, x, v, level, rise };
        line.roots(simd, ray, self.is_ruled.then_some(size), uncertain)
    }

    /// `[a, b]` of f along rays from the surface, `a t^2 + 2 b t`.
    #[inline(always)]
    pub(super) fn departure<S: Simd>(&self, ray: &LaneRay<S>) -> [Lanes<S>; 2] {
        let Quadric { centre, weights, linear, .. } = self.quadric;
        let (x, v) = (self.coordinates(ray.origin.minus_all(centre)), self.coordinates(ray.direction));
        let (wx, wv) = (x.times_all(weights), v.times_all(weights));
        [wv.dot(v), wx.dot(v) + ray.direction.dot_all(linear) * 0.5]
    }

    /// Lane version of [`Quadric::value_and_gradient`].
    #[inline(always)]
    pub(super) fn value_and_gradient<S: Simd>(
        &self,
        simd: S,
        point: Vec3Lanes<S>,
    ) -> (Lanes<S>, Vec3Lanes<S>) {
        let Quadric { centre, axes, weights, linear, constant } = self.quadric;
        let from = point.minus_all(centre);
        let x = self.coordinates(from);
        let wx = x.times_all(weights);
        let value = wx.dot(x) + (from.dot_all(linear) + constant);
        let [i, j, k] = axes;
        let along = Vec3Lanes::splat(simd, i)
            .times(wx.x)
            .plus(Vec3Lanes::splat(simd, j).times(wx.y))
            .plus(Vec3Lanes::splat(simd, k).times(wx.z));
        (value, along.times(splat(simd, 2.0)).plus(Vec3Lanes::splat(simd, linear)))
    }

    /// Coordinates along the principal axes.
    #[inline(always)]
    fn coordinates<S: Simd>(&self, v: Vec3Lanes<S>) -> Vec3Lanes<S> {
        let [x, y, z] = self.quadric.axes;
        Vec3Lanes { x: v.dot_all(x), y: v.dot_all(y), z: v.dot_all(z) }
    }
}

/// Rays in quadric coordinates: points and directions along the principal axes, and the non-square part of f with its rate.
struct Line<S: Simd> {
    shift: Lanes<S>,
    weights: Vec3,
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
        self.v.times_all(self.weights).dot(self.v)
    }

    #[inline(always)]
    fn noise(&self, ray: &LaneRay<S>) -> Lanes<S> {
        // terms of a dot product with a unit vector add up to less than the taxicab length
        self.v.abs().dot_all(self.weights.abs()) * ray.speed * (1.01 * SQUARE_NOISE)
    }

    #[inline(always)]
    fn at(&self, s: Lanes<S>) -> [Lanes<S>; 2] {
        let (x, level) = (self.x.plus(self.v.times(s)), self.level + s * self.rise);
        let wx = x.times_all(self.weights);
        [wx.dot(self.v) + self.rise * 0.5, wx.dot(x) + level]
    }
}
