//! Carved solids: an intersection of unions of leaves, minus other leaves, where each ray comes near few of
//! the many leaves. Examples: a plate with holes, a turned part.
//!
//! A BVH finds the leaves near a bundle of rays. No boolean function of these leaves is prepared in advance:
//! the end of a span of one of them is a change if it lies in some leaf of each other union, in no other leaf
//! of its own union, and in none of the subtracted leaves.

use super::group::{BundleEvaluation, CODE};
use super::plan::{MAX_SPANS, NONE, leaf_facets};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_bvh::{Bundle, BundleSlabs, BundleTraversal, BundleWindow, ExactBvh};
use rayweave_math::Bounds;
use rayweave_model::{Edge, Gate, LeafId, LeafKind, Program, Prototype, Rule, Window};
use rayweave_shape::lanes::{LaneFacet, LaneRay, Lanes, Mask, Uncertain, splat};
use std::ops::Range;

/// An intersection of unions of leaves, minus other leaves.
#[derive(Clone, Debug, Default)]
pub(super) struct Carved {
    leaves: Vec<Leaf>,
    facets: Vec<LaneFacet>,
    /// The number of unions.
    unions: u32,
    boxes: ExactBvh,
}

#[derive(Clone, Debug)]
struct Leaf {
    facets: Range<usize>,
    /// The largest number of gaps in its span.
    gaps: usize,
    /// The union that it belongs to; [`NONE`] if it is subtracted.
    union: u32,
}

/// State of the decomposition of a solid.
struct Builder<'p> {
    program: &'p Program,
    group: &'p Prototype,
    /// The boxes outside of which the leaves of the group do not matter.
    matters: &'p [Bounds],
    carved: Carved,
    bounds: Vec<Bounds>,
}

impl Carved {
    /// Decomposes a part of a group; `matters` holds the boxes in which its leaves matter. Returns `None` if the part
    /// has a different form, or leaves without a kernel or a finite box.
    pub fn new(program: &Program, group: &Prototype, edge: Edge, matters: &[Bounds]) -> Option<Carved> {
        let mut builder = Builder { program, group, matters, carved: Carved::default(), bounds: Vec::new() };
        let mut waiting = vec![edge];
        while let Some(edge) = waiting.pop() {
            waiting.extend_from_slice(&builder.take(edge)?);
        }
        let Builder { mut carved, bounds, .. } = builder;
        let (boxes, order) = ExactBvh::sorted(&bounds);
        carved.leaves = order.iter().map(|&k| carved.leaves[k as usize].clone()).collect();
        carved.boxes = boxes;
        (carved.unions > 0).then_some(carved)
    }

    /// The number of leaves.
    pub fn leaf_count(&self) -> usize {
        self.leaves.len()
    }

    /// The facets of all leaves.
    pub fn facets(&self) -> &Vec<LaneFacet> {
        &self.facets
    }
}

impl Builder<'_> {
    /// Adds an operand of an intersection. Returns the operands that remain to be added, if it is
    /// itself an intersection.
    fn take(&mut self, edge: Edge) -> Option<Vec<Edge>> {
        let upright = !edge.is_complemented();
        match self.group.expression.node(edge.node()) {
            Gate::Leaf(_) if upright => self.union(&[edge])?,
            Gate::Leaf(leaf) => self.leaf(leaf, NONE)?,
            Gate::Join(Rule::AtLeast(1), operands) if upright => self.union(&operands)?,
            Gate::Join(Rule::AtLeast(1), operands) => {
                return Some(operands.iter().map(|operand| operand.complement()).collect());
            }
            Gate::Join(Rule::AtLeast(least), operands) if upright && least as usize == operands.len() => {
                return Some(operands.to_vec());
            }
            _ => return None,
        }
        Some(Vec::new())
    }

    fn union(&mut self, operands: &[Edge]) -> Option<()> {
        let number = self.carved.unions;
        self.carved.unions += 1;
        operands.iter().try_for_each(|operand| match self.group.expression.node(operand.node()) {
            Gate::Leaf(leaf) if !operand.is_complemented() => self.leaf(leaf, number),
            _ => None,
        })
    }

    fn leaf(&mut self, leaf: LeafId, union: u32) -> Option<()> {
        let bounds = self.matters[leaf.index()];
        if bounds.is_empty() {
            return Some(());
        }
        let id = LeafId(self.group.leaves.start + leaf.0);
        let LeafKind::Shape { facets } = self.program.leaf(id).kind() else { return None };
        let first = self.carved.facets.len();
        let gaps = leaf_facets(self.program, facets, &mut self.carved.facets)?;
        self.carved.leaves.push(Leaf { facets: first..self.carved.facets.len(), gaps, union });
        self.bounds.push(bounds);
        bounds.is_finite().then_some(())
    }
}

