//! Checks of entries on reading: sorted columns, NaN, signed zeros, equal times.

use fearless_simd::prelude::*;

use super::super::Float;
use super::load;

/// Flags collected over entries, lane by lane.
#[derive(Clone, Copy)]
pub(super) struct Flags<S: Simd, T: Float> {
    sorted: <T::Lanes<S> as SimdBase<S>>::Mask,
    zero: <T::Lanes<S> as SimdBase<S>>::Mask,
    tied: <T::Lanes<S> as SimdBase<S>>::Mask,
    zeros: T::Lanes<S>,
    padding: T::Lanes<S>,
}

impl<S: Simd, T: Float> Flags<S, T> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Flags {
            sorted: SimdMask::splat(simd, true),
            zero: SimdMask::splat(simd, false),
            tied: SimdMask::splat(simd, false),
            padding: T::Lanes::<S>::splat(simd, T::INFINITY),
            zeros: T::Lanes::<S>::splat(simd, T::ZERO),
        }
    }

    /// Checks the rows of one operand one after the other: few long memory streams are faster than many short
    /// ones.
    #[inline(always)]
    pub fn rows<'a>(&mut self, simd: S, mut rows: impl Iterator<Item = &'a [T]>) {
        let len = T::Lanes::<S>::LEN;
        let Some(mut above) = rows.next() else { return };
        for row in std::iter::once(above).chain(rows) {
            let whole = row.len() - row.len() % len;
            for (t, above) in row[..whole].chunks_exact(len).zip(above.chunks_exact(len)) {
                let t = T::Lanes::<S>::from_slice(simd, t);
                self.sign(t);
                self.order(T::Lanes::<S>::from_slice(simd, above), t);
            }
            if whole < row.len() {
                let t = load(simd, &row[whole..]);
                self.sign(t);
                self.order(load(simd, &above[whole..]), t);
            }
            above = row;
        }
    }

    /// Checks the order of two entries of a column, one row apart. NaN counts as unsorted.
    #[inline(always)]
    pub fn order(&mut self, above: T::Lanes<S>, below: T::Lanes<S>) {
        self.sorted &= above.simd_le(below);
    }

    /// Checks an entry for zero. Sorting networks do not preserve the order of zeros of different sign, which
    /// is visible in the result.
    #[inline(always)]
    pub fn sign(&mut self, t: T::Lanes<S>) {
        self.zero |= t.simd_eq(self.zeros);
    }

    /// Whether a start comes before an end, both sorted by time only. Equal times do not decide and set a
    /// flag.
    #[inline(always)]
    pub fn is_before(&mut self, start: T::Lanes<S>, end: T::Lanes<S>) -> <T::Lanes<S> as SimdBase<S>>::Mask {
        self.tied |= start.simd_eq(end) & start.simd_lt(self.padding);
        start.simd_lt(end)
    }

    /// Whether equal times left a piece undecided.
    #[inline(always)]
    pub fn has_tie(self) -> bool {
        self.tied.any_true()
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
