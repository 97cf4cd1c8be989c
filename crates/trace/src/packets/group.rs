//! Eight rays through a plan.

use super::logic::{Step, Tape};
use super::plan::{MOST, NONE, Plan};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_model::{Rays, Window};
use rayweave_shape::lanes::{Doubt, LANES, LaneRay, Lanes, Mask, Span, Vec3Lanes, splat};

/// A number of each ray, in memory.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Row(pub [f64; LANES]);

/// The ends of stretches are told apart by these bits of a key.
pub(super) const CODE: u64 = 2 * MOST as u64 - 1;

/// The memory for eight rays.
#[derive(Debug)]
pub(super) struct Group<S: Simd> {
    simd: S,
    /// Where stretch k begins: 2 k, ends: 2 k + 1. Empty ones begin at +inf and end at -inf.
    pub ends: Vec<Row>,
    /// The numbers of the faces there.
    pub faces: Vec<Row>,
    values: Vec<Mask<S>>,
    keys: Vec<Lanes<S>>,
}

/// What was found on eight rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Lanes that have to be asked one by one, a bit each.
    pub doubt: u64,
    /// The greatest number of changes of the winner on a ray.
    pub most: usize,
    /// The winner of each ray at the start.
    pub starts: [f64; LANES],
}

impl<S: Simd> Group<S> {
    pub fn new(simd: S, plan: &Plan) -> Self {
        let steps = plan.differences.iter().chain([&plan.regions]).map(|tape| tape.steps.len()).max();
        Group {
            simd,
            ends: vec![Row([0.0; LANES]); 2 * plan.stretches()],
            faces: vec![Row([0.0; LANES]); 2 * plan.stretches()],
            values: vec![Mask::splat(simd, false); steps.unwrap_or(0)],
            keys: vec![splat(simd, f64::INFINITY); 2 * plan.stretches() + 1],
        }
    }

    /// The changes of rays `at..` (the last one again and again where there are fewer than eight), or of the first two
    /// of them only.
    #[inline(always)]
    pub fn run(&mut self, plan: &Plan, rays: Rays<'_>, at: usize, window: Window, first: bool) -> Found {
        let simd = self.simd;
        let (origin, direction) = (load(simd, rays.origins, at), load(simd, rays.directions, at));
        let (ray, mut doubt) = LaneRay::new(simd, origin, direction, &plan.limits);
        for leaf in 0..plan.leaves.len() {
            self.leaf(plan, leaf, &ray, &mut doubt);
        }
        let most = self.changes(plan, window, first, &mut doubt);
        let mut unsure = doubt.always;
        for k in 1..most {
            let (a, b) = (self.keys[k - 1], self.keys[k]);
            let near = ray.may_hug(a, b, &plan.limits) | doubt.grazes;
            unsure |= near & b.simd_lt(f64::INFINITY);
        }
        Found { doubt: unsure.to_bitmask(), most, starts: self.starts(plan, window) }
    }

    /// The stretch of a leaf and those that are cut out of it.
    #[inline(always)]
    fn leaf(&mut self, plan: &Plan, leaf: usize, ray: &LaneRay<S>, doubt: &mut Doubt<S>) {
        let simd = self.simd;
        let leaf = &plan.leaves[leaf];
        let mut span = Span::line(simd);
        for facet in &plan.facets[leaf.facets.clone()] {
            if let Some(gap) = facet.narrow(simd, ray, &mut span, doubt)
                && facet.gap != NONE
            {
                let face = splat(simd, facet.face);
                self.keep(facet.gap as usize, [gap.from, gap.to], [face, face]);
            }
        }
        self.keep(leaf.span, [span.from, span.to], [span.from_face, span.to_face]);
    }

    #[inline(always)]
    fn keep(&mut self, stretch: usize, [from, to]: [Lanes<S>; 2], faces: [Lanes<S>; 2]) {
        let some = from.simd_lt(to);
        let (plus, minus) = (splat(self.simd, f64::INFINITY), splat(self.simd, f64::NEG_INFINITY));
        some.select(from, plus).store_array(&mut self.ends[2 * stretch].0);
        some.select(to, minus).store_array(&mut self.ends[2 * stretch + 1].0);
        faces[0].store_array(&mut self.faces[2 * stretch].0);
        faces[1].store_array(&mut self.faces[2 * stretch + 1].0);
    }

    #[inline(always)]
    fn end(&self, code: usize) -> Lanes<S> {
        Lanes::load_array_ref(self.simd, &self.ends[code].0)
    }

