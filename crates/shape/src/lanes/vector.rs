//! Numbers and vectors of eight rays in SIMD lanes.

use crate::real::Vector;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8, mask64x8};
use rayweave_math::Vec3;

/// Number of lanes: rays processed at a time.
pub const LANES: usize = 8;

/// One number per ray.
pub type Lanes<S> = f64x8<S>;

/// One boolean per ray.
pub type Mask<S> = mask64x8<S>;

/// The same number in every lane.
#[inline(always)]
pub fn splat<S: Simd>(simd: S, value: f64) -> Lanes<S> {
    <Lanes<S> as SimdBase<S>>::splat(simd, value)
}

/// One vector per ray.
pub type Vec3Lanes<S> = Vector<Lanes<S>>;

impl<S: Simd> Vec3Lanes<S> {
    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(simd: S, v: Vec3) -> Self {
        Vector { x: splat(simd, v.x), y: splat(simd, v.y), z: splat(simd, v.z) }
    }

    /// Replaces the vector in the lanes of a mask.
    #[inline(always)]
    pub fn or_where(self, lanes: Mask<S>, other: Self) -> Self {
        Vector {
            x: lanes.select(other.x, self.x),
            y: lanes.select(other.y, self.y),
            z: lanes.select(other.z, self.z),
        }
    }
}
