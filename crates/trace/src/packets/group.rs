//! Evaluation of a plan for a bundle of eight rays.

use super::logic::{Step, Tape};
use super::network::sort;
use super::plan::{Difference, MAX_SPANS, NONE, Plan, STEPS};
use super::remainder::{Bounds, NUMBER, Remainder, all_of, first_of};
use super::starts::Begin;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_model::{Rays, Window};
use rayweave_shape::lanes::{
    LANES, LaneFacet, LaneLimits, LaneRay, LaneSpan, LaneStarts, Lanes, Mask, Uncertain, Vec3Lanes, splat,
};

/// One number per ray, in memory.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Row(pub [f64; LANES]);

/// The low bits of a key, which hold the index of an end of a span.
pub(super) const CODE: u64 = 2 * MAX_SPANS as u64 - 1;

/// A row for each end of a span.
pub(super) type Rows = [Row; 2 * MAX_SPANS];

/// Per-thread memory for eight rays. Its size is fixed, so that indices need no bounds check.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    /// Span k begins at row 2 k and ends at row 2 k + 1. Empty spans begin at +inf and end at -inf.
    pub ends: Rows,
    /// The faces at these ends, as numbers.
    pub faces: Rows,
    pub keys: Rows,
    /// The times of the changes, in order; +inf after the last one.
    pub times: Rows,
    /// The numbers of the faces at the changes, -1 after the last one.
    pub numbers: [[i32; LANES]; 2 * MAX_SPANS],
    /// The face at the first change, -1 for none.
    pub face: Row,
    /// 1 if the ray starts inside, else 0.
    pub inside: Row,
    /// The length of the shortest piece between two changes.
    pub shortest: Row,
}

impl Default for Memory {
    fn default() -> Self {
        let row = Row([0.0; LANES]);
        let rows = [row; 2 * MAX_SPANS];
        let numbers = [[-1; LANES]; 2 * MAX_SPANS];
        Memory {
            ends: rows,
            faces: rows,
            keys: rows,
            times: rows,
            numbers,
            face: row,
            inside: row,
            shortest: row,
        }
    }
}

impl Memory {
    /// The end of a span by its index.
    #[inline(always)]
    pub fn end(&self, code: usize) -> &Row {
        &self.ends[code % (2 * MAX_SPANS)]
    }

    /// The face at the end of a span.
    #[inline(always)]
    pub fn face(&self, code: usize) -> &Row {
        &self.faces[code % (2 * MAX_SPANS)]
    }
}

/// The common span of the leaves of a plan, with the lanes in which several of them have its start, or its end.
pub(super) type CommonSpan<S> = (LaneSpan<S>, [Mask<S>; 2]);

/// A bundle of eight rays in evaluation.
#[derive(Debug)]
pub(super) struct BundleEvaluation<'m, S: Simd> {
    pub simd: S,
    pub memory: &'m mut Memory,
    values: [Mask<S>; STEPS],
    /// The lanes in which several leaves have the start, or the end, of the common span.
    common_ties: [Mask<S>; 2],
}

/// Result of a plan for eight rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Bit mask of the uncertain lanes, which fall back to the weave.
    pub uncertain: u64,
    /// The greatest number of changes of the owner on a ray.
    pub most: usize,
    /// The owner of each ray's start.
    pub starts: [f64; LANES],
}

impl<'m, S: Simd> BundleEvaluation<'m, S> {
    #[inline(always)]
    pub fn new(simd: S, memory: &'m mut Memory) -> Self {
        let never = Mask::splat(simd, false);
        BundleEvaluation { simd, memory, values: [never; STEPS], common_ties: [never; 2] }
    }

