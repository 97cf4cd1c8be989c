//! All crossings of a ray with a large model: the leaves on its way are intersected eight at a time, one in each lane.
//!
//! Leaves of one form (spheres, boxes, cylinders, tubes, frustums, ellipsoids) share a kernel; their parameters are in a table.
//! Leaves without such a form, leaves that the ray may lie in and those that it starts on are intersected one by one. Where one gate joins all
//! leaves (a union, or a plate minus holes), a count of its operands replaces the network; and where no two crossings are so close
//! that they may have to be welded, neither the weld. All other rays are swept like those of the weave.

mod first;

use super::group::whole;
use super::plan::{leaf_facets, limits};
use crate::Weave;
use crate::weave::{GroupQuery, WeaveScratch, from_zero};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_bvh::ForwardSearch;
use rayweave_model::weld::Trajectory;
use rayweave_model::{
    Edge, Evaluator, Event, Expression, Face, Gate, GroupRay, LeafId, LeafKind, PlacementId, Program,
    PrototypeId, Query, Rays, RegionId, Rule, Start,
};
use rayweave_shape::Ray;
use rayweave_shape::lanes::{
    FormRow, Gap, LANES, LaneLimits, LaneRay, LaneSpan, Lanes, LeafForm, Mask, Uncertain, splat,
};

/// Largest number of forms with tables; leaves of others are intersected one by one.
const FORMS: usize = 31;

/// Largest number of events of a ray that are sorted by counting smaller ones.
const COUNTED: usize = 64;

/// The leaves of a model in tables by their forms.
#[derive(Clone, Debug)]
pub(super) struct Shapes {
    limits: LaneLimits,
    forms: Vec<Table>,
    places: Vec<Place>,
    /// True if all leaves have the first form.
    is_uniform: bool,
    /// True if all leaves that matter have a form.
    has_all: bool,
    gate: Option<OneGate>,
}

/// The leaves of one form.
#[derive(Clone, Debug)]
struct Table {
    form: LeafForm,
    rows: Vec<FormRow>,
}

/// The place of a leaf in the tables.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Its first row.
    row: u32,
    /// The number of its first face.
    face: u32,
    /// The number of its form; [`FORMS`] for none.
    form: u8,
    /// True if it is a complemented operand of the only gate.
    is_complemented: bool,
}

/// A gate that joins all leaves, as the only region.
#[derive(Clone, Copy, Debug)]
struct OneGate {
    rule: Rule,
    /// The number of operands that are inside where all leaves are outside.
    complemented: u32,
}

/// Scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct ShapesScratch {
    /// The leaves by form, the last list without.
    lists: [Vec<u32>; FORMS + 1],
    /// The times of events, the first `count`.
    times: Vec<f64>,
    /// The events: [`code`].
    codes: Vec<u64>,
    count: usize,
    /// The leaves that are inside from the start.
    inside: Vec<u32>,
    /// The crossings, if they follow from the count of operands: times and events.
    pub changes: Vec<(f64, u64)>,
    sorted: Vec<(f64, u64)>,
    searches: [ForwardSearch; LANES],
}

/// The events of a ray so far.
struct Events<'a> {
    times: &'a mut [f64],
    codes: &'a mut [u64],
    count: &'a mut usize,
    inside: &'a mut Vec<u32>,
}

impl Events<'_> {
    /// Removes the events from an index on that are not at a finite time, and lists the leaves that are inside from the start.
    #[cold]
    fn keep_finite(&mut self, at: usize) {
        let mut kept = at;
        for k in at..*self.count {
            let (t, code) = (self.times[k], self.codes[k]);
            if t == f64::NEG_INFINITY {
                self.inside.push(leaf_and_facet(code).0);
            }
            if t.is_finite() {
                (self.times[kept], self.codes[kept]) = (t, code);
                kept += 1;
            }
        }
        *self.count = kept;
    }
}