    /// Finds the ends of stretches at which the winner changes, and sorts them: each key is the time with its last bits
    /// replaced by the number of the end. Times that differ by no more are taken for doubtful later. The greatest
    /// number of them on a ray.
    #[inline(always)]
    fn changes(&mut self, plan: &Plan, window: Window, first: bool, doubt: &mut Doubt<S>) -> usize {
        let simd = self.simd;
        let never = splat(simd, f64::INFINITY);
        let mut count = 0;
        for code in 0..2 * plan.stretches() {
            let t = self.end(code);
            let asked = t.simd_gt(window.t_min()) & t.simd_lt(window.t_max());
            if !asked.any_true() {
                continue;
            }
            let (changes, ties) = self.difference(&plan.differences[code / 2], t, code / 2);
            doubt.always |= ties & asked;
            let changes = changes & asked;
            if !changes.any_true() {
                continue;
            }
            let key = (t.to_bits() & !CODE) | code as u64;
            let key = changes.select(Lanes::from_bits(key), never);
            count = self.insert(key, count, first);
        }
        count
    }

    /// Puts keys into their places among those of each ray.
    #[inline(always)]
    fn insert(&mut self, mut key: Lanes<S>, count: usize, first: bool) -> usize {
        for k in 0..count {
            let other = self.keys[k];
            self.keys[k] = other.min(key);
            key = other.max(key);
        }
        let is_needed = key.simd_lt(f64::INFINITY).any_true() && !(first && count == 2);
        if is_needed {
            self.keys[count] = key;
        }
        count + usize::from(is_needed)
    }

    /// Whether the winner changes where stretch `own` begins or ends, and whether another one on which that depends
    /// does so at the same time.
    #[inline(always)]
    fn difference(&mut self, tape: &Tape, t: Lanes<S>, own: usize) -> (Mask<S>, Mask<S>) {
        let mut ties = Mask::splat(self.simd, false);
        for (at, step) in tape.steps.iter().enumerate() {
            self.values[at] = match *step {
                Step::Input(k) => {
                    let k = k as usize;
                    let (from, to) = (self.end(2 * k), self.end(2 * k + 1));
                    if k > own {
                        ties |= t.simd_eq(from) | t.simd_eq(to);
                    }
                    from.simd_lt(t) & t.simd_lt(to)
                }
                step => self.gate(step),
            };
        }
        (self.output(tape, 0), ties)
    }

    #[inline(always)]
    fn gate(&self, step: Step) -> Mask<S> {
        let at = |k: u16| self.values[k as usize];
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
        let value = self.values[at as usize];
        if complement { !value } else { value }
    }

    /// The winner of each ray just after the window begins.
    #[inline(always)]
    fn starts(&mut self, plan: &Plan, window: Window) -> [f64; LANES] {
        if let (Some(start), f64::NEG_INFINITY) = (plan.start, window.t_min()) {
            return [f64::from(start); LANES];
        }
        let t = splat(self.simd, window.t_min());
        for (at, step) in plan.regions.steps.iter().enumerate() {
            self.values[at] = match *step {
                Step::Input(k) => {
                    self.end(2 * k as usize).simd_le(t) & t.simd_lt(self.end(2 * k as usize + 1))
                }
                step => self.gate(step),
            };
        }
        let mut winner = splat(self.simd, 0.0);
        for k in 0..plan.regions.outputs.len() {
            winner = self.output(&plan.regions, k).select(splat(self.simd, k as f64 + 1.0), winner);
        }
        winner.to_array()
    }

    /// The number of the end at place `k` of lane `lane`; `None` if it has no such change.
    #[inline(always)]
    pub fn code(&self, k: usize, lane: usize) -> Option<usize> {
        let key = self.keys[k].as_slice()[lane];
        (key < f64::INFINITY).then(|| (key.to_bits() & CODE) as usize)
    }

    /// The stretches of a lane that hold just after a time, a bit each.
    pub fn holds_after(&self, lane: usize, t: f64) -> u64 {
        let holds = |k: &usize| self.ends[2 * k].0[lane] <= t && t < self.ends[2 * k + 1].0[lane];
        (0..self.ends.len() / 2).filter(holds).fold(0, |all, k| all | 1 << k)
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, columns: [&[f64]; 3], at: usize) -> Vec3Lanes<S> {
    let [x, y, z] = columns.map(|column| lanes(simd, &column[at..]));
    Vec3Lanes { x, y, z }
}

#[inline(always)]
fn lanes<S: Simd>(simd: S, column: &[f64]) -> Lanes<S> {
    match column.first_chunk::<LANES>() {
        Some(chunk) => Lanes::load_array_ref(simd, chunk),
        None => Lanes::from_fn(simd, |k| column[k.min(column.len() - 1)]),
    }
}