    /// [`BundleEvaluation::run_here`] as a separate function, compiled once per instruction set instead of at each call.
    pub fn run(&mut self, plan: &Plan, rays: Rays<'_>, at: usize, window: Window, first: bool) -> Found {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || self.run_here(plan, rays, at, window, first),
        )
    }

    /// [`BundleEvaluation::enter_here`] as a separate function.
    pub fn enter(&mut self, plan: &Plan, ray: &LaneRay<S>, window: Window) -> (Uncertain<S>, Mask<S>) {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || self.enter_here(plan, ray, window),
        )
    }

    /// Finds the first two changes of each ray. Returns the uncertain lanes and the lanes that start inside.
    #[inline(always)]
    fn enter_here(&mut self, plan: &Plan, ray: &LaneRay<S>, window: Window) -> (Uncertain<S>, Mask<S>) {
        let never = Mask::splat(self.simd, false);
        let mut uncertain = Uncertain { always: never, grazes: never };
        let from = splat(self.simd, window.t_min());
        if !self.find_spans(plan, ray, None, (from, window.t_max()), &mut uncertain) {
            self.no_changes();
            return (uncertain, never);
        }
        self.changes(plan, from, window.t_max(), true, &mut uncertain);
        let starts = Lanes::load_array(self.simd, self.starts_after(plan, window));
        (uncertain, starts.simd_gt(splat(self.simd, 0.0)))
    }

    /// [`BundleEvaluation::enter`] for rays that may start on surfaces, each with its own lower bound of t.
    pub fn enter_from(
        &mut self,
        plan: &Plan,
        ray: &LaneRay<S>,
        starts: Option<&LaneStarts<S>>,
        (from, t_max): (Lanes<S>, f64),
    ) -> (Uncertain<S>, Mask<S>) {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || {
                let never = Mask::splat(simd, false);
                let mut uncertain = Uncertain { always: never, grazes: never };
                if !self.find_spans(plan, ray, starts, (from, t_max), &mut uncertain) {
                    self.no_changes();
                    return (uncertain, never);
                }
                self.changes(plan, from, t_max, true, &mut uncertain);
                let starts = Lanes::load_array(simd, self.starts(plan, from));
                (uncertain, starts.simd_gt(splat(simd, 0.0)))
            },
        )
    }

    /// The span of a solid that is the common span of its leaves, for rays that may start on its surfaces; `None` if no ray
    /// passes it.
    pub fn only_span(
        &mut self,
        plan: &Plan,
        ray: &LaneRay<S>,
        starts: Option<&LaneStarts<S>>,
        window: (Lanes<S>, f64),
    ) -> (Option<CommonSpan<S>>, Uncertain<S>) {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || {
                let never = Mask::splat(simd, false);
                let mut uncertain = Uncertain { always: never, grazes: never };
                let span = self.common_span(plan, ray, starts, window, &mut uncertain);
                (span.map(|span| (span, self.common_ties)), uncertain)
            },
        )
    }

    /// Finds the changes of the rays from `at` on: all, or only the first two. If fewer than eight rays are
    /// left, the last one fills the other lanes.
    #[inline(always)]
    fn run_here(&mut self, plan: &Plan, rays: Rays<'_>, at: usize, window: Window, first: bool) -> Found {
        let simd = self.simd;
        let limits = &plan.model.limits;
        let (origin, direction) = (load(simd, rays.origins, at), load(simd, rays.directions, at));
        let (ray, mut uncertain) = LaneRay::new(simd, origin, direction, limits);
        self.run_ready(plan, (&ray, &mut uncertain), limits, window, first)
    }

    /// All changes of rays in the frame of a plan, as a separate function: see [`BundleEvaluation::run_ready`].
    pub fn run_copies(
        &mut self,
        plan: &Plan,
        ray: (&LaneRay<S>, &mut Uncertain<S>),
        limits: &LaneLimits,
        window: Window,
    ) -> Found {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || self.run_ready(plan, ray, limits, window, false),
        )
    }

    /// Finds the changes of rays in the frame of a plan, whose surfaces have these limits.
    #[inline(always)]
    fn run_ready(
        &mut self,
        plan: &Plan,
        (ray, uncertain): (&LaneRay<S>, &mut Uncertain<S>),
        limits: &LaneLimits,
        window: Window,
        first: bool,
    ) -> Found {
        let from = splat(self.simd, window.t_min());
        if !self.find_spans(plan, ray, None, (from, window.t_max()), uncertain) {
            self.no_changes();
            return Found { uncertain: uncertain.always.to_bitmask(), most: 0, starts: [0.0; LANES] };
        }
        if let Some(found) = self.remainder(plan, (ray, limits), (from, window.t_max()), first, uncertain) {
            return found;
        }
        let most = self.changes(plan, from, window.t_max(), first, uncertain);
        let unsure = self.unsure((ray, limits), most, uncertain);
        self.list(most, first);
        Found { uncertain: unsure, most, starts: self.starts_after(plan, window) }
    }

    /// The changes of a plan whose inside is the common span less others. `None` if it is not, or if the order of changes at
    /// one time may matter.
    #[inline(always)]
    fn remainder(
        &mut self,
        plan: &Plan,
        (ray, limits): (&LaneRay<S>, &LaneLimits),
        (from, t_max): (Lanes<S>, f64),
        first: bool,
        uncertain: &Uncertain<S>,
    ) -> Option<Found> {
        let shape = plan.remainder.as_ref()?;
        if (self.common_ties[0] | self.common_ties[1]).any_true() {
            return None;
        }
        let (simd, row) = (self.simd, Row(from.to_array()));
        let bounds = Bounds { from: &row, t_max };
        let tied = simd.vectorize(
            #[inline(always)]
            || match first {
                true => first_of(simd, self.memory, shape, bounds),
                false => all_of(simd, self.memory, shape, bounds),
            },
        );
        if first {
            if tied != 0 {
                return None;
            }
            let (low, high) = (Lanes::load_array_ref(simd, &self.memory.face.0) + WHOLE).to_bits().split();
            let numbers = low.narrow(high).bitcast::<fearless_simd::i32x8<S>>();
            numbers.store_array(&mut self.memory.numbers[0]);
            let unsure = self.unsure_of_first((ray, limits), uncertain);
            return Some(Found { uncertain: unsure, most: 2, starts: self.memory.inside.0 });
        }
        let mut most = 2 * shape.count;
        while most > 0 && !self.time(most - 1).simd_lt(f64::INFINITY).any_true() {
            most -= 1;
        }
        for (numbers, key) in self.memory.numbers[..most].iter_mut().zip(&self.memory.keys) {
            let (low, high) = Lanes::load_array_ref(simd, &key.0).to_bits().split();
            // 63 stands for no face, -1
            let number = ((low.narrow(high) + 1) & NUMBER as u32) - 1;
            number.bitcast::<fearless_simd::i32x8<S>>().store_array(numbers);
        }
        let unsure = tied | self.unsure_of_all((ray, limits), shape, most, uncertain);
        Some(Found { uncertain: unsure, most, starts: self.starts_of(plan, from) })
    }

    /// The lanes whose first two changes are uncertain.
    #[inline(always)]
    fn unsure_of_first(&self, (ray, limits): (&LaneRay<S>, &LaneLimits), uncertain: &Uncertain<S>) -> u64 {
        let (a, b) = (self.time(0), self.time(1));
        let close = uncertain.grazes | ray.may_coincide(a, b, limits);
        (uncertain.always | (close & b.simd_lt(f64::INFINITY))).to_bitmask()
    }

    /// The lanes of which some change is uncertain.
    #[inline(always)]
    fn unsure_of_all(
        &self,
        (ray, limits): (&LaneRay<S>, &LaneLimits),
        shape: &Remainder,
        most: usize,
        uncertain: &Uncertain<S>,
    ) -> u64 {
        let mut unsure = uncertain.always;
        if most < 2 {
            return unsure.to_bitmask();
        }
        let is_piece = |b: Lanes<S>| b.simd_lt(f64::INFINITY);
        unsure |= uncertain.grazes & is_piece(self.time(1));
        let shortest = Lanes::load_array_ref(self.simd, &self.memory.shortest.0);
        let (from, to) = self.span(shape.spans[0]);
        // nearly all bundles pass
        if (ray.may_piece_coincide(shortest, from.abs().max(to.abs()), limits) & is_piece(shortest))
            .any_true()
        {
            for k in 1..most {
                let (a, b) = (self.time(k - 1), self.time(k));
                unsure |= ray.may_coincide(a, b, limits) & is_piece(b);
            }
        }
        unsure.to_bitmask()
    }

    /// Times and faces of the changes by their keys: all, or only those of the first ones.
    #[inline(always)]
    fn list(&mut self, most: usize, first: bool) {
        let Memory { ends, faces, keys, times, numbers, face, .. } = &mut *self.memory;
        for k in 0..if first { 1 } else { most } {
            for lane in 0..LANES {
                let key = keys[k].0[lane];
                let code = (key.to_bits() & CODE) as usize;
                let is_change = key < f64::INFINITY;
                times[k].0[lane] = if is_change { ends[code].0[lane] } else { f64::INFINITY };
                let number = if is_change { faces[code].0[lane] } else { -1.0 };
                numbers[k][lane] = whole(number);
                if first {
                    face.0[lane] = number;
                }
            }
        }
    }

    /// The time of change `k`.
    #[inline(always)]
    pub fn time(&self, k: usize) -> Lanes<S> {
        Lanes::load_array_ref(self.simd, &self.memory.times[k % (2 * MAX_SPANS)].0)
    }

    /// The owner of each ray just after `from`; in a bounded solid, the same for all rays that start at -inf.
    #[inline(always)]
    fn starts_of(&mut self, plan: &Plan, from: Lanes<S>) -> [f64; LANES] {
        match plan.start {
            Some(start) if from.simd_eq(f64::NEG_INFINITY).all_true() => [f64::from(start); LANES],
            _ => self.starts(plan, from),
        }
    }

    /// The lanes whose changes are uncertain.
    #[inline(always)]
    fn unsure(
        &self,
        (ray, limits): (&LaneRay<S>, &LaneLimits),
        most: usize,
        uncertain: &Uncertain<S>,
    ) -> u64 {
        let mut unsure = uncertain.always;
        if most < 2 {
            return unsure.to_bitmask();
        }
        let is_piece = |b: Lanes<S>| b.simd_lt(f64::INFINITY);
        unsure |= uncertain.grazes & is_piece(self.key(1));
        let (mut shortest, mut latest) = (splat(self.simd, f64::INFINITY), self.key(0).abs());
        for k in 1..most {
            let (a, b) = (self.key(k - 1), self.key(k));
            shortest = is_piece(b).select(shortest.min(b - a), shortest);
            latest = is_piece(b).select(latest.max(b.abs()), latest);
        }
        // nearly all bundles pass
        if (ray.may_piece_coincide(shortest, latest, limits) & shortest.simd_lt(f64::INFINITY)).any_true() {
            for k in 1..most {
                let (a, b) = (self.key(k - 1), self.key(k));
                unsure |= ray.may_coincide(a, b, limits) & is_piece(b);
            }
        }
        unsure.to_bitmask()
    }

    /// [`BundleEvaluation::run`] for rays that start on surfaces.
    pub fn run_from(&mut self, plan: &Plan, rays: Rays<'_>, at: usize, begin: &Begin, first: bool) -> Found {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || self.run_from_here(plan, rays, at, begin, first),
        )
    }

    #[inline(always)]
    fn run_from_here(&mut self, plan: &Plan, rays: Rays<'_>, at: usize, begin: &Begin, first: bool) -> Found {
        let simd = self.simd;
        let (origin, direction) = (load(simd, rays.origins, at), load(simd, rays.directions, at));
        let limits = &plan.model.limits;
        let (ray, mut uncertain) = LaneRay::new(simd, origin, direction, limits);
        let starts = LaneStarts {
            surface: Lanes::load_array_ref(simd, &begin.surface.0),
            inside: Mask::from_bitmask(simd, begin.inside),
        };
        let from = Lanes::load_array_ref(simd, &begin.from.0);
        if !self.find_spans(plan, &ray, Some(&starts), (from, begin.t_max), &mut uncertain) {
            self.no_changes();
            let uncertain = uncertain.always.to_bitmask() | begin.uncertain;
            return Found { uncertain, most: 0, starts: [0.0; LANES] };
        }
        if let Some(found) = self.remainder(plan, (&ray, limits), (from, begin.t_max), first, &uncertain) {
            return Found { uncertain: found.uncertain | begin.uncertain, ..found };
        }
        let most = self.changes(plan, from, begin.t_max, first, &mut uncertain);
        let uncertain = self.unsure((&ray, limits), most, &uncertain) | begin.uncertain;
        self.list(most, first);
        Found { uncertain, most, starts: self.starts(plan, from) }
    }

    /// Computes the spans of all leaves. Returns false as soon as it is certain that no ray is ever inside.
    #[inline(always)]
    fn find_spans(
        &mut self,
        plan: &Plan,
        ray: &LaneRay<S>,
        starts: Option<&LaneStarts<S>>,
        window: (Lanes<S>, f64),
        uncertain: &mut Uncertain<S>,
    ) -> bool {
        if plan.common > 0 {
            let Some(span) = self.common_span(plan, ray, starts, window, uncertain) else { return false };
            self.keep_span(plan.leaves[0].span, &span);
        }
        for leaf in &plan.leaves[plan.common..] {
            self.leaf(plan.facets_of(leaf), leaf.span, ray, starts, uncertain);
        }
        true
    }

    /// The common span of the first leaves; `None` if it is empty on all rays.
    #[inline(always)]
    fn common_span(
        &mut self,
        plan: &Plan,
        ray: &LaneRay<S>,
        starts: Option<&LaneStarts<S>>,
        (from, t_max): (Lanes<S>, f64),
        uncertain: &mut Uncertain<S>,
    ) -> Option<LaneSpan<S>> {
        let never = Mask::splat(self.simd, false);
        let (mut all, mut ties) = (LaneSpan::line(self.simd), [never; 2]);
        for (number, leaf) in plan.leaves[..plan.common].iter().enumerate() {
            let (span, is_met) = self.leaf_span(plan.facets_of(leaf), leaf.gaps, ray, starts, uncertain);
            if !is_met {
                return None;
            }
            if number == 0 {
                all = span;
                continue;
            }
            // the order of two changes at one time decides whether the solid has an inside between them
            let contact = all.clamp_to(&span, &mut ties);
            uncertain.always |= contact.simd_gt(from) & contact.simd_lt(t_max);
            if !all.is_some().any_true() {
                return None;
            }
        }
        self.common_ties = ties;
        Some(all)
    }

    /// Sets keys, times and faces so that no ray has a change.
    #[inline(always)]
    pub fn no_changes(&mut self) {
        let never = splat(self.simd, f64::INFINITY);
        self.set_key(0, never);
        self.set_key(1, never);
        // the previous bundle has left its own
        never.store_array(&mut self.memory.times[0].0);
        self.memory.face = Row([-1.0; LANES]);
        self.memory.numbers[0] = [-1; LANES];
    }

    /// The span of a leaf with these facets, and false if it is empty on all rays. Keeps its gaps, which do not matter in
    /// that case: gap k has the index `gaps + k`.
    #[inline(always)]
    fn leaf_span(
        &mut self,
        facets: &[LaneFacet],
        gaps: usize,
        ray: &LaneRay<S>,
        starts: Option<&LaneStarts<S>>,
        uncertain: &mut Uncertain<S>,
    ) -> (LaneSpan<S>, bool) {
        let simd = self.simd;
        let (mut span, mut is_met) = (LaneSpan::line(simd), true);
        for facet in facets {
            let gap = match starts {
                Some(starts) => facet.narrow_from(simd, ray, starts, &mut span, uncertain),
                None => facet.narrow(simd, ray, &mut span, uncertain),
            };
            if let Some(gap) = gap
                && facet.gap != NONE
            {
                let face = splat(simd, facet.face);
                self.keep(gaps + facet.gap as usize, [gap.from, gap.to], [face, face]);
            }
            is_met = span.is_some().any_true();
            if !is_met {
                break;
            }
        }
        (span, is_met)
    }

    /// Computes and keeps the span and the gaps of a leaf whose span has the index `first`, followed by its gaps. Returns
    /// false if it is empty on all rays.
    #[inline(always)]
    pub fn leaf(
        &mut self,
        facets: &[LaneFacet],
        first: usize,
        ray: &LaneRay<S>,
        starts: Option<&LaneStarts<S>>,
        uncertain: &mut Uncertain<S>,
    ) -> bool {
        if let ([facet], None) = (facets, starts)
            && let Some(span) = facet.only(self.simd, ray, uncertain)
        {
            self.keep_span(first, &span);
            return span.is_some().any_true();
        }
        let (span, is_met) = self.leaf_span(facets, first, ray, starts, uncertain);
        self.keep_span(first, &span);
        is_met
    }

    #[inline(always)]
    fn keep_span(&mut self, number: usize, span: &LaneSpan<S>) {
        self.keep(number, [span.from, span.to], [span.from_face, span.to_face]);
    }

    #[inline(always)]
    fn keep(&mut self, span: usize, [from, to]: [Lanes<S>; 2], faces: [Lanes<S>; 2]) {
        let (some, span) = (from.simd_lt(to), span % MAX_SPANS);
        let (plus, minus) = (splat(self.simd, f64::INFINITY), splat(self.simd, f64::NEG_INFINITY));
        some.select(from, plus).store_array(&mut self.memory.ends[2 * span].0);
        some.select(to, minus).store_array(&mut self.memory.ends[2 * span + 1].0);
        faces[0].store_array(&mut self.memory.faces[2 * span].0);
        faces[1].store_array(&mut self.memory.faces[2 * span + 1].0);
    }

    #[inline(always)]
    pub fn end(&self, code: usize) -> Lanes<S> {
        Lanes::load_array_ref(self.simd, &self.memory.ends[code % (2 * MAX_SPANS)].0)
    }

    #[inline(always)]
    pub fn key(&self, k: usize) -> Lanes<S> {
        Lanes::load_array_ref(self.simd, &self.memory.keys[k % (2 * MAX_SPANS)].0)
    }

    /// Finds the ends of spans at which the owner changes, and sorts them. Each key is the time with its low
    /// bits replaced by the index of the end; times that differ in these bits only are marked as uncertain
    /// later. Returns the greatest number of changes on a ray, or 2 if `first` limits the search to two.
    #[inline(always)]
    fn changes(
        &mut self,
        plan: &Plan,
        from: Lanes<S>,
        t_max: f64,
        first: bool,
        uncertain: &mut Uncertain<S>,
    ) -> usize {
        let simd = self.simd;
        let never = splat(simd, f64::INFINITY);
        let (mut earliest, mut second, mut tied, mut count) = (never, never, never, 0);
        let common = plan.common_span();
        for (span, difference) in plan.differences.iter().enumerate() {
            for (end, code) in [2 * span, 2 * span + 1].into_iter().enumerate() {
                let t = self.end(code);
                let queried = t.simd_gt(from) & t.simd_lt(t_max);
                if !queried.any_true() {
                    // most rays miss most leaves
                    continue;
                }
                let (changes, mut ties) = self.difference(difference, t, queried);
                if span == common {
                    ties |= self.common_ties[end] & queried;
                }
                let key = (t.to_bits() & !CODE) | code as u64;
                let key = changes.select(Lanes::from_bits(key), never);
                if first {
                    tied = tied.min(ties.select(t, never));
                    second = second.min(earliest.max(key));
                    earliest = earliest.min(key);
                } else {
                    uncertain.always |= ties;
                    self.set_key(count, key);
                    count += usize::from(changes.any_true());
                }
            }
        }
        if first {
            // a tie after the first change counts as the second change
            uncertain.always |= tied.simd_le(earliest) & tied.simd_lt(never);
            self.set_key(0, earliest);
            self.set_key(1, second.min(tied));
            return 2;
        }
        sort(simd, &mut self.memory.keys, count);
        while count > 0 && self.key(count - 1).simd_eq(never).all_true() {
            count -= 1;
        }
        count
    }

    #[inline(always)]
    pub fn set_key(&mut self, k: usize, key: Lanes<S>) {
        key.store_array(&mut self.memory.keys[k % (2 * MAX_SPANS)].0);
    }

    /// Lanes in which the owner changes at the end of a span at time `t`, and lanes in which another relevant
    /// span begins or ends at the same time (a tie).
    #[inline(always)]
    fn difference(&mut self, difference: &Difference, t: Lanes<S>, queried: Mask<S>) -> (Mask<S>, Mask<S>) {
        let (mut changes, mut ties) = (queried, Mask::splat(self.simd, false));
        match difference {
            Difference::Cube(literals) => {
                for literal in literals {
                    let (from, to) = self.span(literal.span as usize);
                    let holds = from.simd_lt(t) & t.simd_lt(to);
                    changes = if literal.inside { changes & holds } else { changes & !holds };
                    if literal.ties {
                        ties |= t.simd_eq(from) | t.simd_eq(to);
                    }
                }
            }
            Difference::Tape(tape) => {
                for (at, step) in tape.steps.iter().enumerate() {
                    self.values[at % STEPS] = match *step {
                        Step::Input(k) => {
                            let (from, to) = self.span(k as usize);
                            ties |= t.simd_eq(from) | t.simd_eq(to);
                            from.simd_lt(t) & t.simd_lt(to)
                        }
                        step => self.gate(step),
                    };
                }
                changes &= self.output(tape, 0);
            }
        }
        (changes, ties & queried)
    }

    /// The times at which a span begins and ends.
    #[inline(always)]
    pub fn span(&self, k: usize) -> (Lanes<S>, Lanes<S>) {
        (self.end(2 * k), self.end(2 * k + 1))
    }

    #[inline(always)]
    fn gate(&self, step: Step) -> Mask<S> {
        let at = |k: u16| self.values[k as usize % STEPS];
        match step {
            Step::Constant | Step::Input(_) => Mask::splat(self.simd, false),
            Step::And(a, b) => at(a) & at(b),
            Step::AndNot(a, b) => at(a) & !at(b),
            Step::Nor(a, b) => !(at(a) | at(b)),
            Step::Xor(a, b) => at(a) ^ at(b),
        }
    }

    #[inline(always)]
    fn output(&self, tape: &Tape, k: usize) -> Mask<S> {
        let (at, complement) = tape.outputs[k];
        let value = self.values[at as usize % STEPS];
        if complement { !value } else { value }
    }

    /// The owner of each ray just after the beginning of the window.
    #[inline(always)]
    fn starts_after(&mut self, plan: &Plan, window: Window) -> [f64; LANES] {
        match (plan.start, window.t_min()) {
            (Some(start), f64::NEG_INFINITY) => [f64::from(start); LANES],
            (_, t_min) => self.starts(plan, splat(self.simd, t_min)),
        }
    }

    /// The owner of each ray just after `t`.
    #[inline(always)]
    fn starts(&mut self, plan: &Plan, t: Lanes<S>) -> [f64; LANES] {
        for (at, step) in plan.regions.steps.iter().enumerate() {
            self.values[at % STEPS] = match *step {
                Step::Input(k) => {
                    let (from, to) = self.span(k as usize);
                    from.simd_le(t) & t.simd_lt(to)
                }
                step => self.gate(step),
            };
        }
        let mut owner = splat(self.simd, 0.0);
        for k in 0..plan.regions.outputs.len() {
            owner = self.output(&plan.regions, k).select(splat(self.simd, k as f64 + 1.0), owner);
        }
        owner.to_array()
    }

    /// The index of the span end at position `k` of a lane; `None` if the lane has fewer changes.
    #[inline(always)]
    pub fn code(&self, k: usize, lane: usize) -> Option<usize> {
        let key = self.memory.keys[k % (2 * MAX_SPANS)].0[lane % LANES];
        (key < f64::INFINITY).then(|| (key.to_bits() & CODE) as usize)
    }

    /// Bit mask of the spans that contain the times just after `t`, in one lane.
    pub fn holds_after(&self, plan: &Plan, lane: usize, t: f64) -> u64 {
        let ends = &self.memory.ends;
        let holds = |k: &usize| ends[2 * k].0[lane] <= t && t < ends[2 * k + 1].0[lane];
        (0..plan.span_count()).filter(holds).fold(0, |all, k| all | 1 << k)
    }
}

