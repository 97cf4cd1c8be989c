//! Surfaces of degree 2 along eight rays.
//!
//! The steps are those of [`quadratic_crossings`](crate::surface::quadratic_crossings) and of
//! [`quadratic`](fn@rayweave_math::roots::quadratic), which say where they come from and why they are what they are.

use super::ray::{Doubt, LaneRay};
use super::vector::{Lanes, Mask, Vec3Lanes, splat};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::UNIT_ROUNDOFF;

/// f along the rays: `square s^2 + 2 b s + c` about the time `shift + s`. (A closure in place of [`Form::at`] might not
/// be inlined, and then be compiled for another instruction set.)
pub(super) trait Form<S: Simd> {
    /// When the rays are closest to the centre of the surface.
    fn shift(&self) -> Lanes<S>;
    /// The factor of the square.
    fn square(&self) -> Lanes<S>;
    /// The other coefficients, `[b, c]`.
    fn at(&self, s: Lanes<S>) -> [Lanes<S>; 2];

    /// The roots; for a ruled surface with its `size`, whether rays may lie in it.
    #[inline(always)]
    fn roots(&self, simd: S, ray: &LaneRay<S>, size: Option<Size<S>>, doubt: &mut Doubt<S>) -> Roots<S> {
        let (zero, a) = (splat(simd, 0.0), self.square());
        let ([mut b, mut c], mut shift) = (self.at(zero), self.shift());
        if let Some(size) = size {
            doubt.always |= may_lie_in(ray, ray.middle - shift, [a, b, c], &size);
        }
        // b^2 and a c are equal within a factor 2
        let square = b * b;
        let cancels = ((square - a * c).abs() * 2.0).simd_lt(square);
        if cancels.any_true() {
            let again = -b / a;
            let again = (cancels & again.abs().simd_lt(f64::INFINITY)).select(again, zero);
            [b, c] = self.at(again);
            shift += again;
        }
        doubt.always |= !(in_fast_range(a) & in_fast_range(b) & in_fast_range(c));
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

/// Where f has not the sign that it has far away: empty, from +inf to -inf, where it has that sign throughout. Where
/// the square term is 0, where f < 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roots<S: Simd> {
    /// When it begins.
    pub from: Lanes<S>,
    /// When it ends.
    pub to: Lanes<S>,
    /// True where f < 0 far away.
    pub opens: Mask<S>,
    /// The square term.
    pub square: Lanes<S>,
    /// A quarter of the square of the slope of f at both ends.
    pub discriminant: Lanes<S>,
}

/// How much f can be where a ray is within the tolerance of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size<S: Simd> {
    /// The place from the centre of the surface when the rays are closest to it.
    pub place: Vec3Lanes<S>,
    /// Half of the most by which the gradient changes over a unit of length.
    pub bend: f64,
    /// The length of the gradient at the centre.
    pub linear: f64,
    /// The value there.
    pub constant: f64,
}

/// The square of 1e-4: see [`Roots::is_gentle`].
const GENTLE_SQUARE: f64 = 1e-8;

/// 0 or 2^-450 <= |x| <= 2^450.
#[inline(always)]
fn in_fast_range<S: Simd>(x: Lanes<S>) -> Mask<S> {
    const LEAST: f64 = f64::from_bits((1023 - 450) << 52);
    const LARGEST: f64 = f64::from_bits((1023 + 450) << 52);
    let size = x.abs();
    (size.simd_ge(LEAST) & size.simd_le(LARGEST)) | size.simd_eq(0.0)
}

/// The two roots for a square term that is not 0.
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

/// Where `2 b s + c < 0`.
#[inline(always)]
fn solved_linear<S: Simd>(simd: S, shift: Lanes<S>, [b, c]: [Lanes<S>; 2]) -> (Lanes<S>, Lanes<S>) {
    let [plus, minus] = super::ray::infinite(simd);
    let t = -(c * 0.5) / b + shift + 0.0;
    let rises = b.simd_gt(0.0);
    let (from, to) = (rises.select(minus, t), rises.select(t, plus));
    let (flat, below) = (b.simd_eq(0.0), c.simd_lt(0.0));
    (flat.select(below.select(minus, plus), from), flat.select(below.select(plus, minus), to))
}

/// `b b - a c`, as [`rayweave_math::roots::difference_of_products`].
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

/// True where the rays may lie in the surface for all that one value can tell, `late` after they were closest to its
/// centre: in the middle of the chord.
///
/// No farther than M from the centre the gradient is at most `2 bend M + linear`, so a ray that lies in the surface has
/// `|f| <= delta (2 bend M + linear)` there, and `near` is twice that delta at least. Both this value and the one that
/// [`Chord::lies_in`](crate::surface::Chord::lies_in) finds are off by at most some `3 u L (2 bend M + linear)` for the
/// rounding of the point, with L the lengths in delta = 64 u L, and `20 u bend M^2 + 4 u (linear M + |constant|)` for
/// that of the terms, where M is below 6 L. Twice the bound, and `16 u |constant|`, are more than all that together.
#[inline(always)]
fn may_lie_in<S: Simd>(
    ray: &LaneRay<S>,
    late: Lanes<S>,
    [a, b, c]: [Lanes<S>; 3],
    size: &Size<S>,
) -> Mask<S> {
    let value = (a * late + b * 2.0) * late + c;
    let far = size.place.taxicab() + late.abs() * ray.speed + ray.near;
    let bound = ray.near * (far * (4.0 * size.bend) + 2.0 * size.linear);
    value.abs().simd_le(bound + 16.0 * UNIT_ROUNDOFF * size.constant.abs())
}

impl<S: Simd> Roots<S> {
    /// True where the surface is met at a time, one of the roots, at a grazing angle, and the square term is too small to
    /// tell how long the ray keeps to it.
    ///
    /// Where the slope is larger there, a piece of length h that begins or ends there keeps to the surface only if it is
    /// short: with f a quadratic, `|slope| h = |4 f(middle) - f(end) - 3 f(root)| <= 8 max |f|`, where `|f|` is at most
    /// `delta (G + bend delta)`. `G = 2 bend L` bounds the gradient, linear part included, L being the lengths in `delta
    /// = 64 u L` at the later end. With `|slope| > 1e-4 |d| G` at the root that makes `|d| h <= 8e4 delta L / L(root)`,
    /// where |d| is the taxicab length, as in [`LaneRay::may_hug`], which is in doubt up to `8e5 delta`: enough for an L
    /// below 10 L(root). Farther away |d| h is L at least but for a tenth, so that L would have to be 1e9 L(root): such
    /// times are in doubt, too.
    #[inline(always)]
    pub fn is_gentle(&self, ray: &LaneRay<S>, t: Lanes<S>, bend: f64) -> Mask<S> {
        let slope = ray.lengths_at(t) * ray.speed * bend;
        let slow = self.square.abs().simd_lt(ray.slow_square);
        slow & !self.discriminant.simd_gt(slope * slope * GENTLE_SQUARE)
    }

    /// True where there are two.
    #[inline(always)]
    pub fn is_some(&self) -> Mask<S> {
        self.from.simd_lt(self.to)
    }

    /// True where the square term is small.
    #[inline(always)]
    pub fn is_slow(&self, ray: &LaneRay<S>) -> Mask<S> {
        self.square.abs().simd_lt(ray.slow_square)
    }
}
