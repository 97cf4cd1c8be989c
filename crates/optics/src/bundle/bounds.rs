//! Bounding box test for ray bundles in SIMD lanes (separating axes of the box).

use super::incident::load;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use rayweave_math::Bounds;
use rayweave_model::Rays;
use rayweave_shape::lanes::{Lanes, Mask, Vec3Lanes, splat};

/// A bounding box with a margin, tested against eight rays at a time.
///
/// Conservative: a miss is definite, a possible hit is not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneBounds {
    lo: [f64; 3],
    hi: [f64; 3],
    size: f64,
    level: Level,
}

/// The margin around the box, relative to the lengths involved; far above every tolerance.
const MARGIN: f64 = 1e-9;

impl LaneBounds {
    pub fn new(bounds: &Bounds) -> LaneBounds {
        let (lo, hi) = (bounds.lo.to_array(), bounds.hi.to_array());
        LaneBounds { lo, hi, size: bounds.size().length(), level: Level::new() }
    }

    /// Bit mask of the rays `at..at + 8` that may hit the box between t = 0 and their ends: all
    /// except those that stay on one side of the box along some axis. `None` if there are fewer
    /// than eight rays.
    pub fn may_hit(&self, rays: Rays<'_>, at: usize, end: &[f64]) -> Option<u64> {
        dispatch!(self.level, simd => self.may_hit_at(simd, rays, at, end))
    }

    #[inline(always)]
    fn may_hit_at<S: Simd>(&self, simd: S, rays: Rays<'_>, at: usize, end: &[f64]) -> Option<u64> {
        let (origin, direction) = (load(simd, rays.origins, at)?, load(simd, rays.directions, at)?);
        let end = Lanes::load_array_ref(simd, end.get(at..)?.first_chunk()?);
        Some(self.may_hit_lanes(simd, origin, direction, end))
    }

    /// [`LaneBounds::may_hit`] for rays in lanes.
    #[inline(always)]
    pub fn may_hit_lanes<S: Simd>(
        &self,
        simd: S,
        origin: Vec3Lanes<S>,
        direction: Vec3Lanes<S>,
        end: Lanes<S>,
    ) -> u64 {
        let (is_finite, zero) = (end.simd_lt(f64::INFINITY), splat(simd, 0.0));
        // an infinite ray stays on one side if it starts there and its direction does not lead back
        let last = origin.plus(direction.times(is_finite.select(end, zero)));
        let margin = (origin.taxicab() + last.taxicab() + self.size) * MARGIN;
        let mut may_hit = !Mask::splat(simd, false);
        for k in 0..3 {
            let (o, d, l) = (origin.component(k), direction.component(k), last.component(k));
            let (lo, hi) = (splat(simd, self.lo[k]) - margin, splat(simd, self.hi[k]) + margin);
            let (below, above) = (o.max(l).simd_lt(lo), o.min(l).simd_gt(hi));
            let stays_below = is_finite | d.simd_le(zero);
            let stays_above = is_finite | d.simd_ge(zero);
            may_hit &= !((below & stays_below) | (above & stays_above));
        }
        may_hit.to_bitmask()
    }
}