/// 1.5 * 2^52: after its addition the low bits of a whole number, -2^31 <= x < 2^31, hold the integer.
pub(super) const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Converts a whole number, -2^31 <= x < 2^31, without the checks of a cast.
#[inline(always)]
pub(super) fn whole(x: f64) -> i32 {
    (x + WHOLE).to_bits() as i32
}

/// Loads eight rays from three columns, from a multiple of eight on.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, columns: [&[f64]; 3], at: usize) -> Vec3Lanes<S> {
    let [x, y, z] = columns;
    Vec3Lanes { x: lanes(simd, x, at), y: lanes(simd, y, at), z: lanes(simd, z, at) }
}

#[inline(always)]
fn lanes<S: Simd>(simd: S, column: &[f64], at: usize) -> Lanes<S> {
    match column.as_chunks().0.get(at / LANES) {
        Some(chunk) => Lanes::load_array_ref(simd, chunk),
        None => {
            let mut row = [column[column.len() - 1]; LANES];
            row[..column.len() - at].copy_from_slice(&column[at..]);
            Lanes::load_array(simd, row)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::whole;

    #[test]
    fn whole_numbers_are_kept() {
        for k in [0, 1, -1, 7, 1 << 20, i32::MAX, i32::MIN] {
            assert_eq!(whole(f64::from(k)), k);
        }
    }
}