/// The answer for a ray.
pub(super) enum Listed {
    /// The crossings are in [`ShapesScratch::changes`]; true if the ray starts inside.
    Counted(bool),
    /// The crossings are in the scratch memory of the weave.
    Swept(RegionId),
}

/// A ray, with a time between crossings above which they are not welded.
#[derive(Clone, Copy, Debug)]
struct Bounded {
    ray: Ray,
    longest: f64,
    /// The bound holds for times up to this.
    farthest: f64,
}

impl Trajectory for Bounded {
    fn coincides_along(&self, program: &Program, face: Face, a: f64, b: f64) -> bool {
        let is_apart = b - a > self.longest && a.abs().max(b.abs()) <= self.farthest;
        !is_apart && self.ray.coincides_along(program, face, a, b)
    }

    fn separated_along(&self, program: &Program, face: Face, a: f64, ends: (f64, f64)) -> bool {
        self.ray.separated_along(program, face, a, ends)
    }
}

/// Eight rays, prepared.
pub(super) struct Prepared<S: Simd> {
    ray: LaneRay<S>,
    uncertain: u64,
    longest: Lanes<S>,
    farthest: Lanes<S>,
}

impl Shapes {
    /// The tables of a model; `None` if most of its leaves have no form.
    pub fn new(program: &Program) -> Option<Shapes> {
        let group = program.prototype(PrototypeId(0));
        if group.ball.radius <= 0.0 || group.leaves.start != 0 {
            return None;
        }
        let limits = limits(program, group, group.leaves.clone().map(LeafId));
        let (forms, places) = (Vec::new(), Vec::new());
        let mut shapes = Shapes { limits, forms, places, is_uniform: false, has_all: false, gate: None };
        let (mut used, mut placed) = (0, 0);
        let (mut facets, mut rows) = (Vec::new(), Vec::new());
        for id in group.leaves.clone().map(LeafId) {
            let leaf = program.leaf(id);
            let mut place =
                Place { row: 0, face: program.face_number(id, 0), form: FORMS as u8, is_complemented: false };
            if leaf.is_used() {
                used += 1;
                if let LeafKind::Shape { facets: range } = leaf.kind() {
                    facets.clear();
                    rows.clear();
                    let gaps = leaf_facets(program, range, &mut facets);
                    let form = gaps.filter(|&gaps| gaps <= 1);
                    let form = form.and_then(|_| LeafForm::of(&facets, f64::from(place.face), &mut rows));
                    if let Some((number, row)) = form.and_then(|form| shapes.put(form, &rows)) {
                        (place.form, place.row) = (number, row);
                        placed += 1;
                    }
                }
            }
            shapes.places.push(place);
        }
        shapes.has_all = placed == used;
        shapes.is_uniform = shapes.places.iter().all(|place| place.form == 0);
        shapes.gate = shapes.find_gate(program, &group.expression);
        (2 * placed > used).then_some(shapes)
    }

    /// Appends a leaf to the table of its form. Returns its place.
    fn put(&mut self, form: LeafForm, rows: &[FormRow]) -> Option<(u8, u32)> {
        let known = self.forms.iter().position(|table| table.form == form);
        let number = match known {
            Some(number) => number,
            None if self.forms.len() < FORMS => {
                self.forms.push(Table { form, rows: Vec::new() });
                self.forms.len() - 1
            }
            None => return None,
        };
        let table = &mut self.forms[number].rows;
        table.extend_from_slice(rows);
        Some((number as u8, (table.len() - rows.len()) as u32))
    }

