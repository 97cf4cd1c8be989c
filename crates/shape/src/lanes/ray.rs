//! Eight rays in SIMD lanes, with common data for all kernels.

use super::vector::{LANES, Lanes, Mask, Vec3Lanes, splat};
use crate::surface::delta_of;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;

/// Limits of a model within which rays can be processed in lanes.
#[derive(Clone, Copy, Debug)]
pub struct LaneLimits {
    /// Centre of the ball that chords are cut out of.
    pub centre: Vec3,
    /// Radius of the ball, > 0.
    pub radius: f64,
    /// Largest magnitude bound of a surface.
    pub magnitude: f64,
    /// Largest radius of a sphere or a cylinder.
    pub largest_radius: f64,
    /// Half of the largest change of the gradient of a cone or a quadric per unit of length; 0 without any.
    pub bend: f64,
    /// True if all curved surfaces are spheres, whose square term is the squared length of the direction.
    pub is_spherical: bool,
}

/// Uncertain lanes, which fall back to the scalar kernels.
#[derive(Clone, Copy, Debug)]
pub struct Uncertain<S: Simd> {
    /// Unconditionally uncertain: the ray may lie in a surface, or numbers are near the ends of the range.
    pub always: Mask<S>,
    /// Uncertain if two crossings are close to each other: at one of them the ray grazes a surface.
    pub grazes: Mask<S>,
}

/// The start surface of each of eight rays.
#[derive(Clone, Copy, Debug)]
pub struct LaneStarts<S: Simd> {
    /// Number of the surface; -1 for none.
    pub surface: Lanes<S>,
    /// True if f < 0 just after the start.
    pub inside: Mask<S>,
}

/// Eight rays.
#[derive(Clone, Copy, Debug)]
pub struct LaneRay<S: Simd> {
    /// The points at t = 0.
    pub origin: Vec3Lanes<S>,
    /// The displacements per unit of t.
    pub direction: Vec3Lanes<S>,
    /// Squared lengths of the directions.
    pub square: Lanes<S>,
    /// Time of closest approach to the centre of the model.
    pub middle: Lanes<S>,
    /// Twice the tolerance of any surface at that time.
    pub near: Lanes<S>,
    /// Below this normal speed a ray crosses a plane at a grazing angle, or may lie in it.
    pub slow_plane: Lanes<S>,
    /// Below this square term a ray crosses a quadric at a grazing angle.
    pub slow_square: Lanes<S>,
    /// Sum of the taxicab length of the origin and the largest magnitude bound.
    pub(super) lengths: Lanes<S>,
    /// Taxicab length of the direction.
    pub(super) speed: Lanes<S>,
}

/// Ratio of normal speed to speed below which a ray grazes a plane.
const SLOW: f64 = 1e-5;
/// Ratio of the square term to the squared speed below which the square term is small.
const SLOW_SQUARE: f64 = 1e-4;
/// Ratio of distances beyond which a crossing is uncertain.
const FAR: f64 = 1e9;
/// Least ratio of the ball's radius to the tolerance, with a margin: see [`crate::surface::Chord`].
const LEAST: f64 = 4096.0;

impl<S: Simd> LaneRay<S> {
    /// Rays from components of origins and directions.
    #[inline(always)]
    pub fn new(
        simd: S,
        origin: Vec3Lanes<S>,
        direction: Vec3Lanes<S>,
        limits: &LaneLimits,
    ) -> (Self, Uncertain<S>) {
        LaneRay::carried(simd, origin, direction, limits, splat(simd, 0.0))
    }

    /// Rays in the frame of a placed solid, whose placement adds `magnitude` to that of every surface.
    #[inline(always)]
    pub fn carried(
        simd: S,
        origin: Vec3Lanes<S>,
        direction: Vec3Lanes<S>,
        limits: &LaneLimits,
        magnitude: Lanes<S>,
    ) -> (Self, Uncertain<S>) {
        let square = direction.length_squared();
        let middle = origin.taken_from(limits.centre).dot(direction) / square;
        let (from, speed) = (origin.taxicab(), direction.taxicab());
        let lengths = from + (magnitude + limits.magnitude);
        let at_middle = lengths + middle.abs() * speed;
        let near = at_middle * (2.0 * delta_of(1.0));
        // a ray in a plane at both ends of the chord, two radii apart, has |n . d| 2 radius / |d| <= 2 delta; twice that
        let flat = (at_middle + limits.radius) * speed * (2.0 * delta_of(1.0) / limits.radius);
        let slow_plane = flat.max(speed * SLOW);
        // a plane that is not crossed at a grazing angle is then crossed at a finite time: below 1e80 / (1e-5 * 1e-80)
        let in_range = speed.simd_gt(1e-80) & speed.simd_lt(1e80) & lengths.simd_lt(1e80);
        let has_chord = (near * LEAST).simd_lt(limits.radius);
        let never = Mask::splat(simd, false);
        let uncertain = Uncertain { always: !(in_range & has_chord), grazes: never };
        let slow_square = square * SLOW_SQUARE;
        let ray =
            LaneRay { origin, direction, square, middle, near, slow_plane, slow_square, lengths, speed };
        (ray, uncertain)
    }

