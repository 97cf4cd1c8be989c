//! The span evaluator of compiled models.

use super::WIDTH;
use super::changes::Changes;
use super::column_query::ColumnRay;
use super::group::At;
use super::level::Level;
use super::schedule::Schedule;
use super::scratch::{ColumnScratch, InitialState};
use super::sides::Sweep;
use crate::accel::Accel;
use rayweave_math::Vec3;
use rayweave_model::weld::{Change, Weld};
use rayweave_model::{
    Crossing, Evaluator, GroupPoint, GroupRay, Limit, Program, PrototypeId, Query, RayAnswer, Rays, RegionId,
    Sink, State,
};
use rayweave_shape::Ray;
use std::ops::Range;
use std::sync::Arc;

/// Evaluator that works on whole arrays: the hits of many rays with one leaf, then with one gate, and so on
/// up the expression.
///
/// Every leaf yields a hit array, one column per ray. Every gate computes one from those of its operands, by
/// counting the operands that are inside. The final arrays are welded and attributed as in all evaluators.
/// This is the method of S. D. Roth, "Ray casting for modeling solids", Computer Graphics and Image
/// Processing 18 (1982), which combines the spans inside of solids from the leaves up, applied to whole
/// batches of rays as in array languages. The answers are those of every other evaluator, bit for bit.
///
/// A chunk of N rays costs O(G) for G gates and, at each gate whose operands have H rows in total, O(H N) and
/// the sorting of each ray's entries. This suits models of few leaves that most rays hit, where the cost per
/// gate is paid once per chunk instead of once per ray. A gate's array is dropped after its last use, so that
/// the number of arrays is at most the width of the expression, O(log n) for a balanced tree with n leaves.
/// In addition, the boundary events of all leaves are kept for the rays of the chunk, for attribution.
#[derive(Clone, Debug)]
pub struct Spans {
    pub(super) program: Arc<Program>,
    /// For each group, a BVH of its leaves and the order of its gates.
    pub(super) groups: Vec<(Accel, Schedule)>,
}

/// Scratch memory of a thread for [`Spans`].
#[derive(Clone, Debug, Default)]
pub struct SpansScratch {
    rays: ColumnScratch<ColumnRay>,
    points: ColumnScratch<GroupPoint>,
    crossings: Vec<Crossing>,
}

impl Spans {
    /// An evaluator of a compiled model.
    pub fn new(program: Arc<Program>) -> Spans {
        let groups = program
            .prototypes()
            .iter()
            .map(|group| (Accel::new(&program, group), Schedule::new(&group.expression)));
        Spans { groups: groups.collect(), program }
    }

    /// Welds the changes of region of one ray into crossings. Returns the region at the start.
    fn report(
        &self,
        question: Question<'_>,
        column: usize,
        level: &mut Level<ColumnRay>,
        initial_state: &mut InitialState,
        out: &mut Vec<Crossing>,
    ) -> RegionId {
        let changes = Changes::new(level.merged.column(column), &mut initial_state.outputs);
        let mut start = changes.now();
        if changes.is_over() {
            return RegionId(start);
        }
        let network = &self.program.prototype(PrototypeId(0)).network;
        let mut sweep = Sweep::new(network, &mut initial_state.leaves, level.events.column(column));
        let mut weld = Weld::new(&self.program, question.ray, sweep.events());
        for switch in changes.take_while(|switch| switch.t < question.query.window.t_max()) {
            if question.query.is_past(switch.t, question.has_starts) {
                start = switch.after;
                continue;
            }
            let Range { start: first, end } = sweep.go(switch.t);
            let (before, after) = (self.state(switch.before), self.state(switch.after));
            let change = Change { t: switch.t, first, end, before, after };
            out.extend(weld.change(change, &mut sweep.sides));
            if question.query.limit == Limit::First && !out.is_empty() {
                break;
            }
        }
        if question.query.limit == Limit::All || out.is_empty() {
            out.extend(weld.finish(sweep.position(), &mut sweep.sides));
        }
        sweep.sides.restore();
        RegionId(start)
    }

    fn state(&self, owner: u32) -> State {
        let region = RegionId(owner);
        State { region, medium: self.program.medium_of(region) }
    }
}

/// A ray with its query.
#[derive(Clone, Copy)]
struct Question<'a> {
    ray: Ray,
    query: &'a Query<'a>,
    has_starts: bool,
}

impl Evaluator for Spans {
    type Scratch = SpansScratch;

    fn name(&self) -> &'static str {
        "spans"
    }

    fn program(&self) -> &Program {
        &self.program
    }

    fn scratch(&self) -> SpansScratch {
        SpansScratch::default()
    }

    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>, scratch: &mut SpansScratch, sink: &mut dyn Sink) {
        let SpansScratch { rays: column_scratch, crossings, .. } = scratch;
        let mut level = column_scratch.take_level(0);
        let mut initial_state = column_scratch.take_initial_state(self.program.prototypes(), PrototypeId(0));
        let mut begin = 0;
        while begin < rays.len() {
            level.queries.clear();
            level.queries.extend((begin..rays.len()).take(WIDTH).map(|number| ColumnRay {
                ray: GroupRay::world(&self.program, rays.get(number), &[]),
                number,
            }));
            let columns = self.chunk(At::model(query), &mut level, column_scratch);
            for column in 0..columns {
                let i = begin + column;
                let has_starts = query.starts.is_some_and(|lists| !lists.of(i).is_empty());
                crossings.clear();
                let question = Question { ray: rays.get(i), query, has_starts };
                let start = self.report(question, column, &mut level, &mut initial_state, crossings);
                sink.ray(RayAnswer { ray: i, start, crossings });
            }
            begin += columns;
        }
        column_scratch.levels[0] = Some(level);
        column_scratch.initial_states[0] = Some(initial_state);
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut SpansScratch, out: &mut [RegionId]) {
        let column_scratch = &mut scratch.points;
        let mut level = column_scratch.take_level(0);
        let mut initial_state = column_scratch.take_initial_state(self.program.prototypes(), PrototypeId(0));
        let mut begin = 0;
        while begin < out.len() {
            let ahead = (begin..out.len()).take(WIDTH);
            let point = |i: usize| GroupPoint::world(Vec3::new(points[0][i], points[1][i], points[2][i]));
            level.queries.clear();
            level.queries.extend(ahead.map(point));
            let columns = self.chunk(At::model(&Query::default()), &mut level, column_scratch);
            for column in 0..columns {
                let changes = Changes::new(level.merged.column(column), &mut initial_state.outputs);
                out[begin + column] = RegionId(changes.now());
            }
            begin += columns;
        }
        column_scratch.levels[0] = Some(level);
        column_scratch.initial_states[0] = Some(initial_state);
    }
}
