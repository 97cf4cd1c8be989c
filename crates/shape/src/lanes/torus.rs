//! Tori along eight rays, as [`Torus::crossings`].

use super::ray::{Doubt, LaneRay, infinite};
use super::span::Gap;
use super::torus_line::{Lines, Ring, Root};
use super::vector::{Lanes, Mask, Vec3Lanes};
use crate::surface::{AffineTorus, Torus, delta_of};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::{Affine, Mat3, Vec3};

/// A torus, or the image of one.
#[derive(Clone, Copy, Debug)]
pub struct LaneTorus {
    /// As the image of a torus about the origin.
    image: AffineTorus,
    /// True if it is another torus.
    is_torus: bool,
    /// The most by which the map into the frame of that torus stretches a length.
    stretch: f64,
    /// The other torus in units of its own.
    ring: Ring,
}

/// Rays in the frame of a torus about the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach<S: Simd> {
    /// When they are closest to the centre.
    shift: Lanes<S>,
    /// Where they are then.
    place: Vec3Lanes<S>,
    direction: Vec3Lanes<S>,
    /// The squares of the lengths of the directions.
    square: Lanes<S>,
}

/// Where a ray is inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch<S: Simd> {
    /// When it enters first.
    pub from: Lanes<S>,
    /// When it leaves for good.
    pub to: Lanes<S>,
    /// The time between in which it is outside, if there is any.
    pub gap: Gap<S>,
}

/// Images that are squeezed by more are asked one by one.
const MOST_SQUEEZED: f64 = 1e6;
/// Room around the torus, relative to its size.
const ROOM: f64 = 1e-3;

impl LaneTorus {
    pub(super) fn plain(torus: &Torus) -> LaneTorus {
        let image = AffineTorus {
            centre: torus.centre,
            local_from_world: Mat3::IDENTITY,
            world_from_local: Mat3::IDENTITY,
            torus: Torus { centre: Vec3::ZERO, ..*torus },
        };
        LaneTorus { image, is_torus: true, stretch: 1.0, ring: Ring::of(torus) }
    }

    /// `None` for an image that is too thin.
    pub(super) fn image(image: &AffineTorus) -> Option<LaneTorus> {
        let stretch = |m: Mat3| Affine::from_linear(m).stretch();
        let (down, up) = (stretch(image.local_from_world), stretch(image.world_from_local));
        let is_mild = down * up < MOST_SQUEEZED;
        let ring = Ring::of(&image.torus);
        is_mild.then_some(LaneTorus { image: *image, is_torus: false, stretch: down, ring })
    }

    /// The rays where they are closest to the centre.
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

    /// False where a ray passes the ball around the torus for certain.
    #[inline(always)]
    pub(super) fn may_meet<S: Simd>(&self, ray: &LaneRay<S>, approach: &Approach<S>) -> Mask<S> {
        let Torus { major, minor, .. } = self.image.torus;
        // the rounding of the place, with much room
        let outer = ray.near * self.stretch + (major + minor) * (1.0 + ROOM);
        !approach.place.length_squared().simd_gt(outer * outer)
    }

