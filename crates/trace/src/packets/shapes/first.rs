//! First hits of rays that are far apart, in a union of leaves that all have forms.
//!
//! Such rays have few boxes in common, and each searches the tree on its own, approximately from front to back. Eight of them are
//! under way at a time, one in each lane. When each has arrived at a leaf, those at leaves of the most frequent form are intersected
//! together; the others wait. A ray falls back to the weave if it starts inside, if a leaf is uncertain, or if the hit and the next
//! change are so close that they may have to be welded, as where two leaves begin at one time.

use super::super::group::{Row, load};
use super::super::objects::BEHIND;
use super::{FORMS, OneGate, Shapes, ShapesScratch, code};
use crate::Weave;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_model::weld::Trajectory;
use rayweave_model::{Evaluator, Rays, Rule, Window};
use rayweave_shape::Ray;
use rayweave_shape::lanes::{LANES, LaneRay, LaneSpan, Lanes, Mask, splat};

/// First hits of up to eight rays that start outside of all leaves.
pub(in super::super) struct FirstHitsOfEight {
    /// The times; +inf for a miss.
    pub t: Row,
    /// The events.
    pub codes: [u64; LANES],
    /// Bit mask of the uncertain lanes, which fall back to the weave.
    pub uncertain: u64,
}

/// The first hits of eight rays so far.
struct Search<S: Simd> {
    /// The times; +inf without any.
    t: Lanes<S>,
    /// Lower bounds of the times of the next changes: those of the hits, where two leaves begin there.
    next: Lanes<S>,
    /// The number of the face within the leaf.
    facet: Lanes<S>,
    leaves: [u32; LANES],
    grazes: Mask<S>,
    uncertain: Mask<S>,
}

impl<S: Simd> Search<S> {
    /// Takes the spans of some lanes into account, each in the leaf at which its ray has arrived.
    #[inline(always)]
    fn take(
        &mut self,
        span: &LaneSpan<S>,
        (arrived, lanes): (&[u32; LANES], Mask<S>),
        grazes: Mask<S>,
        window: Window,
    ) {
        let some = span.is_some() & lanes & span.to.simd_gt(window.t_min());
        let begins = span.from.simd_gt(window.t_min());
        self.uncertain |= some & !begins;
        let enters = some & begins & span.from.simd_lt(window.t_max());
        let closer = enters & span.from.simd_lt(self.t);
        let other = enters & !closer;
        self.next = other.select(self.next.min(span.from), self.next);
        self.next = closer.select(self.t.min(span.to), self.next);
        self.t = closer.select(span.from, self.t);
        self.facet = closer.select(span.from_face, self.facet);
        self.grazes = (grazes & closer) | (self.grazes & !closer);
        let mut left = closer.to_bitmask();
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            self.leaves[lane] = arrived[lane];
        }
    }
}

impl Shapes {
    /// True if [`Shapes::first_hits`] applies: to a union of leaves that all have forms.
    pub fn finds_first_hits(&self) -> bool {
        let is_union = |gate: &OneGate| gate.rule == Rule::AtLeast(1) && gate.complemented == 0;
        self.has_all && self.gate.as_ref().is_some_and(is_union)
    }

    /// The first hits of the rays `at..at + count`, up to eight.
    pub fn first_hits<S: Simd>(
        &self,
        simd: S,
        weave: &Weave,
        rays: Rays<'_>,
        (at, count): (usize, usize),
        window: Window,
        scratch: &mut ShapesScratch,
    ) -> FirstHitsOfEight {
        simd.vectorize(
            #[inline(always)]
            || self.first_hits_here(simd, weave, rays, (at, count), window, scratch),
        )
    }