    /// Finds the gate if it is the only one; marks its complemented operands.
    fn find_gate(&mut self, program: &Program, expression: &Expression) -> Option<OneGate> {
        let ([region], &[output]) = (program.regions(), expression.outputs()) else { return None };
        if region.medium == 0 || output.is_complemented() {
            return None;
        }
        let Gate::Join(rule, operands) = expression.node(output.node()) else { return None };
        let leaf = |edge: &Edge| match edge.node().index().checked_sub(2) {
            Some(leaf) if leaf < expression.leaf_count() => Some(leaf),
            _ => None,
        };
        let mut seen = vec![false; expression.leaf_count()];
        for edge in &*operands {
            if std::mem::replace(&mut seen[leaf(edge)?], true) {
                return None;
            }
        }
        let mut complemented = 0;
        for edge in operands.iter().filter(|edge| edge.is_complemented()) {
            self.places[leaf(edge)?].is_complemented = true;
            complemented += 1;
        }
        Some(OneGate { rule, complemented })
    }

    /// Prepares the rays `at..at + 8`.
    pub fn prepare<S: Simd>(&self, simd: S, rays: Rays<'_>, at: usize) -> Prepared<S> {
        simd.vectorize(
            #[inline(always)]
            || self.prepare_here(simd, rays, at),
        )
    }

    #[inline(always)]
    fn prepare_here<S: Simd>(&self, simd: S, rays: Rays<'_>, at: usize) -> Prepared<S> {
        let (origin, direction) =
            (super::group::load(simd, rays.origins, at), super::group::load(simd, rays.directions, at));
        let (ray, uncertain) = LaneRay::new(simd, origin, direction, &self.limits);
        let farthest = ray.middle.abs() + splat(simd, 2.0 * self.limits.radius) / ray.square.sqrt();
        let longest = ray.longest_coincident(farthest, &self.limits);
        Prepared { ray, uncertain: uncertain.always.to_bitmask(), longest, farthest }
    }

