//! Spans and gaps of eight rays.

use super::vector::{Lanes, Mask, splat};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// An interval of each ray in which all facets so far hold, with the faces at its ends; empty unless `from < to`.
#[derive(Clone, Copy, Debug)]
pub struct LaneSpan<S: Simd> {
    /// Start of the interval.
    pub from: Lanes<S>,
    /// End of the interval.
    pub to: Lanes<S>,
    /// Face at the start.
    pub from_face: Lanes<S>,
    /// Face at the end.
    pub to_face: Lanes<S>,
}

/// An interval of each ray that is cut out of a span; empty unless `from < to`.
#[derive(Clone, Copy, Debug)]
pub struct Gap<S: Simd> {
    /// Start of the interval.
    pub from: Lanes<S>,
    /// End of the interval.
    pub to: Lanes<S>,
}

impl<S: Simd> Gap<S> {
    /// Replaces the interval in the lanes of a mask.
    #[inline(always)]
    pub(super) fn or(&self, mask: Mask<S>, from: Lanes<S>, to: Lanes<S>) -> Self {
        Gap { from: mask.select(from, self.from), to: mask.select(to, self.to) }
    }

    /// True for the pieces of a span before and after the gap that are not empty.
    #[inline(always)]
    pub(super) fn pieces(&self, span: &LaneSpan<S>) -> [Mask<S>; 2] {
        let exists = self.from.simd_lt(self.to);
        let before = span.from.simd_lt(self.from.min(span.to));
        let after = self.to.max(span.from).simd_lt(span.to);
        [exists & before, exists & after]
    }
}

impl<S: Simd> LaneSpan<S> {
    /// The whole line.
    #[inline(always)]
    pub fn line(simd: S) -> Self {
        let [plus, minus] = super::ray::infinite(simd);
        let none = splat(simd, -1.0);
        LaneSpan { from: minus, to: plus, from_face: none, to_face: none }
    }

    /// Clamps the start to `t`, where the ray crosses `face`; at equal times the old face stays. Returns the lanes that
    /// change.
    #[inline(always)]
    pub fn begin_after(&mut self, t: Lanes<S>, face: Lanes<S>) -> Mask<S> {
        let later = t.simd_gt(self.from);
        self.from = later.select(t, self.from);
        self.from_face = later.select(face, self.from_face);
        later
    }

    /// Clamps the end to `t`, where the ray crosses `face`; at equal times the old face stays. Returns the lanes that
    /// change.
    #[inline(always)]
    pub fn end_before(&mut self, t: Lanes<S>, face: Lanes<S>) -> Mask<S> {
        let earlier = t.simd_lt(self.to);
        self.to = earlier.select(t, self.to);
        self.to_face = earlier.select(face, self.to_face);
        earlier
    }

    /// Clamps the span to another one; at equal times the old face stays. `ties` are the lanes in which two or more spans
    /// so far have this start, and those in which they have this end. Returns the times at which one of the two spans ends
    /// and the other begins, NaN for none.
    #[inline(always)]
    pub fn clamp_to(&mut self, other: &LaneSpan<S>, ties: &mut [Mask<S>; 2]) -> Lanes<S> {
        let none = splat(self.from.simd, f64::NAN);
        let contact = self.to.simd_eq(other.from).select(self.to, none);
        let contact = self.from.simd_eq(other.to).select(self.from, contact);
        let equal = [other.from.simd_eq(self.from), other.to.simd_eq(self.to)];
        let later = self.begin_after(other.from, other.from_face);
        let earlier = self.end_before(other.to, other.to_face);
        *ties = [(ties[0] & !later) | equal[0], (ties[1] & !earlier) | equal[1]];
        contact
    }

    /// True if the span is not empty.
    #[inline(always)]
    pub fn is_some(&self) -> Mask<S> {
        self.from.simd_lt(self.to)
    }
}
