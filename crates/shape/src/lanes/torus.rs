//! Tori in SIMD lanes, equal to [`Torus::crossings`].

use super::ray::{LaneRay, Uncertain, infinite};
use super::span::Gap;
use super::torus_line::{Lines, Ring, Root};
use super::vector::{Lanes, Mask, Vec3Lanes};
use crate::surface::{AffineTorus, Torus, delta_of};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::{Affine, Mat3, Vec3};

/// A torus, or an affine image of one.
#[derive(Clone, Copy, Debug)]
pub struct LaneTorus {
    /// The torus as the image of a torus about the origin.
    image: AffineTorus,
    /// True if the image is a torus itself.
    is_torus: bool,
    /// Norm of the linear part of the map into the frame of the torus.
    norm: f64,
    /// The torus in its own units.
    ring: Ring,
}

/// Rays in the frame of a torus about the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach<S: Simd> {
    /// Time of closest approach to the centre.
    shift: Lanes<S>,
    /// Position at that time.
    place: Vec3Lanes<S>,
    direction: Vec3Lanes<S>,
    /// Squared lengths of the directions.
    square: Lanes<S>,
}

/// The interval of each ray inside the torus, with a possible gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct TorusInterval<S: Simd> {
    /// First entry.
    pub from: Lanes<S>,
    /// Last exit.
    pub to: Lanes<S>,
    /// The interval in between in which the ray is outside, if there is one.
    pub gap: Gap<S>,
}

/// Largest compression of an image; more strongly compressed images are left to the scalar kernel.
const MAX_SQUEEZED: f64 = 1e6;
/// Margin around the torus, relative to its size.
const ROOM: f64 = 1e-3;

impl LaneTorus {
    pub(super) fn plain(torus: &Torus) -> LaneTorus {
        let image = AffineTorus {
            centre: torus.centre,
            local_from_world: Mat3::IDENTITY,
            world_from_local: Mat3::IDENTITY,
            torus: Torus { centre: Vec3::ZERO, ..*torus },
        };
        LaneTorus { image, is_torus: true, norm: 1.0, ring: Ring::of(torus) }
    }

    /// A lane torus for an image; `None` if it is compressed too strongly.
    pub(super) fn image(image: &AffineTorus) -> Option<LaneTorus> {
        let norm = |m: Mat3| Affine::from_linear(m).linear_norm();
        let (down, up) = (norm(image.local_from_world), norm(image.world_from_local));
        let is_mild = down * up < MAX_SQUEEZED;
        let ring = Ring::of(&image.torus);
        is_mild.then_some(LaneTorus { image: *image, is_torus: false, norm: down, ring })
    }

    /// The rays at their closest approach to the centre.
    #[inline(always)]
    pub(super) fn approach<S: Simd>(&self, ray: &LaneRay<S>) -> Approach<S> {
        let (mut direction, mut square) = (ray.direction, ray.square);
        let mut from = ray.origin.minus_all(self.image.centre);
        let towards = match self.is_torus {
            true => ray.origin.taken_from(self.image.centre),
            false => {
                (from, direction) = (self.local(from), self.local(direction));
                square = direction.length_squared();
                from.taken_from(Vec3::ZERO)
            }
        };
        let shift = towards.dot(direction) / square;
        Approach { shift, place: from.plus(direction.times(shift)), direction, square }
    }

    /// False if a ray definitely misses the ball around the torus.
    #[inline(always)]
    pub(super) fn may_meet<S: Simd>(&self, ray: &LaneRay<S>, approach: &Approach<S>) -> Mask<S> {
        let Torus { major, minor, .. } = self.image.torus;
        // includes the rounding of the position, with a large margin
        let outer = ray.near * self.norm + (major + minor) * (1.0 + ROOM);
        !approach.place.length_squared().simd_gt(outer * outer)
    }