    /// Where the rays are inside.
    #[inline(always)]
    pub(super) fn stretch<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        approach: &Approach<S>,
        asked: Mask<S>,
        doubt: &mut Doubt<S>,
    ) -> Stretch<S> {
        let Approach { shift, place, direction, square } = *approach;
        let length = square.sqrt();
        let (lines, rate) = Lines::new(&self.ring, place, direction, length);
        let Some(roots) = lines.roots(simd, asked) else { return Stretch::none(simd) };
        let [from, to] = [roots.ends[0].s / rate + shift + 0.0, roots.ends[1].s / rate + shift + 0.0];
        let mut sure = from.simd_lt(to) & from.abs().max(to.abs()).simd_lt(f64::INFINITY);
        let ends = [(&roots.ends[0], from), (&roots.ends[1], to)];
        let mut gentle = self.is_gentle(ray, length, ends[0]) | self.is_gentle(ray, length, ends[1]);
        let mut stretch = Stretch::none(simd);
        if let Some([leaves, enters]) = &roots.gap {
            let [a, b] = [leaves.s / rate + shift + 0.0, enters.s / rate + shift + 0.0];
            sure &= !roots.two | (from.simd_lt(a) & a.simd_lt(b) & b.simd_lt(to));
            let either = self.is_gentle(ray, length, (leaves, a)) | self.is_gentle(ray, length, (enters, b));
            gentle |= roots.two & either;
            stretch.gap = stretch.gap.or(roots.two, a, b);
        }
        doubt.always |= roots.unsure | (roots.some & !sure);
        doubt.grazes |= roots.some & gentle;
        stretch.from = roots.some.select(from, stretch.from);
        stretch.to = roots.some.select(to, stretch.to);
        stretch
    }

    #[inline(always)]
    fn local<S: Simd>(&self, v: Vec3Lanes<S>) -> Vec3Lanes<S> {
        let map = &self.image.local_from_world;
        v.dots([map.row(0), map.row(1), map.row(2)])
    }

    /// True if the torus may be met at a grazing angle at a time: then it is not told how long the ray keeps to it.
    ///
    /// In the torus's own frame, by arc length, `delta` being the tolerance at the later end of a piece [0, h] that begins
    /// at a root (or ends there), times `stretch`. Where a ray is within it, the distance D from the circle in the middle
    /// of the tube is at most `c = minor + 2 delta`, as |g| = |D^2 - minor^2| <= delta |grad g| = 2 delta D.
    ///
    /// 1. `F = g (g + 4 major rho)` is a quartic with leading coefficient 1, and its second factor is at most `2 D^2 + 8
    ///    major^2`. From the five points that [`hugs`](crate::surface::hugs) looks at, a quarter of h apart, the fourth
    ///    difference is `24 (h / 4)^4 <= 16 max |F|`; so `h^4 <= long = 342 delta c (2 c^2 + 8 major^2)`.
    /// 2. Where such a piece keeps to half of its first distance rho from the axis, `rho^4 > 16 long`, g has there a
    ///    second derivative of at most `bend = 2 + 4 major / rho`. If its slope at the root is steeper than `bend h / 4`
    ///    for all such h, then `|g(h / 4) - g(0)| >= slope h / 8`, which is at most `4 delta c`: `h <= 32 delta c / slope`.
    ///
    /// [`LaneRay::may_hug`] is in doubt up to `8e5 delta / stretch` in the world, counted by the taxicab length of the
    /// direction. That is more if `slope |d| > 1.2e-4 minor stretch |d world|` (and delta <= minor). What remains is that
    /// delta belongs to the later end. Up to a time as far from the root as the root is from all the origins of lengths
    /// it is at most twice that at the root, which is taken here; for a piece longer than that, 1. says that there is none.
    ///
    /// The slope is taken where g was looked at last, a step from the root, an eighth of rho at most; so `1 / rho` is
    /// larger by 8/7 at most, and the slope smaller by `bend step`. All in units in which major + minor is about 1.
    #[inline(always)]
    fn is_gentle<S: Simd>(
        &self,
        ray: &LaneRay<S>,
        length: Lanes<S>,
        (root, t): (&Root<S>, Lanes<S>),
    ) -> Mask<S> {
        let Ring { scale, major, minor, .. } = self.ring;
        let delta = ray.lengths_at(t) * (2.0 * self.stretch * scale * delta_of(1.0));
        let c = delta * 2.0 + minor;
        let long = delta * c * 342.0 * (c * c * 2.0 + 8.0 * major * major);
        let inverse = root.inverse * 1.15;
        let bend = inverse * (4.0 * major) + 2.0;
        let slope = root.slope.abs() * 2.0 - bend * root.step;
        let (steep, twice) = (slope * 4.0, inverse * 2.0);
        let is_steep = slope.simd_gt(0.0)
            & fourth(steep).simd_gt(long * fourth(bend))
            & (long * fourth(twice)).simd_lt(1.0)
            & (slope * length).simd_gt(ray.speed * (1.2e-4 * minor * self.stretch))
            & delta.simd_le(minor)
            & (root.step * 8.0 * root.inverse).simd_le(1.0);
        !is_steep
    }
}

#[inline(always)]
fn fourth<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    (x * x) * (x * x)
}

impl<S: Simd> Stretch<S> {
    /// Nowhere.
    #[inline(always)]
    pub(super) fn none(simd: S) -> Self {
        let [plus, minus] = infinite(simd);
        Stretch { from: plus, to: minus, gap: Gap { from: plus, to: minus } }
    }
}