/// The leaves near a bundle, sorted by union, subtracted leaves last.
struct NearbyLeaves {
    leaves: [NearbyLeaf; MAX_SPANS],
    count: usize,
}

#[derive(Clone, Copy)]
struct NearbyLeaf {
    /// Its index.
    leaf: u32,
    union: u32,
    /// The indices of its spans: first its own, then the gaps in it.
    first: usize,
    end: usize,
}

impl NearbyLeaves {
    fn new() -> NearbyLeaves {
        NearbyLeaves { leaves: [NearbyLeaf { leaf: 0, union: NONE, first: 0, end: 0 }; MAX_SPANS], count: 0 }
    }

    /// Adds a leaf; false if the list is full.
    #[inline(always)]
    fn add(&mut self, leaf: u32, union: u32) -> bool {
        if self.count == MAX_SPANS {
            return false;
        }
        let mut at = self.count;
        while at > 0 && self.leaves[at - 1].union > union {
            self.leaves[at] = self.leaves[at - 1];
            at -= 1;
        }
        self.leaves[at] = NearbyLeaf { leaf, union, first: 0, end: 0 };
        self.count += 1;
        true
    }

    fn all(&self) -> &[NearbyLeaf] {
        &self.leaves[..self.count.min(MAX_SPANS)]
    }

    /// The number of unions that the leaves belong to.
    #[inline(always)]
    fn unions(&self) -> u32 {
        let (mut count, mut last) = (0, NONE);
        for leaf in self.all() {
            count += u32::from(leaf.union != last && leaf.union != NONE);
            last = leaf.union;
        }
        count
    }
}

/// Eight rays, their slabs and their bundle.
pub(super) struct Bundled<'a, S: Simd> {
    pub ray: &'a LaneRay<S>,
    pub slabs: &'a BundleSlabs<S>,
    pub bundle: &'a Bundle,
    pub intervals: &'a BundleWindow<S>,
}