    #[inline(always)]
    fn first_hits_here<S: Simd>(
        &self,
        simd: S,
        weave: &Weave,
        rays: Rays<'_>,
        (at, count): (usize, usize),
        window: Window,
        scratch: &mut ShapesScratch,
    ) -> FirstHitsOfEight {
        let (origin, direction) = (load(simd, rays.origins, at), load(simd, rays.directions, at));
        let (ray, uncertain) = LaneRay::new(simd, origin, direction, &self.limits);
        let behind = splat(simd, BEHIND * self.limits.radius) / direction.taxicab();
        let (never, none) = (splat(simd, f64::INFINITY), Mask::splat(simd, false));
        let mut search = Search {
            t: never,
            next: never,
            facet: splat(simd, -1.0),
            leaves: [0; LANES],
            grazes: none,
            uncertain: uncertain.always,
        };
        self.search(simd, weave, (&ray, behind), (rays, at, count), window, (scratch, &mut search));
        let is_hit = search.t.simd_lt(f64::INFINITY);
        let mut unsure = search.uncertain.to_bitmask();
        let next = search.next.min(search.t + behind);
        let near = (ray.may_coincide(search.t, next, &self.limits) | search.grazes) & is_hit;
        let t = Row(search.t.to_array());
        let facets = search.facet.as_slice();
        let codes = std::array::from_fn(|lane| code(search.leaves[lane], facets[lane], true));
        let mut near = near.to_bitmask() & !unsure;
        while near != 0 {
            let lane = near.trailing_zeros() as usize % LANES;
            near &= near - 1;
            let line = ray.lane(lane);
            if !self.is_resolved(weave, (codes[lane], t.0[lane]), &line, (next.as_slice()[lane], window)) {
                unsure |= 1 << lane;
            }
        }
        FirstHitsOfEight { t, codes, uncertain: unsure & (!0 >> (64 - count)) }
    }

    /// Searches for the first hits of up to eight rays. `behind` is the time behind a hit up to which leaves are intersected.
    #[inline(always)]
    fn search<S: Simd>(
        &self,
        simd: S,
        weave: &Weave,
        (ray, behind): (&LaneRay<S>, Lanes<S>),
        (rays, at, count): (Rays<'_>, usize, usize),
        window: Window,
        (scratch, search): (&mut ShapesScratch, &mut Search<S>),
    ) {
        let accel = weave.accel_of_leaves();
        let mut active = !search.uncertain.to_bitmask() & (!0 >> (64 - count));
        for lane in (0..LANES).filter(|lane| active >> lane & 1 == 1) {
            accel.begin_forward(simd, &rays.get(at + lane), window, &mut scratch.searches[lane]);
        }
        for &leaf in accel.unbounded() {
            self.arrive(simd, ray, (&[leaf; LANES], active), window, search);
        }
        // the rays that are on the way to their next leaf; the others have arrived at one
        let (mut moving, mut arrived) = (active, [0; LANES]);
        loop {
            let until = Row((search.t + behind).to_array());
            active &= !search.uncertain.to_bitmask();
            moving &= active;
            while moving != 0 {
                let lane = moving.trailing_zeros() as usize % LANES;
                moving &= moving - 1;
                match accel.next_forward(simd, &mut scratch.searches[lane], until.0[lane]) {
                    Some(leaf) => arrived[lane] = leaf,
                    None => active &= !(1 << lane),
                }
            }
            if active == 0 {
                return;
            }
            moving = self.arrive(simd, ray, (&arrived, active), window, search);
        }
    }

    /// Intersects rays with the leaves at which they have arrived: those with the most frequent form. Returns their bit mask.
    #[inline(always)]
    fn arrive<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        (arrived, active): (&[u32; LANES], u64),
        window: Window,
        search: &mut Search<S>,
    ) -> u64 {
        let mut of_form = [0u64; FORMS + 1];
        let mut lanes = 0;
        for lane in (0..LANES).filter(|lane| active >> lane & 1 == 1) {
            let same = &mut of_form[usize::from(self.places[arrived[lane] as usize].form)];
            *same |= 1 << lane;
            if same.count_ones() > u64::count_ones(lanes) {
                lanes = *same;
            }
        }
        let lead = arrived[lanes.trailing_zeros() as usize % LANES];
        let here = Mask::from_bitmask(simd, lanes);
        let Some(table) = self.forms.get(usize::from(self.places[lead as usize].form)) else {
            search.uncertain |= here;
            return lanes;
        };
        let mut numbers = [lead; LANES];
        for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
            numbers[lane] = arrived[lane];
        }
        let met = self.meet(simd, ray, table, &numbers);
        search.uncertain |= Mask::from_bitmask(simd, met.uncertain & lanes);
        search.take(&met.span, (&numbers, here), met.grazes, window);
        if let Some(span) = &met.after {
            search.take(span, (&numbers, here), met.grazes, window);
        }
        lanes
    }

    /// True if no change at time `next` or later can be welded to the first crossing of a ray.
    fn is_resolved(
        &self,
        weave: &Weave,
        (code, t): (u64, f64),
        ray: &Ray,
        (next, window): (f64, Window),
    ) -> bool {
        let (program, limits) = (weave.program(), &self.limits);
        let end = ray.closest_time(limits.centre) + limits.radius / ray.direction.length();
        let face = self.face(program, code);
        ray.separated_along(program, face, t, (next, end.min(window.t_max()).max(next)))
    }
}
