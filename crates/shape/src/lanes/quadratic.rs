//! Surfaces of degree 2 in SIMD lanes.
//!
//! The operations are those of [`quadratic_crossings`](crate::surface::quadratic_crossings) and
//! [`quadratic`](fn@rayweave_math::roots::quadratic), which document their derivation.

use super::ray::{LaneRay, Uncertain};
use super::span::LaneSpan;
use super::vector::{Lanes, Mask, Vec3Lanes, splat};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::UNIT_ROUNDOFF;

/// f along the rays: `square s^2 + 2 b s + c` about the time `shift + s`. (A trait, because a closure in place of
/// [`Form::at`] might not be inlined, and would then be compiled for a different instruction set.)
pub(super) trait Form<S: Simd> {
    /// Time of closest approach to the centre of the surface.
    fn shift(&self) -> Lanes<S>;
    /// The square term.
    fn square(&self) -> Lanes<S>;
    /// A bound of the error of the square term, at least that of the scalar kernel.
    fn noise(&self, ray: &LaneRay<S>) -> Lanes<S>;
    /// The other coefficients, `[b, c]`.
    fn at(&self, s: Lanes<S>) -> [Lanes<S>; 2];

    /// The roots. For a ruled surface, `size` makes lanes uncertain whose ray may lie in the surface.
    #[inline(always)]
    fn roots(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        size: Option<Size<S>>,
        uncertain: &mut Uncertain<S>,
    ) -> Roots<S> {
        let (zero, a) = (splat(simd, 0.0), self.square());
        let ([mut b, mut c], mut shift) = (self.at(zero), self.shift());
        if let Some(size) = size {
            uncertain.always |= may_lie_in(ray, ray.middle - shift, [a, b, c], &size);
        }
        // b^2 and a c are equal within a factor of 2
        let square = b * b;
        let cancels = ((square - a * c).abs() * 2.0).simd_lt(square);
        if cancels.any_true() {
            let again = -b / a;
            let again = (cancels & again.abs().simd_lt(f64::INFINITY)).select(again, zero);
            [b, c] = self.at(again);
            shift += again;
        }
        // the scalar kernel drops crossings that rounding may have made
        uncertain.always |= a.abs().simd_lt(self.noise(ray));
        uncertain.always |= !(in_fast_range(a) & in_fast_range(b) & in_fast_range(c));
        let mut roots = solved(simd, shift, [a, b, c]);
        let linear = a.simd_eq(zero);
        if linear.any_true() {
            let (from, to) = solved_linear(simd, shift, [b, c]);
            roots.from = linear.select(from, roots.from);
            roots.to = linear.select(to, roots.to);
        }
        roots
    }
}

/// The interval in which the sign of f is opposite to its sign far away; empty, from +inf to -inf, if there is none. If
/// the square term is 0, the interval in which f < 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roots<S: Simd> {
    /// Start of the interval.
    pub from: Lanes<S>,
    /// End of the interval.
    pub to: Lanes<S>,
    /// True if f < 0 far away.
    pub opens: Mask<S>,
    /// The square term.
    pub square: Lanes<S>,
    /// A quarter of the squared slope of f at both ends.
    pub discriminant: Lanes<S>,
}

/// Data for a bound of |f| within the tolerance of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size<S: Simd> {
    /// The point of closest approach to the centre of the surface, relative to it.
    pub place: Vec3Lanes<S>,
    /// Half of the largest change of the gradient per unit of length.
    pub bend: Lanes<S>,
    /// Length of the gradient at the centre.
    pub linear: Lanes<S>,
    /// Value at the centre.
    pub constant: Lanes<S>,
}

/// Square of 1e-4: see [`Roots::is_gentle`].
const GENTLE_SQUARE: f64 = 1e-8;

/// True for 0 and for 2^-450 <= |x| <= 2^450.
#[inline(always)]
fn in_fast_range<S: Simd>(x: Lanes<S>) -> Mask<S> {
    const LEAST: f64 = f64::from_bits((1023 - 450) << 52);
    const LARGEST: f64 = f64::from_bits((1023 + 450) << 52);
    let size = x.abs();
    (size.simd_ge(LEAST) & size.simd_le(LARGEST)) | size.simd_eq(0.0)
}

/// The two roots if the square term is not 0.
#[inline(always)]
fn solved<S: Simd>(simd: S, shift: Lanes<S>, [a, b, c]: [Lanes<S>; 3]) -> Roots<S> {
    let discriminant = difference_of_products(b, a, c);
    let q = -(b + discriminant.sqrt().copysign(b));
    let (s, t) = (q / a, c / q);
    let [plus, minus] = super::ray::infinite(simd);
    let some = discriminant.simd_gt(0.0);
    Roots {
        from: some.select(s.min(t) + shift + 0.0, plus),
        to: some.select(s.max(t) + shift + 0.0, minus),
        opens: a.simd_lt(0.0),
        square: a,
        discriminant,
    }
}