impl<S: Simd> BundleEvaluation<'_, S> {
    /// [`BundleEvaluation::enter`] for a carved solid: finds the first two changes. Returns the uncertain lanes and the
    /// lanes that start inside.
    pub fn enter_carved(
        &mut self,
        carved: &Carved,
        rays: &Bundled<'_, S>,
        ahead: &mut BundleTraversal,
        window: Window,
    ) -> (Uncertain<S>, Mask<S>) {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || self.enter_carved_here(carved, rays, ahead, window),
        )
    }

    #[inline(always)]
    fn enter_carved_here(
        &mut self,
        carved: &Carved,
        rays: &Bundled<'_, S>,
        ahead: &mut BundleTraversal,
        window: Window,
    ) -> (Uncertain<S>, Mask<S>) {
        let (simd, mut near) = (self.simd, NearbyLeaves::new());
        let never = Mask::splat(simd, false);
        let mut uncertain = Uncertain { always: never, grazes: never };
        self.no_changes();
        ahead.begin(simd, &carved.boxes, rays.bundle, rays.intervals);
        while let Some(leaf) = ahead.next(simd, &carved.boxes, (rays.slabs, rays.bundle), rays.intervals) {
            if !near.add(leaf, carved.leaves[leaf as usize].union) {
                return (Uncertain { always: !never, ..uncertain }, never);
            }
        }
        if near.unions() < carved.unions {
            return (uncertain, never);
        }
        match self.find_near_spans(carved, &mut near, rays.ray, &mut uncertain) {
            Some(true) => {}
            Some(false) => return (uncertain, never),
            None => return (Uncertain { always: !never, ..uncertain }, never),
        }
        self.near_changes(&near, window, &mut uncertain);
        (uncertain, self.starts_inside(&near, window))
    }

    /// Computes the spans of the leaves. Returns false as soon as no ray hits any leaf of some union, and
    /// `None` if there are too many spans.
    #[inline(always)]
    fn find_near_spans(
        &mut self,
        carved: &Carved,
        near: &mut NearbyLeaves,
        ray: &LaneRay<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Option<bool> {
        let (mut count, mut is_met, mut of) = (0, true, NONE);
        for near in &mut near.leaves[..near.count.min(MAX_SPANS)] {
            if near.union != of {
                if !is_met {
                    return Some(false);
                }
                (is_met, of) = (near.union == NONE, near.union);
            }
            let leaf = &carved.leaves[near.leaf as usize];
            (near.first, near.end) = (count, count + 1 + leaf.gaps);
            if near.end > MAX_SPANS {
                return None;
            }
            is_met |= self.leaf(&carved.facets[leaf.facets.clone()], count, ray, None, uncertain);
            count = near.end;
        }
        Some(is_met)
    }

    /// Finds the first two changes of each ray.
    #[inline(always)]
    fn near_changes(&mut self, near: &NearbyLeaves, window: Window, uncertain: &mut Uncertain<S>) {
        let never = splat(self.simd, f64::INFINITY);
        let (mut earliest, mut second, mut tied) = (never, never, never);
        for own in 0..near.count {
            let NearbyLeaf { first, end, .. } = near.leaves[own];
            for code in 2 * first..2 * end {
                let t = self.end(code);
                // only the first two changes are needed
                let queried =
                    t.simd_gt(window.t_min()) & t.simd_lt(window.t_max()) & t.simd_le(second.min(tied));
                if !queried.any_true() {
                    continue;
                }
                let (changes, ties) = self.near_change(near, own, code / 2, t, queried);
                tied = tied.min(ties.select(t, never));
                let key = changes.select(Lanes::from_bits((t.to_bits() & !CODE) | code as u64), never);
                second = second.min(earliest.max(key));
                earliest = earliest.min(key);
            }
        }
        uncertain.always |= tied.simd_le(earliest) & tied.simd_lt(never);
        self.set_key(0, earliest);
        self.set_key(1, second.min(tied));
    }

    /// Lanes in which the end of a span at time `t` is a change of the solid, and lanes in which it may be
    /// one but coincides with another end (a tie).
    #[inline(always)]
    fn near_change(
        &self,
        near: &NearbyLeaves,
        own: usize,
        span: usize,
        t: Lanes<S>,
        queried: Mask<S>,
    ) -> (Mask<S>, Mask<S>) {
        let NearbyLeaf { union, first, end, .. } = near.leaves[own];
        let (mut open, mut ties) = (queried, Mask::splat(self.simd, false));
        for other in (first..end).filter(|&other| other != span) {
            let (within, touches) = self.within(other, t);
            open &= if other == first { within | touches } else { !within };
            ties |= touches;
        }
        // leaves of one union are consecutive
        let (mut any, mut of) = (Mask::splat(self.simd, true), NONE);
        for (k, leaf) in near.all().iter().enumerate() {
            if k == own {
                continue;
            }
            let (holds, touches) = self.holds(leaf, t);
            ties |= touches;
            if leaf.union == union || leaf.union == NONE {
                open &= !holds;
                continue;
            }
            if leaf.union != of {
                open &= any;
                (any, of) = (Mask::splat(self.simd, false), leaf.union);
            }
            any |= holds | touches;
        }
        open &= any;
        (open & !ties, open & ties)
    }

    /// Lanes in which `t` is strictly inside a leaf, and lanes in which some span of the leaf begins or ends
    /// at `t`.
    #[inline(always)]
    fn holds(&self, leaf: &NearbyLeaf, t: Lanes<S>) -> (Mask<S>, Mask<S>) {
        let (mut holds, mut touches) = self.within(leaf.first, t);
        for gap in leaf.first + 1..leaf.end {
            let (within, ends) = self.within(gap, t);
            holds &= !(within | ends);
            touches |= ends;
        }
        (holds, touches)
    }

    /// Lanes in which `t` is strictly inside a span, and lanes in which the span begins or ends at `t`.
    #[inline(always)]
    fn within(&self, span: usize, t: Lanes<S>) -> (Mask<S>, Mask<S>) {
        let (from, to) = self.span(span);
        (from.simd_lt(t) & t.simd_lt(to), t.simd_eq(from) | t.simd_eq(to))
    }

    /// The lanes that are inside just after the beginning of the window.
    #[inline(always)]
    fn starts_inside(&self, near: &NearbyLeaves, window: Window) -> Mask<S> {
        let never = Mask::splat(self.simd, false);
        let t = splat(self.simd, window.t_min());
        if window.t_min() == f64::NEG_INFINITY {
            return never;
        }
        let (mut inside, mut any, mut of) = (!never, !never, NONE);
        for leaf in near.all() {
            let mut holds = self.begun(leaf.first, t);
            for gap in leaf.first + 1..leaf.end {
                holds &= !self.begun(gap, t);
            }
            if leaf.union == NONE {
                inside &= !holds;
                continue;
            }
            if leaf.union != of {
                inside &= any;
                (any, of) = (never, leaf.union);
            }
            any |= holds;
        }
        inside & any
    }

    /// The lanes that are in a span just after `t`.
    #[inline(always)]
    fn begun(&self, span: usize, t: Lanes<S>) -> Mask<S> {
        let (from, to) = self.span(span);
        from.simd_le(t) & t.simd_lt(to)
    }
}