    /// Finds the crossings of a ray, lane `lane` of prepared rays. A separate function, compiled once per instruction set.
    pub fn list<S: Simd>(
        &self,
        simd: S,
        weave: &Weave,
        prepared: (&Prepared<S>, usize),
        line: (Ray, &Query<'_>, &[Start]),
        scratch: (&mut ShapesScratch, &mut WeaveScratch),
    ) -> Option<Listed> {
        simd.vectorize(
            #[inline(always)]
            || self.list_here(simd, weave, prepared, line, scratch),
        )
    }

    #[inline(always)]
    fn list_here<S: Simd>(
        &self,
        simd: S,
        weave: &Weave,
        (prepared, lane): (&Prepared<S>, usize),
        (ray, query, starts): (Ray, &Query<'_>, &[Start]),
        (scratch, weave_scratch): (&mut ShapesScratch, &mut WeaveScratch),
    ) -> Option<Listed> {
        if prepared.uncertain >> lane & 1 == 1 {
            return None;
        }
        let query = &if starts.is_empty() { *query } else { from_zero(query) };
        let mut level = weave_scratch.take_level(0);
        weave.candidates(ray, query.window, &mut level.touched);
        let bounds = [prepared.longest.as_slice()[lane], prepared.farthest.as_slice()[lane]];
        let all = prepared.ray.only(simd, lane);
        let mut is_exact = self.find_events(simd, weave.program(), &all, (&level.touched, starts), scratch);
        let others = &scratch.lists[FORMS];
        if !others.is_empty() {
            is_exact = false;
            let seen = GroupRay::world(weave.program(), ray, starts);
            let group_query =
                GroupQuery { group: PrototypeId(0), ray: &seen, window: query.window, depth: 0 };
            for &leaf in others {
                if weave.leaf(group_query, leaf, weave_scratch, &mut level) {
                    scratch.inside.push(leaf);
                }
            }
        }
        if is_exact
            && let Some(gate) = &self.gate
            && let Some(starts_inside) =
                self.counted(simd, gate, bounds, (query, !starts.is_empty()), scratch)
        {
            weave_scratch.give_level(0, level);
            return Some(Listed::Counted(starts_inside));
        }
        let [longest, farthest] = if is_exact { bounds } else { [f64::INFINITY; 2] };
        let path = Bounded { ray, longest, farthest };
        Some(Listed::Swept(self.swept(
            weave,
            path,
            (query, !starts.is_empty()),
            level,
            (scratch, weave_scratch),
        )))
    }

    /// Finds the events of the leaves that have forms, and lists the others. Returns false if crossings may have to be welded at
    /// any distance.
    #[inline(always)]
    fn find_events<S: Simd>(
        &self,
        simd: S,
        program: &Program,
        ray: &LaneRay<S>,
        (leaves, starts): (&[u32], &[Start]),
        scratch: &mut ShapesScratch,
    ) -> bool {
        let ShapesScratch { lists, times, codes, count, inside, .. } = scratch;
        *count = 0;
        inside.clear();
        // two for each leaf, or four with a gap; those of eight leaves are written at once, and padded for sorting
        let room = 4 * leaves.len() + 5 * LANES;
        if times.len() < room {
            times.resize(room, 0.0);
            codes.resize(room, 0);
        }
        let mut events = Events { times, codes, count, inside };
        let [by_form @ .., others] = lists;
        others.clear();
        let is_uniform = self.is_uniform && starts.is_empty();
        if !is_uniform {
            let is_start = |leaf: u32| {
                let facets = program.leaf(LeafId(leaf)).facets();
                starts.iter().any(|start| facets.iter().any(|facet| facet.surface() == start.surface))
            };
            by_form[..self.forms.len()].iter_mut().for_each(Vec::clear);
            for &leaf in leaves {
                let form = usize::from(self.places[leaf as usize].form);
                match by_form.get_mut(form).filter(|_| starts.is_empty() || !is_start(leaf)) {
                    Some(list) => list.push(leaf),
                    None => others.push(leaf),
                }
            }
        }
        let mut is_exact = true;
        for (table, list) in self.forms.iter().zip(&*by_form) {
            let list = if is_uniform { leaves } else { list };
            for leaves in list.chunks(LANES) {
                is_exact &= self.spans(simd, ray, (table, leaves), &mut events, others);
            }
        }
        is_exact
    }

    /// Appends the events of up to eight leaves of one form. Returns false if crossings may have to be welded at any distance.
    #[inline(always)]
    fn spans<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        (table, leaves): (&Table, &[u32]),
        events: &mut Events<'_>,
        others: &mut Vec<u32>,
    ) -> bool {
        let mut numbers = [leaves[0]; LANES];
        numbers[..leaves.len()].copy_from_slice(leaves);
        let met = self.meet(simd, ray, table, &numbers);
        let used = !0 >> (64 - leaves.len() as u32);
        let mut unsure = met.uncertain & used;
        let certain = used & !unsure;
        while unsure != 0 {
            others.push(numbers[unsure.trailing_zeros() as usize % LANES]);
            unsure &= unsure - 1;
        }
        let mut is_exact = self.append(&met.span, (&numbers, certain), met.grazes, events);
        if let Some(span) = &met.after {
            is_exact &= self.append(span, (&numbers, certain), met.grazes, events);
        }
        is_exact
    }

    /// The spans of a ray in eight leaves of one form.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, ray: &LaneRay<S>, table: &Table, numbers: &[u32; LANES]) -> Met<S> {
        let mut rows = [&table.rows[..]; LANES];
        for lane in 0..LANES {
            let row = self.places[numbers[lane] as usize].row as usize;
            rows[lane] = &table.rows[row..row + table.form.rows()];
        }
        let never = Mask::splat(simd, false);
        let mut uncertain = Uncertain { always: never, grazes: never };
        let (span, gap) = table.form.spans(simd, ray, &rows, &mut uncertain);
        let (span, after) = match gap {
            None => (span, None),
            Some((gap, face)) => {
                let [before, after] = pieces(&span, &gap, splat(simd, face), &mut uncertain);
                (before, Some(after))
            }
        };
        Met { span, after, uncertain: uncertain.always.to_bitmask(), grazes: uncertain.grazes }
    }

