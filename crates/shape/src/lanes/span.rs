//! Stretches of eight rays.

use super::vector::{Lanes, Mask, splat};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A stretch of each ray in which all facets so far hold, and the faces at its ends; empty unless `from < to`.
#[derive(Clone, Copy, Debug)]
pub struct Span<S: Simd> {
    /// When it begins.
    pub from: Lanes<S>,
    /// When it ends.
    pub to: Lanes<S>,
    /// The face where it begins.
    pub from_face: Lanes<S>,
    /// The face where it ends.
    pub to_face: Lanes<S>,
}

/// A stretch of each ray that is cut out of a span; empty unless `from < to`.
#[derive(Clone, Copy, Debug)]
pub struct Gap<S: Simd> {
    /// When it begins.
    pub from: Lanes<S>,
    /// When it ends.
    pub to: Lanes<S>,
}

impl<S: Simd> Gap<S> {
    /// The same, but from one time to another where a mask says so.
    #[inline(always)]
    pub(super) fn or(&self, mask: Mask<S>, from: Lanes<S>, to: Lanes<S>) -> Self {
        Gap { from: mask.select(from, self.from), to: mask.select(to, self.to) }
    }

    /// Whether there is anything left of a span before the gap, and after it.
    #[inline(always)]
    pub(super) fn pieces(&self, span: &Span<S>) -> [Mask<S>; 2] {
        let exists = self.from.simd_lt(self.to);
        let before = span.from.simd_lt(self.from.min(span.to));
        let after = self.to.max(span.from).simd_lt(span.to);
        [exists & before, exists & after]
    }
}

impl<S: Simd> Span<S> {
    /// The whole line.
    #[inline(always)]
    pub fn line(simd: S) -> Self {
        let [plus, minus] = super::ray::infinite(simd);
        let none = splat(simd, -1.0);
        Span { from: minus, to: plus, from_face: none, to_face: none }
    }

    /// Not before `t`, where `face` is crossed; at equal times the first face stays. True where this changes the span.
    #[inline(always)]
    pub fn begin_after(&mut self, t: Lanes<S>, face: Lanes<S>) -> Mask<S> {
        let later = t.simd_gt(self.from);
        self.from = later.select(t, self.from);
        self.from_face = later.select(face, self.from_face);
        later
    }

    /// Not after `t`, where `face` is crossed; at equal times the first face stays. True where this changes the span.
    #[inline(always)]
    pub fn end_before(&mut self, t: Lanes<S>, face: Lanes<S>) -> Mask<S> {
        let earlier = t.simd_lt(self.to);
        self.to = earlier.select(t, self.to);
        self.to_face = earlier.select(face, self.to_face);
        earlier
    }

    /// Where there is anything of it.
    #[inline(always)]
    pub fn is_some(&self) -> Mask<S> {
        self.from.simd_lt(self.to)
    }
}
