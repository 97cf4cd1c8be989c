//! What is watched for while entries are read.

use fearless_simd::prelude::*;

use super::super::Real;

/// Collected over entries, lane by lane.
#[derive(Clone, Copy)]
pub(super) struct Watch<S: Simd, T: Real> {
    sorted: <T::Lanes<S> as SimdBase<S>>::Mask,
    zero: <T::Lanes<S> as SimdBase<S>>::Mask,
    zeros: T::Lanes<S>,
}

impl<S: Simd, T: Real> Watch<S, T> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Watch {
            sorted: SimdMask::splat(simd, true),
            zero: SimdMask::splat(simd, false),
            zeros: T::Lanes::<S>::splat(simd, T::ZERO),
        }
    }

    /// Two entries of a column, one row apart. False for NaN, too.
    #[inline(always)]
    pub fn order(&mut self, above: T::Lanes<S>, below: T::Lanes<S>) {
        self.sorted &= above.simd_le(below);
    }

    /// An entry. Where both signs of zero meet, their order is seen in the result; networks do not keep it.
    #[inline(always)]
    pub fn sign(&mut self, t: T::Lanes<S>) {
        self.zero |= t.simd_eq(self.zeros);
    }

    /// Whether all columns are sorted and free of NaN.
    #[inline(always)]
    pub fn is_sorted(self) -> bool {
        self.sorted.all_true()
    }

    /// Whether there was a zero of any sign.
    #[inline(always)]
    pub fn has_zero(self) -> bool {
        self.zero.any_true()
    }
}
