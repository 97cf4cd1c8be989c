//! Hit arrays of a group for a chunk of columns.

use super::Spans;
use super::changes::Changes;
use super::column_query::ColumnQuery;
use super::level::Level;
use super::schedule::What;
use super::scratch::{ColumnScratch, InitialState};
use super::sides::Sweep;
use rayweave_model::weld::{LeafStates, attribute};
use rayweave_model::{Event, Face, LeafId, LeafKind, PlacementId, PrototypeId, Query, SurfaceId, Window};
use rayweave_rootray::Side;
use rayweave_rootray::hit_array::{HitArrayBuf, combine};
use std::ops::Range;

/// The group and the query of a chunk.
#[derive(Clone, Copy)]
pub(super) struct At<'a> {
    pub group: PrototypeId,
    /// Number of groups around it.
    pub depth: usize,
    pub query: Query<'a>,
    /// Index of the first ray or point of the chunk.
    pub begin: usize,
}

impl<'a> At<'a> {
    /// The whole model, from the first ray or point on.
    pub fn model(query: &Query<'a>) -> At<'a> {
        At { group: PrototypeId(0), depth: 0, query: *query, begin: 0 }
    }

    /// A solid placed in the group. It is evaluated on the whole line, whatever the window.
    fn inside(&self, group: PrototypeId) -> At<'a> {
        let query = Query { window: Window::ALL, ..self.query };
        At { group, depth: self.depth + 1, query, begin: 0 }
    }
}

/// Placeholder for t = -inf, where no face is crossed.
const NO_FACE: Face = Face { leaf: LeafId(0), facet: 0, surface: SurfaceId(0), placement: PlacementId(0) };

impl Spans {
    /// Computes the arrays of the group's outputs for the next chunk. Returns the number of columns.
    pub(super) fn chunk<P: ColumnQuery>(
        &self,
        at: At<'_>,
        level: &mut Level<P>,
        scratch: &mut ColumnScratch<P>,
    ) -> usize {
        let (accel, schedule) = &self.groups[at.group.index()];
        let leaves = self.program.prototype(at.group).leaves.len();
        let columns = level.touched.fill(&level.queries[at.begin..], accel, leaves, &at.query);
        level.events.clear();
        if level.arrays.len() < schedule.slots() {
            level.arrays.resize_with(schedule.slots(), HitArrayBuf::default);
        }
        for step in &schedule.steps {
            let mut out = std::mem::take(&mut level.arrays[step.slot as usize]);
            out.reset(columns);
            match &step.what {
                What::Constant(inside) => constant(*inside, &mut out),
                What::Leaf(leaf) => self.leaf(at, *leaf, level, scratch, &mut out),
                What::Join(rule, range) => {
                    let operands = schedule.operands(range).iter();
                    let arrays = operands.map(|o| (&level.arrays[o.slot as usize], o.complemented));
                    combine(*rule, columns, arrays, &mut level.merged, &mut out);
                }
            }
            level.arrays[step.slot as usize] = out;
        }
        let outputs = schedule.outputs().iter().map(|output| &level.arrays[output.slot as usize]);
        level.merged.merge(columns, outputs.zip(0..));
        level.events.sort(columns);
        columns
    }

    /// Computes the hit array of a leaf, for the columns that can touch it, and its boundary events.
    fn leaf<P: ColumnQuery>(
        &self,
        at: At<'_>,
        leaf: u32,
        level: &mut Level<P>,
        scratch: &mut ColumnScratch<P>,
        out: &mut HitArrayBuf,
    ) {
        if level.touched.columns(leaf).is_empty() {
            return;
        }
        let id = LeafId(self.program.prototype(at.group).leaves.start + leaf);
        match &self.program.leaf(id).kind() {
            LeafKind::Shape { facets, .. } => self.shape(at, leaf, id, facets, level, out),
            LeafKind::Instance { prototype, placement } => {
                let mut inner = scratch.take_level(at.depth + 1);
                let place = &self.program.leaf(id).place();
                inner.queries.clear();
                inner.queries.extend(level.touched.columns(leaf).iter().map(|&column| {
                    let query = &level.queries[at.begin + column as usize];
                    query.placed(place, self.program.prototype(*prototype), *placement)
                }));
                self.instance(at.inside(*prototype), leaf, &mut inner, level, scratch, out);
                scratch.levels[at.depth + 1] = Some(inner);
            }
        }
    }

    fn shape<P: ColumnQuery>(
        &self,
        at: At<'_>,
        leaf: u32,
        id: LeafId,
        facets: &Range<u32>,
        level: &mut Level<P>,
        out: &mut HitArrayBuf,
    ) {
        let table = &self.program.facets()[facets.start as usize..facets.end as usize];
        let Level { queries, touched, leaf: found, events, .. } = level;
        for &column in touched.columns(leaf) {
            let query = &queries[at.begin + column as usize];
            query.leaf(&self.program, table, &at.query, found);
            let mark = events.len();
            if found.starts_inside {
                events.push(column, Event { t: f64::NEG_INFINITY, leaf, face: NO_FACE });
            }
            for &(t, facet) in &found.list {
                let surface = table[facet as usize].surface();
                let face = Face { leaf: id, facet, surface, placement: query.placement() };
                events.push(column, Event { t, leaf, face });
            }
            events.fill_column(mark, column, out);
        }
    }

    /// Evaluates a placed solid in its own frame, as one leaf of the group around it.
    fn instance<P: ColumnQuery>(
        &self,
        at: At<'_>,
        leaf: u32,
        inner: &mut Level<P>,
        level: &mut Level<P>,
        scratch: &mut ColumnScratch<P>,
        out: &mut HitArrayBuf,
    ) {
        let mut initial_state = scratch.take_initial_state(self.program.prototypes(), at.group);
        let mut begin = 0;
        while begin < inner.queries.len() {
            let columns = self.chunk(At { begin, ..at }, inner, scratch);
            for column in 0..columns {
                let outer = level.touched.columns(leaf)[begin + column];
                let mark = level.events.len();
                self.faces(at.group, column, inner, &mut initial_state, |t, face| {
                    level.events.push(outer, Event { t, leaf, face });
                });
                level.events.fill_column(mark, outer, out);
            }
            begin += columns;
        }
        scratch.initial_states[at.group.index()] = Some(initial_state);
    }

    /// Calls `each` for the changes, along one column, of a solid that is a group's only output, with their
    /// faces; first with t = -inf if it is inside from the start.
    fn faces<P>(
        &self,
        group: PrototypeId,
        column: usize,
        level: &mut Level<P>,
        initial_state: &mut InitialState,
        mut each: impl FnMut(f64, Face),
    ) {
        let changes = Changes::new(level.merged.column(column), &mut initial_state.outputs);
        if changes.now() != 0 {
            each(f64::NEG_INFINITY, NO_FACE);
        }
        if changes.is_over() {
            return;
        }
        let network = &self.program.prototype(group).network;
        let mut sweep = Sweep::new(network, &mut initial_state.leaves, level.events.column(column));
        for switch in changes {
            let range = sweep.go(switch.t);
            let (events, end) = (sweep.events(), range.end);
            each(switch.t, attribute(events, range, end, &mut sweep.sides, |f| u32::from(f.output(0))));
        }
        sweep.sides.restore();
    }
}

fn constant(inside: bool, out: &mut HitArrayBuf) {
    if inside {
        (0..out.columns()).for_each(|column| out.fill_column(column, Side::Inside, []));
    }
}
