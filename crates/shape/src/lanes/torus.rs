//! Tori along eight rays, as [`Torus::crossings`]: which rays may meet one is found for all at once, where those do one
//! after the other.

use super::ray::{Doubt, LaneRay};
use super::span::Gap;
use super::vector::{LANES, Lanes, Mask, Vec3Lanes, splat};
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
        LaneTorus { image, is_torus: true, stretch: 1.0 }
    }

    /// `None` for an image that is too thin.
    pub(super) fn image(image: &AffineTorus) -> Option<LaneTorus> {
        let stretch = |m: Mat3| Affine::from_linear(m).stretch();
        let (down, up) = (stretch(image.local_from_world), stretch(image.world_from_local));
        let is_mild = down * up < MOST_SQUEEZED;
        is_mild.then_some(LaneTorus { image: *image, is_torus: false, stretch: down })
    }

    /// Where the rays are inside.
    #[inline(always)]
    pub(super) fn stretch<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        wanted: Mask<S>,
        doubt: &mut Doubt<S>,
    ) -> Stretch<S> {
        let mut found = Found::none();
        let asked = (self.may_meet(simd, ray) & wanted).to_bitmask();
        for k in (0..LANES).filter(|k| asked >> k & 1 == 1) {
            self.ask(ray, k, &mut found);
        }
        if asked != 0 {
            doubt.always |= Mask::from_bitmask(simd, found.unsure);
            doubt.grazes |= Mask::from_bitmask(simd, found.gentle);
        }
        let [from, to, gap_from, gap_to] = &found.times;
        let gap =
            Gap { from: Lanes::load_array_ref(simd, gap_from), to: Lanes::load_array_ref(simd, gap_to) };
        Stretch { from: Lanes::load_array_ref(simd, from), to: Lanes::load_array_ref(simd, to), gap }
    }

    /// False where a ray is sure to miss: outside of the ball around the torus, of the two planes that it lies between, or
    /// within its hole all the way from one plane to the other.
    #[inline(always)]
    fn may_meet<S: Simd>(&self, simd: S, ray: &LaneRay<S>) -> Mask<S> {
        let Torus { axis, major, minor, .. } = self.image.torus;
        let (place, direction, square) = self.closest(ray);
        // the rounding of the place, with much room
        let near = ray.near * self.stretch;
        let outer = near + (major + minor) * (1.0 + ROOM);
        let left = outer * outer - place.length_squared();
        let half = (left / square).sqrt();
        let thick = near + minor * (1.0 + ROOM);
        let (z, rise) = (place.dot_all(axis), direction.dot_all(axis));
        let (below, above) = ((-thick - z) / rise, (thick - z) / rise);
        let (from, to) = (below.min(above).max(-half), below.max(above).min(half));
        let hole = splat(simd, (major - minor) * (1.0 - ROOM)) - near;
        let (across, along) = (place.without(z, axis), direction.without(rise, axis));
        let first = across.plus(along.times(from)).length_squared();
        let last = across.plus(along.times(to)).length_squared();
        let within = hole.simd_gt(0.0) & first.max(last).simd_lt(hole * hole);
        left.simd_gt(0.0) & from.simd_lt(to) & !within
    }

    /// The places where the rays are closest to the centre, from it, in the torus's own frame; the directions there and
    /// the squares of their lengths.
    #[inline(always)]
    fn closest<S: Simd>(&self, ray: &LaneRay<S>) -> (Vec3Lanes<S>, Vec3Lanes<S>, Lanes<S>) {
        let (mut from, mut direction) = (ray.origin.minus_all(self.image.centre), ray.direction);
        let mut square = ray.square;
        if !self.is_torus {
            (from, direction) = (self.local(from), self.local(direction));
            square = direction.length_squared();
        }
        let shift = -from.dot(direction) / square;
        (from.plus(direction.times(shift)), direction, square)
    }

    #[inline(always)]
    fn local<S: Simd>(&self, v: Vec3Lanes<S>) -> Vec3Lanes<S> {
        let map = &self.image.local_from_world;
        Vec3Lanes { x: v.dot_all(map.row(0)), y: v.dot_all(map.row(1)), z: v.dot_all(map.row(2)) }
    }

    /// Asks the scalar kernel about lane `k`.
    fn ask<S: Simd>(&self, ray: &LaneRay<S>, k: usize, found: &mut Found) {
        let one = ray.lane(k);
        let crossings = match self.is_torus {
            true => Torus { centre: self.image.centre, ..self.image.torus }.crossings(&one),
            false => self.image.crossings(&one),
        };
        let times = match *crossings.times() {
            [] => return,
            [a, b] => [a, b, f64::INFINITY, f64::NEG_INFINITY],
            [a, b, c, d] => [a, d, b, c],
            _ => {
                found.unsure |= 1 << k;
                return;
            }
        };
        for (row, t) in found.times.iter_mut().zip(times) {
            row[k] = t;
        }
        let (lengths, speed) = (ray.lengths.as_slice()[k], ray.speed.as_slice()[k]);
        let is_gentle = |&t: &f64| self.is_gentle(&one, t, lengths + t.abs() * speed, speed);
        if crossings.times().iter().any(is_gentle) {
            found.gentle |= 1 << k;
        }
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
    fn is_gentle(&self, ray: &crate::Ray, t: f64, lengths: f64, speed: f64) -> bool {
        let Torus { axis, major, minor, .. } = self.image.torus;
        let delta = 2.0 * self.stretch * delta_of(lengths);
        let c = minor + 2.0 * delta;
        let long = 342.0 * delta * c * (2.0 * c * c + 8.0 * major * major);
        let place = self.image.local_from_world * (ray.at(t) - self.image.centre);
        let direction = self.image.local_from_world * ray.direction;
        let length = direction.length();
        let (z, rise) = (axis.dot(place), axis.dot(direction));
        let (across, along) = (place - z * axis, direction - rise * axis);
        let rho = across.length();
        let slope = 2.0 * ((rho - major) * across.dot(along) / rho + z * rise).abs() / length;
        let bend = 2.0 + 4.0 * major / rho;
        let (steep, far) = (4.0 * slope / bend, 0.5 * rho);
        let fourth = |x: f64| (x * x) * (x * x);
        let is_steep = fourth(steep) > long
            && fourth(far) > long
            && slope * length > 1.2e-4 * minor * self.stretch * speed
            && delta <= minor;
        !is_steep
    }
}

/// What the scalar kernel said.
struct Found {
    /// When the rays enter first, leave for good, leave first, and enter again.
    times: [[f64; LANES]; 4],
    /// Lanes that have to be asked again, a bit each.
    unsure: u64,
    /// Lanes that meet the torus at a grazing angle, a bit each.
    gentle: u64,
}

impl Found {
    fn none() -> Found {
        let (plus, minus) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
        Found { times: [plus, minus, plus, minus], unsure: 0, gentle: 0 }
    }
}