    /// True if the piece between two neighbouring times may lie within the tolerance of a surface that it crosses at its
    /// ends, assuming that neither crossing is grazing (or that both bounds of [`Uncertain::grazes`] fail).
    ///
    /// With `h = b - a` and `delta` the tolerance at the later time: a piece that coincides with a plane has
    /// `|n . d| h <= 2 delta`. A piece that coincides with a surface of degree 2, along which f has the square term q,
    /// has `q h^2 / 2 <= 4 max |f|`, by the second difference of f over both ends and the middle, where
    /// `|f| <= delta (|grad f| + bend delta)` and `|grad f| <= 2 (radius + delta)` for spheres and cylinders,
    /// `2 bend (|r - centre|)` for others; q is the squared speed for spheres, and has a lower bound where rays do not graze. Both bounds are tested with a margin of at least a factor of 2.
    #[inline(always)]
    pub fn may_coincide(&self, a: Lanes<S>, b: Lanes<S>, limits: &LaneLimits) -> Mask<S> {
        self.may_piece_coincide(b - a, a.abs().max(b.abs()), limits)
    }

    /// [`LaneRay::may_coincide`] for the length of a piece and a bound of |t| at its ends. If it is false, it is
    /// false for every longer piece with a lower bound: the shortest of several pieces represents them all.
    #[inline(always)]
    pub fn may_piece_coincide(&self, step: Lanes<S>, latest: Lanes<S>, limits: &LaneLimits) -> Mask<S> {
        let lengths = self.lengths_at(latest);
        let delta = lengths * delta_of(1.0);
        // |d| is at least 0.57 times the taxicab length
        let plane = (step * self.speed * (0.5 * SLOW)).simd_le(delta * 4.0);
        let size = lengths * (2.0 * limits.bend) + limits.largest_radius + delta * 4.0;
        let square = if limits.is_spherical { self.square } else { self.slow_square };
        let round = (step * step * square).simd_le(delta * size * 64.0);
        let far = (self.lengths * FAR).simd_lt(lengths);
        plane | round | far
    }

    /// A length of pieces above which [`LaneRay::may_piece_coincide`] is false; +inf if there is none.
    #[inline(always)]
    pub fn longest_coincident(&self, latest: Lanes<S>, limits: &LaneLimits) -> Lanes<S> {
        let lengths = self.lengths_at(latest);
        let delta = lengths * delta_of(1.0);
        let size = lengths * (2.0 * limits.bend) + limits.largest_radius + delta * 4.0;
        let square = if limits.is_spherical { self.square } else { self.slow_square };
        let plane = delta * (8.0 / SLOW) / self.speed;
        let round = (delta * size * 64.0 / square).sqrt();
        let infinity = splat(self.speed.simd, f64::INFINITY);
        let far = (self.lengths * FAR).simd_lt(lengths);
        // the factor covers the rounding of this and of the test
        far.select(infinity, plane.max(round) * (1.0 + 1e-9))
    }

    /// Sum of the lengths that determine the tolerance at a time.
    #[inline(always)]
    pub(super) fn lengths_at(&self, t: Lanes<S>) -> Lanes<S> {
        self.lengths + t.abs() * self.speed
    }

    /// Ray `k` in all lanes.
    #[inline(always)]
    pub fn only(&self, simd: S, k: usize) -> Self {
        let all = |lanes: &Lanes<S>| splat(simd, lanes.as_slice()[k % LANES]);
        let vector = |v: &Vec3Lanes<S>| Vec3Lanes { x: all(&v.x), y: all(&v.y), z: all(&v.z) };
        LaneRay {
            origin: vector(&self.origin),
            direction: vector(&self.direction),
            square: all(&self.square),
            middle: all(&self.middle),
            near: all(&self.near),
            slow_plane: all(&self.slow_plane),
            slow_square: all(&self.slow_square),
            lengths: all(&self.lengths),
            speed: all(&self.speed),
        }
    }

    /// A single ray in the form of the scalar kernels.
    pub fn lane(&self, k: usize) -> crate::Ray {
        let at = |v: &Vec3Lanes<S>| Vec3::new(v.x.as_slice()[k], v.y.as_slice()[k], v.z.as_slice()[k]);
        crate::Ray::new(at(&self.origin), at(&self.direction))
    }
}

/// +inf and -inf in all lanes, for padding.
#[inline(always)]
pub(super) fn infinite<S: Simd>(simd: S) -> [Lanes<S>; 2] {
    [splat(simd, f64::INFINITY), splat(simd, f64::NEG_INFINITY)]
}

const _: () = assert!(LANES == 8);