    /// Appends the events of a span of each of eight leaves, as far as their bits are set in `certain`. Returns false if crossings
    /// may have to be welded at any distance.
    #[inline(always)]
    fn append<S: Simd>(
        &self,
        span: &LaneSpan<S>,
        (numbers, certain): (&[u32; LANES], u64),
        grazes: Mask<S>,
        events: &mut Events<'_>,
    ) -> bool {
        let some = span.is_some().to_bitmask() & certain;
        let (from, to) = (span.from.to_array(), span.to.to_array());
        let (from_face, to_face) = (span.from_face.to_array(), span.to_face.to_array());
        let at = *events.count;
        // all lanes are written, but only those that count are kept
        for lane in 0..LANES {
            let leaf = numbers[lane];
            let slots = *events.count..*events.count + 2;
            events.times[slots.clone()].copy_from_slice(&[from[lane], to[lane]]);
            let is_more = !self.places[leaf as usize].is_complemented;
            events.codes[slots].copy_from_slice(&[
                code(leaf, from_face[lane], is_more),
                code(leaf, to_face[lane], !is_more),
            ]);
            *events.count += (some >> lane & 1) as usize * 2;
        }
        let infinite = span.from.simd_eq(f64::NEG_INFINITY) | span.to.simd_eq(f64::INFINITY);
        if infinite.to_bitmask() & some != 0 {
            events.keep_finite(at);
        }
        grazes.to_bitmask() & some == 0
    }