    /// Intervals of the rays inside the torus.
    #[inline(always)]
    pub(super) fn interval<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        approach: &Approach<S>,
        queried: Mask<S>,
        uncertain: &mut Uncertain<S>,
    ) -> TorusInterval<S> {
        let Approach { shift, place, direction, square } = *approach;
        let length = square.sqrt();
        let (lines, rate) = Lines::new(&self.ring, place, direction, length);
        let Some(roots) = lines.roots(simd, queried) else { return TorusInterval::none(simd) };
        let [from, to] = [roots.ends[0].s / rate + shift + 0.0, roots.ends[1].s / rate + shift + 0.0];
        let mut sure = from.simd_lt(to) & from.abs().max(to.abs()).simd_lt(f64::INFINITY);
        let ends = [(&roots.ends[0], from), (&roots.ends[1], to)];
        let mut gentle = self.is_gentle(ray, length, ends[0]) | self.is_gentle(ray, length, ends[1]);
        let mut interval = TorusInterval::none(simd);
        if let Some([leaves, enters]) = &roots.gap {
            let [a, b] = [leaves.s / rate + shift + 0.0, enters.s / rate + shift + 0.0];
            sure &= !roots.two | (from.simd_lt(a) & a.simd_lt(b) & b.simd_lt(to));
            let either = self.is_gentle(ray, length, (leaves, a)) | self.is_gentle(ray, length, (enters, b));
            gentle |= roots.two & either;
            interval.gap = interval.gap.or(roots.two, a, b);
        }
        uncertain.always |= roots.unsure | (roots.some & !sure);
        uncertain.grazes |= roots.some & gentle;
        interval.from = roots.some.select(from, interval.from);
        interval.to = roots.some.select(to, interval.to);
        interval
    }

    #[inline(always)]
    fn local<S: Simd>(&self, v: Vec3Lanes<S>) -> Vec3Lanes<S> {
        let map = &self.image.local_from_world;
        v.dots([map.row(0), map.row(1), map.row(2)])
    }

    /// True if the ray may cross the torus at a grazing angle at the given time, so that the time it stays close to the
    /// torus has no bound.
    ///
    /// The derivation uses the torus's own frame and arc length. `delta` is the tolerance at the later end of a piece [0,
    /// h] that begins (or ends) at a root, times `norm`. For a ray within it, the distance D from the centre circle of
    /// the tube is at most `c = minor + 2 delta`, as |g| = |D^2 - minor^2| <= delta |grad g| = 2 delta D.
    ///
    /// 1. `F = g (g + 4 major rho)` is a quartic with leading coefficient 1, and its second factor is at most
    ///    `2 D^2 + 8 major^2`. From the five points that [`coincides_along`](crate::surface::coincides_along) tests, a quarter of h apart, the
    ///    fourth difference is `24 (h / 4)^4 <= 16 max |F|`; so `h^4 <= long = 342 delta c (2 c^2 + 8 major^2)`.
    /// 2. If such a piece stays beyond half of its first distance rho from the axis, `rho^4 > 16 long`, the second
    ///    derivative of g is at most `bend = 2 + 4 major / rho` there. If the slope of g at the root is steeper than
    ///    `bend h / 4` for all such h, then `|g(h / 4) - g(0)| >= slope h / 8`, which is at most `4 delta c`:
    ///    `h <= 32 delta c / slope`.
    ///
    /// [`LaneRay::may_coincide`] reports pieces up to `8e5 delta / norm` in the world, in the taxicab length of the
    /// direction, as uncertain. That is more if `slope |d| > 1.2e-4 minor norm |d world|` (and delta <= minor). It remains
    /// that delta belongs to the later end. Up to a time as far from the root as the root is from all the origins of
    /// lengths, it is at most twice the delta at the root, which is used here; 1. excludes longer pieces.
    ///
    /// The slope is that of the last evaluation of g, one step from the root, at most an eighth of rho; so `1 / rho` is
    /// larger by at most 8/7, and the slope smaller by `bend step`. All lengths are in units in which major + minor is
    /// about 1.
    #[inline(always)]
    fn is_gentle<S: Simd>(
        &self,
        ray: &LaneRay<S>,
        length: Lanes<S>,
        (root, t): (&Root<S>, Lanes<S>),
    ) -> Mask<S> {
        let Ring { scale, major, minor, .. } = self.ring;
        let delta = ray.lengths_at(t) * (2.0 * self.norm * scale * delta_of(1.0));
        let c = delta * 2.0 + minor;
        let long = delta * c * 342.0 * (c * c * 2.0 + 8.0 * major * major);
        let inverse = root.inverse * 1.15;
        let bend = inverse * (4.0 * major) + 2.0;
        let slope = root.slope.abs() * 2.0 - bend * root.step;
        let (steep, twice) = (slope * 4.0, inverse * 2.0);
        let is_steep = slope.simd_gt(0.0)
            & fourth(steep).simd_gt(long * fourth(bend))
            & (long * fourth(twice)).simd_lt(1.0)
            & (slope * length).simd_gt(ray.speed * (1.2e-4 * minor * self.norm))
            & delta.simd_le(minor)
            & (root.step * 8.0 * root.inverse).simd_le(1.0);
        !is_steep
    }
}

#[inline(always)]
fn fourth<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    (x * x) * (x * x)
}

impl<S: Simd> TorusInterval<S> {
    /// An empty interval.
    #[inline(always)]
    pub(super) fn none(simd: S) -> Self {
        let [plus, minus] = infinite(simd);
        TorusInterval { from: plus, to: minus, gap: Gap { from: plus, to: minus } }
    }
}