/// The interval in which `2 b s + c < 0`.
#[inline(always)]
fn solved_linear<S: Simd>(simd: S, shift: Lanes<S>, [b, c]: [Lanes<S>; 2]) -> (Lanes<S>, Lanes<S>) {
    let [plus, minus] = super::ray::infinite(simd);
    let t = -(c * 0.5) / b + shift + 0.0;
    let rises = b.simd_gt(0.0);
    let (from, to) = (rises.select(minus, t), rises.select(t, plus));
    let (flat, below) = (b.simd_eq(0.0), c.simd_lt(0.0));
    (flat.select(below.select(minus, plus), from), flat.select(below.select(plus, minus), to))
}

/// `b b - a c`, as in [`rayweave_math::roots::difference_of_products`].
#[inline(always)]
fn difference_of_products<S: Simd>(b: Lanes<S>, a: Lanes<S>, c: Lanes<S>) -> Lanes<S> {
    let (p, p_error) = two_product(b, b);
    let (q, q_error) = two_product(a, c);
    let (high, high_error) = two_sum(p, -q);
    let (low, low_error) = two_sum(p_error, -q_error);
    (high + low) + (high_error + low_error)
}

#[inline(always)]
fn two_sum<S: Simd>(a: Lanes<S>, b: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

#[inline(always)]
fn two_product<S: Simd>(a: Lanes<S>, b: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let product = a * b;
    let (ah, al) = split(a);
    let (bh, bl) = split(b);
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

#[inline(always)]
fn split<S: Simd>(a: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let shifted = a * 134_217_729.0; // 2^27 + 1
    let high = shifted - (shifted - a);
    (high, a - high)
}

/// True if the ray may lie in the surface, judged by a single value of f in the middle of the chord, at the time `late`
/// after the closest approach to the centre.
///
/// Within a distance M of the centre the gradient is at most `2 bend M + linear`, so a ray in the surface has
/// `|f| <= delta (2 bend M + linear)` there, and `near` is at least twice that delta. Both this value and the one of
/// [`Chord::lies_in`](crate::surface::Chord::lies_in) have an error of at most `3 u L (2 bend M + linear)` from the
/// rounding of the point, with L the lengths in delta = 64 u L, and `20 u bend M^2 + 4 u (linear M + |constant|)` from
/// the rounding of the terms, where M is below 6 L. Twice the bound plus `16 u |constant|` exceeds the sum of all these.
#[inline(always)]
fn may_lie_in<S: Simd>(
    ray: &LaneRay<S>,
    late: Lanes<S>,
    [a, b, c]: [Lanes<S>; 3],
    size: &Size<S>,
) -> Mask<S> {
    let value = (a * late + b * 2.0) * late + c;
    let far = size.place.taxicab() + late.abs() * ray.speed + ray.near;
    let bound = ray.near * (far * (size.bend * 4.0) + size.linear * 2.0);
    value.abs().simd_le(bound + size.constant.abs() * (16.0 * UNIT_ROUNDOFF))
}

impl<S: Simd> Roots<S> {
    /// True if the surface is crossed at the root `t` at a grazing angle, and the square term is too small to bound how
    /// long the ray stays close to the surface.
    ///
    /// If the slope at the root is larger, a piece of length h that begins or ends there coincides with the surface only if
    /// it is short: f is a quadratic, so `|slope| h = |4 f(middle) - f(end) - 3 f(root)| <= 8 max |f|`, where `|f|` is at
    /// most `delta (G + bend delta)`. `G = 2 bend L` bounds the gradient including its linear part, with L the lengths in
    /// `delta = 64 u L` at the later end. `|slope| > 1e-4 |d| G` at the root implies `|d| h <= 8e4 delta L / L(root)`,
    /// where |d| is the taxicab length, as in [`LaneRay::may_coincide`], which reports pieces up to `8e5 delta` as
    /// uncertain: enough for L below 10 L(root). Farther away |d| h is at least 0.9 L, so L would have to be 1e9 L(root);
    /// such times are uncertain, too.
    #[inline(always)]
    pub fn is_gentle(&self, ray: &LaneRay<S>, t: Lanes<S>, bend: Lanes<S>) -> Mask<S> {
        let slope = ray.lengths_at(t) * ray.speed * bend;
        let slow = self.square.abs().simd_lt(ray.slow_square);
        slow & !self.discriminant.simd_gt(slope * slope * GENTLE_SQUARE)
    }

    /// True if an end of a span is at a root.
    #[inline(always)]
    pub fn meets_ends(&self, span: &LaneSpan<S>) -> Mask<S> {
        let (from, to) = (self.from, self.to);
        let meets =
            from.simd_eq(span.from) | from.simd_eq(span.to) | to.simd_eq(span.from) | to.simd_eq(span.to);
        meets & self.is_some()
    }

    /// True if there are two roots.
    #[inline(always)]
    pub fn is_some(&self) -> Mask<S> {
        self.from.simd_lt(self.to)
    }

    /// True if the square term is small.
    #[inline(always)]
    pub fn is_slow(&self, ray: &LaneRay<S>) -> Mask<S> {
        self.square.abs().simd_lt(ray.slow_square)
    }
}