    /// Counts the operands of the only gate along the ray. Returns true if the ray starts inside; `None` if events are at one
    /// time, or crossings so close that they may have to be welded.
    #[inline(always)]
    fn counted<S: Simd>(
        &self,
        simd: S,
        gate: &OneGate,
        [longest, farthest]: [f64; 2],
        (query, has_starts): (&Query<'_>, bool),
        scratch: &mut ShapesScratch,
    ) -> Option<bool> {
        let ShapesScratch { times, codes, count, inside, changes, sorted, .. } = scratch;
        sort(simd, (times, codes, *count), sorted);
        changes.clear();
        let mut count = gate.complemented;
        for &leaf in &*inside {
            let is_complemented = self.places[leaf as usize].is_complemented;
            count = if is_complemented { count - 1 } else { count + 1 };
        }
        let mut events = sorted.iter();
        let mut next = events.next();
        while let Some(&(t, code)) = next
            && query.is_past(t, has_starts)
        {
            count = if code & 1 == 1 { count + 1 } else { count - 1 };
            next = events.next();
        }
        let starts_inside = gate.rule.holds(count);
        let (mut is_inside, mut last, mut before) = (starts_inside, f64::NEG_INFINITY, f64::NEG_INFINITY);
        while let Some(&(t, code)) = next
            && (t.is_nan() || t < query.window.t_max())
        {
            // events at one time leave a place without a number
            let is_later = t > before;
            if !is_later {
                return None;
            }
            count = if code & 1 == 1 { count + 1 } else { count - 1 };
            if gate.rule.holds(count) != is_inside {
                if !(t - last > longest && t.abs() <= farthest) {
                    return None;
                }
                is_inside = !is_inside;
                last = t;
                changes.push((t, code));
            }
            before = t;
            next = events.next();
        }
        Some(starts_inside)
    }

    /// Sweeps the events like the weave.
    #[inline(never)]
    fn swept(
        &self,
        weave: &Weave,
        path: Bounded,
        query: (&Query<'_>, bool),
        mut level: Box<crate::weave::Level>,
        (scratch, weave_scratch): (&ShapesScratch, &mut WeaveScratch),
    ) -> RegionId {
        let program = weave.program();
        let network = &program.prototype(PrototypeId(0)).network;
        let events = scratch.times.iter().zip(&scratch.codes).take(scratch.count).map(|(&t, &code)| {
            let face = self.face(program, code);
            Event { t, leaf: face.leaf.0, face }
        });
        level.events.extend(events);
        level.sort();
        let mut state = weave_scratch.take_state(program, PrototypeId(0));
        scratch.inside.iter().for_each(|&leaf| network.toggle(&mut state, leaf));
        weave_scratch.crossings.clear();
        weave.swept(path, query, (level, state), weave_scratch)
    }

    /// The face of an event.
    pub fn face(&self, program: &Program, code: u64) -> Face {
        let (leaf, facet) = leaf_and_facet(code);
        let surface = program.facets()[self.face_number(code) as usize].surface();
        Face { leaf: LeafId(leaf), facet, surface, placement: PlacementId(0) }
    }

    /// The number of the face of an event.
    #[inline(always)]
    pub fn face_number(&self, code: u64) -> u32 {
        let (leaf, facet) = leaf_and_facet(code);
        self.places[leaf as usize].face + facet
    }
}

/// The spans of a ray in eight leaves.
struct Met<S: Simd> {
    span: LaneSpan<S>,
    /// The part after the gap, for leaves that can have one.
    after: Option<LaneSpan<S>>,
    /// Bit mask of the uncertain lanes.
    uncertain: u64,
    /// The lanes in which the ray grazes a surface.
    grazes: Mask<S>,
}

/// The parts of spans before and after a gap; without a gap, the whole span and nothing. Where an end of the gap is an end of the
/// span, the order of the facets decides about the face, and the lane is uncertain.
#[inline(always)]
fn pieces<S: Simd>(
    span: &LaneSpan<S>,
    gap: &Gap<S>,
    face: Lanes<S>,
    uncertain: &mut Uncertain<S>,
) -> [LaneSpan<S>; 2] {
    let cuts = gap.from.simd_lt(gap.to);
    let meets = gap.from.simd_eq(span.from) | gap.from.simd_eq(span.to);
    let meets = meets | gap.to.simd_eq(span.from) | gap.to.simd_eq(span.to);
    uncertain.always |= cuts & meets & span.is_some();
    let (mut before, mut after) = (*span, *span);
    before.end_before(gap.from, face);
    after.begin_after(gap.to, face);
    // without a gap, the gap is from +inf to -inf
    after.from = cuts.select(after.from, after.to);
    [before, after]
}

/// An event: the leaf, the number of the face within it, and in bit 0 whether one more operand of the only gate is inside after it.
#[inline(always)]
fn code(leaf: u32, facet: f64, is_more: bool) -> u64 {
    // no face, -1, where a leaf has no such end; such events are dropped
    let facet = (whole(facet) as u32) << 1;
    u64::from(leaf) << 32 | u64::from(facet) | u64::from(is_more)
}

#[inline(always)]
fn leaf_and_facet(code: u64) -> (u32, u32) {
    ((code >> 32) as u32, code as u32 >> 1)
}

/// Sorts the first `count` events by time. Of events at one time, places may keep NaN.
#[inline(always)]
fn sort<S: Simd>(simd: S, (times, codes, count): (&mut [f64], &[u64], usize), sorted: &mut Vec<(f64, u64)>) {
    sorted.clear();
    if count > COUNTED {
        sorted.extend(times[..count].iter().copied().zip(codes.iter().copied()));
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        return;
    }
    sorted.resize(count, (f64::NAN, 0));
    let padded = count.next_multiple_of(LANES);
    times[count..padded].fill(f64::INFINITY);
    let (rows, _) = times[..padded].as_chunks::<LANES>();
    for (&t, &code) in times[..count].iter().zip(codes) {
        let here = splat(simd, t);
        let mut place = 0;
        for row in rows {
            place += Lanes::load_array_ref(simd, row).simd_lt(here).to_bitmask().count_ones();
        }
        if let Some(slot) = sorted.get_mut(place as usize) {
            *slot = (t, code);
        }
    }
}
