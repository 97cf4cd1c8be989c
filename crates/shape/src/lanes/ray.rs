//! Eight rays, with what every kernel needs of them.

use super::vector::{LANES, Lanes, Mask, Vec3Lanes, splat};
use crate::surface::delta_of;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;

/// What a model says about the rays that can be answered eight at a time.
#[derive(Clone, Copy, Debug)]
pub struct LaneLimits {
    /// The ball that chords are cut out of, and its radius.
    pub centre: Vec3,
    /// > 0.
    pub radius: f64,
    /// The greatest reach of a surface.
    pub reach: f64,
    /// The greatest radius of a sphere or a cylinder.
    pub largest_radius: f64,
    /// Half of the most by which the gradient of a cone or a quadric changes over a unit of length; 0 without any.
    pub bend: f64,
}

/// Lanes that have to be asked again one by one.
#[derive(Clone, Copy, Debug)]
pub struct Doubt<S: Simd> {
    /// Whatever they meet: they may lie in a surface, or their numbers are near the ends of the range.
    pub always: Mask<S>,
    /// If two of their crossings are near each other: at one of them they graze a surface.
    pub grazes: Mask<S>,
}

/// Eight rays.
#[derive(Clone, Copy, Debug)]
pub struct LaneRay<S: Simd> {
    /// The points at t = 0.
    pub origin: Vec3Lanes<S>,
    /// The displacements per unit of t.
    pub direction: Vec3Lanes<S>,
    /// The squares of the lengths of the directions.
    pub square: Lanes<S>,
    /// When they are closest to the centre of the model.
    pub middle: Lanes<S>,
    /// Twice the tolerance of any surface at that time.
    pub near: Lanes<S>,
    /// Planes that the rays approach more slowly are met at grazing angles; or the rays may even lie in them.
    pub slow_plane: Lanes<S>,
    /// Quadrics whose square term is below this are met at grazing angles.
    pub slow_square: Lanes<S>,
    /// The taxicab length of the origin, and the greatest reach.
    pub(super) lengths: Lanes<S>,
    /// The taxicab length of the direction.
    pub(super) speed: Lanes<S>,
}

/// Below this times its speed a ray approaches a plane slowly.
const SLOW: f64 = 1e-5;
/// Below this times the square of its speed the square term of a quadric is small.
const SLOW_SQUARE: f64 = 1e-4;
/// Crossings that are so many times farther away than anything else are in doubt.
const FAR: f64 = 1e9;
/// A ball has to be so many times larger than the tolerance: see [`crate::surface::Chord`]; with room.
const LEAST: f64 = 4096.0;

impl<S: Simd> LaneRay<S> {
    /// From components of origins and directions.
    #[inline(always)]
    pub fn new(
        simd: S,
        origin: Vec3Lanes<S>,
        direction: Vec3Lanes<S>,
        limits: &LaneLimits,
    ) -> (Self, Doubt<S>) {
        LaneRay::carried(simd, origin, direction, limits, splat(simd, 0.0))
    }

    /// The same in the frame of a placed solid, the way into which adds `reach` to that of every surface.
    #[inline(always)]
    pub fn carried(
        simd: S,
        origin: Vec3Lanes<S>,
        direction: Vec3Lanes<S>,
        limits: &LaneLimits,
        reach: Lanes<S>,
    ) -> (Self, Doubt<S>) {
        let square = direction.length_squared();
        let middle = origin.taken_from(limits.centre).dot(direction) / square;
        let (from, speed) = (origin.taxicab(), direction.taxicab());
        let lengths = from + (reach + limits.reach);
        let at_middle = lengths + middle.abs() * speed;
        let near = at_middle * (2.0 * delta_of(1.0));
        // in a plane at both ends of the chord, two radii apart: |n . d| 2 radius / |d| <= 2 delta; twice that
        let flat = (at_middle + limits.radius) * speed * (2.0 * delta_of(1.0) / limits.radius);
        let slow_plane = flat.max(speed * SLOW);
        let in_range = speed.simd_gt(1e-80) & speed.simd_lt(1e80) & from.simd_lt(1e80);
        let has_chord = (near * LEAST).simd_lt(limits.radius);
        let never = Mask::splat(simd, false);
        let doubt = Doubt { always: !(in_range & has_chord), grazes: never };
        let slow_square = square * SLOW_SQUARE;
        let ray =
            LaneRay { origin, direction, square, middle, near, slow_plane, slow_square, lengths, speed };
        (ray, doubt)
    }

    /// True where the piece between two neighbouring times may lie within the tolerance of a surface that it crosses at
    /// its ends, if neither is met at a grazing angle (or if both bounds of [`Doubt::grazes`] fail).
    ///
    /// With `h = b - a` and `delta` the tolerance at the later of the two: to keep to a plane takes `|n . d| h <= 2
    /// delta`. To keep to a surface of degree 2 along which f has the square term q takes, by the second difference of
    /// f over both ends and the middle, `q h^2 / 2 <= 4 max |f|`, where `|f| <= delta (|grad f| + bend delta)` and
    /// `|grad f| <= 2 (radius + delta)` for spheres and cylinders, `2 bend (|r - centre|)` for others. Both are asked
    /// for with a factor of 2 or more to spare.
    #[inline(always)]
    pub fn may_hug(&self, a: Lanes<S>, b: Lanes<S>, limits: &LaneLimits) -> Mask<S> {
        let step = b - a;
        let lengths = self.lengths_at(a.abs().max(b.abs()));
        let delta = lengths * delta_of(1.0);
        // |d| is at least 0.57 times the taxicab length
        let plane = (step * self.speed * (0.5 * SLOW)).simd_le(delta * 4.0);
        let size = lengths * (2.0 * limits.bend) + limits.largest_radius + delta * 4.0;
        let round = (step * step * self.slow_square).simd_le(delta * size * 64.0);
        let far = (self.lengths * FAR).simd_lt(lengths);
        plane | round | far
    }

    /// All the lengths that the tolerance at a time is made of.
    #[inline(always)]
    pub(super) fn lengths_at(&self, t: Lanes<S>) -> Lanes<S> {
        self.lengths + t.abs() * self.speed
    }

    /// A ray as the scalar kernels take it.
    pub fn lane(&self, k: usize) -> crate::Ray {
        let at = |v: &Vec3Lanes<S>| Vec3::new(v.x.as_slice()[k], v.y.as_slice()[k], v.z.as_slice()[k]);
        crate::Ray::new(at(&self.origin), at(&self.direction))
    }
}

/// All lanes infinite, for padding.
#[inline(always)]
pub(super) fn infinite<S: Simd>(simd: S) -> [Lanes<S>; 2] {
    [splat(simd, f64::INFINITY), splat(simd, f64::NEG_INFINITY)]
}

const _: () = assert!(LANES == 8);
