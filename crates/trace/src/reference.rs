//! The reference evaluator: root-ray algebra, gate by gate, on all leaves of every ray.
//!
//! There is no culling, no early termination and no state carried from one crossing to the next. The root-ray
//! of each gate is computed from those of its operands in the order of the expression, and freed after its
//! last use, so that memory stays linear in the number of leaves. The code shared with the faster evaluators
//! is only that which defines the answer: the boundary events of leaves, the weld, and the rule of
//! attribution.

use rayweave_math::Vec3;
use rayweave_model::weld::{Change, LeafStates, Weld, attribute};
use rayweave_model::{
    Crossing, Edge, Evaluator, Event, Expression, Gate, GroupPoint, GroupRay, LeafEvents, LeafId, LeafKind,
    Limit, Program, Prototype, PrototypeId, Query, RayAnswer, Rays, RegionId, Rule, Sink, Start, State,
    facets_contain, leaf_events,
};
use rayweave_rootray::{Root, RootRay, Side};
use rayweave_shape::Ray;
use std::sync::Arc;

/// The reference evaluator: the ground truth for tests of the others.
#[derive(Clone, Debug)]
pub struct Reference {
    program: Arc<Program>,
}

/// Scratch memory of a thread: a buffer for the crossings of one ray.
#[derive(Clone, Debug, Default)]
pub struct ReferenceScratch {
    crossings: Vec<Crossing>,
}

impl Reference {
    /// An evaluator of a compiled model.
    pub fn new(program: Arc<Program>) -> Reference {
        Reference { program }
    }

    /// The root-rays of all outputs of a group along a ray, with all boundary events of its leaves.
    fn group(&self, group: PrototypeId, ray: &GroupRay<'_>) -> GroupAnswer {
        let prototype = self.program.prototype(group);
        let leaves: Vec<(bool, Vec<Event>)> =
            (0..prototype.leaves.len() as u32).map(|leaf| self.leaf(prototype, leaf, ray)).collect();
        let outputs = root_rays(&prototype.expression, &leaves);
        let starts_inside = leaves.iter().map(|leaf| leaf.0).collect();
        let mut events: Vec<Event> = leaves.into_iter().flat_map(|leaf| leaf.1).collect();
        events.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.leaf.cmp(&b.leaf)));
        GroupAnswer { outputs, starts_inside, events }
    }

    /// The start side and the boundary events of one leaf of a group.
    fn leaf(&self, prototype: &Prototype, leaf: u32, ray: &GroupRay<'_>) -> (bool, Vec<Event>) {
        let id = LeafId(prototype.leaves.start + leaf);
        match &self.program.leaf(id).kind() {
            LeafKind::Shape { facets, .. } => {
                let table = &self.program.facets()[facets.start as usize..facets.end as usize];
                let mut found = LeafEvents::default();
                leaf_events(&self.program, table, ray, &mut found);
                let event = |&(t, facet): &(f64, u32)| Event {
                    t,
                    leaf,
                    face: rayweave_model::Face {
                        leaf: id,
                        facet,
                        surface: table[facet as usize].surface(),
                        placement: ray.placement,
                    },
                };
                (found.starts_inside, found.list.iter().map(event).collect())
            }
            LeafKind::Instance { prototype: inner, placement } => {
                let place = &self.program.leaf(id).place();
                let local = ray.placed(place, self.program.prototype(*inner), *placement);
                let answer = self.group(*inner, &local);
                answer.into_leaf(&self.program.prototype(*inner).expression, leaf)
            }
        }
    }

    /// The state at the start, and the times at which any region changes, each with the state just after it.
    fn changes(&self, answer: &GroupAnswer) -> (State, Vec<(f64, State)>) {
        let mut times: Vec<f64> = answer.outputs.iter().flat_map(|output| output.times()).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let start = self.state(answer.outputs.iter().map(|output| output.start().is_inside()));
        let after = |t: f64| self.state(answer.outputs.iter().map(|output| inside_after(output, t)));
        (start, times.into_iter().map(|t| (t, after(t))).collect())
    }

    fn state(&self, outputs: impl Iterator<Item = bool>) -> State {
        let last = outputs.enumerate().filter(|(_, inside)| *inside).last();
        let region = RegionId(last.map_or(0, |(k, _)| k as u32 + 1));
        State { region, medium: self.program.medium_of(region) }
    }

    fn one_ray(&self, ray: Ray, query: &Query<'_>, starts: &[Start], out: &mut Vec<Crossing>) -> RegionId {
        let answer = self.group(PrototypeId(0), &GroupRay::world(&self.program, ray, starts));
        let prototype = self.program.prototype(PrototypeId(0));
        let mut states = PlainLeafStates::new(&prototype.expression, answer.starts_inside.clone());
        let (mut now, changes) = self.changes(&answer);
        let window = query.window;
        let mut start = now.region;
        let mut weld = Weld::new(&self.program, ray, &answer.events);
        let mut position = 0;
        for (t, after) in changes.into_iter().take_while(|(t, _)| *t < window.t_max()) {
            let before = std::mem::replace(&mut now, after);
            let first = answer.events.partition_point(|event| event.t < t);
            let end = answer.events.partition_point(|event| event.t <= t);
            answer.events[position..end].iter().for_each(|event| states.toggle(event.leaf));
            position = end;
            if query.is_past(t, !starts.is_empty()) {
                start = after.region;
            } else if before.region != after.region {
                out.extend(weld.change(Change { t, first, end, before, after }, &mut states));
            }
        }
        out.extend(weld.finish(position, &mut states));
        if query.limit == Limit::First {
            out.truncate(1);
        }
        start
    }

    fn inside_group(&self, group: PrototypeId, point: &GroupPoint) -> Vec<bool> {
        let prototype = self.program.prototype(group);
        let inside = |leaf: LeafId| {
            let leaf = self.program.leaf(LeafId(prototype.leaves.start + leaf.0));
            match &leaf.kind() {
                LeafKind::Shape { facets, .. } => {
                    let table = &self.program.facets()[facets.start as usize..facets.end as usize];
                    facets_contain(&self.program, table, point)
                }
                LeafKind::Instance { prototype, .. } => {
                    self.inside_group(*prototype, &point.placed(&leaf.place()))[0]
                }
            }
        };
        let mut values = Vec::new();
        prototype.expression.evaluate(inside, &mut values);
        prototype
            .expression
            .outputs()
            .iter()
            .map(|edge| values[edge.node().index()] ^ edge.is_complemented())
            .collect()
    }
}

impl Evaluator for Reference {
    type Scratch = ReferenceScratch;

    fn name(&self) -> &'static str {
        "reference"
    }

    fn program(&self) -> &Program {
        &self.program
    }

    fn scratch(&self) -> ReferenceScratch {
        ReferenceScratch::default()
    }

    fn crossings(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut ReferenceScratch,
        sink: &mut dyn Sink,
    ) {
        for i in 0..rays.len() {
            let starts = query.starts.map_or(&[][..], |lists| lists.of(i));
            scratch.crossings.clear();
            let start = self.one_ray(rays.get(i), query, starts, &mut scratch.crossings);
            sink.ray(RayAnswer { ray: i, start, crossings: &scratch.crossings });
        }
    }

    fn regions_at(&self, points: [&[f64]; 3], _: &mut ReferenceScratch, out: &mut [RegionId]) {
        for (i, region) in out.iter_mut().enumerate() {
            let point = Vec3::new(points[0][i], points[1][i], points[2][i]);
            *region =
                self.state(self.inside_group(PrototypeId(0), &GroupPoint::world(point)).into_iter()).region;
        }
    }
}

/// Result of a group along a ray.
struct GroupAnswer {
    /// The root-ray of each output.
    outputs: Vec<RootRay<()>>,
    /// The side of each leaf at -inf.
    starts_inside: Vec<bool>,
    /// The boundary events of all leaves, sorted by time, then leaf.
    events: Vec<Event>,
}

impl GroupAnswer {
    /// Converts a placed solid to a leaf of the group around it: start side and boundary events.
    fn into_leaf(self, expression: &Expression, leaf: u32) -> (bool, Vec<Event>) {
        let mut states = PlainLeafStates::new(expression, self.starts_inside);
        let Some(output) = self.outputs.first() else {
            return (false, Vec::new());
        };
        let mut position = 0;
        let faces = output.times().map(|t| {
            let first = self.events.partition_point(|event| event.t < t);
            let end = self.events.partition_point(|event| event.t <= t);
            self.events[position..end].iter().for_each(|event| states.toggle(event.leaf));
            position = end;
            let face = attribute(&self.events, first..end, end, &mut states, |f| u32::from(f.output(0)));
            Event { t, leaf, face }
        });
        (output.start().is_inside(), faces.collect())
    }
}

/// The root-rays of the outputs. Those of all gates are computed in the order of the expression and dropped
/// after their last use.
fn root_rays(expression: &Expression, leaves: &[(bool, Vec<Event>)]) -> Vec<RootRay<()>> {
    let outputs = expression.outputs();
    let mut uses = vec![0usize; expression.node_count()];
    outputs.iter().for_each(|edge| uses[edge.node().index()] += 1);
    for (_, operands) in expression.joins() {
        operands.iter().for_each(|edge| uses[edge.node().index()] += 1);
    }
    let mut known: Vec<Option<RootRay<()>>> = Vec::with_capacity(uses.len());
    let take = |known: &mut Vec<Option<RootRay<()>>>, uses: &mut Vec<usize>, edge: Edge| {
        let node = edge.node().index();
        uses[node] -= 1;
        let ray = if uses[node] == 0 { known[node].take() } else { known[node].clone() };
        let ray = ray.unwrap_or_else(RootRay::empty);
        if edge.is_complemented() { ray.complement() } else { ray }
    };
    for gate in expression.nodes() {
        let ray = match gate {
            Gate::Empty => RootRay::empty(),
            Gate::Universe => RootRay::universe(),
            Gate::Leaf(leaf) => leaf_ray(&leaves[leaf.index()]),
            Gate::Join(rule, operands) => {
                let rays: Vec<_> = operands.iter().map(|&edge| take(&mut known, &mut uses, edge)).collect();
                match rule {
                    Rule::Odd => RootRay::symmetric_difference_all(&rays),
                    Rule::AtLeast(least) => RootRay::at_least(least as usize, &rays),
                }
            }
        };
        known.push(Some(ray));
    }
    outputs.iter().map(|&edge| take(&mut known, &mut uses, edge)).collect()
}

/// The side just after `t`: that of the start, changed once for each root passed.
fn inside_after(ray: &RootRay<()>, t: f64) -> bool {
    let passed = ray.roots().partition_point(|root| root.t <= t);
    ray.start().is_inside() ^ (passed % 2 == 1)
}

fn leaf_ray((starts_inside, events): &(bool, Vec<Event>)) -> RootRay<()> {
    let start = if *starts_inside { Side::Inside } else { Side::Outside };
    let roots = events.iter().map(|event| Root { t: event.t, surface: () }).collect();
    // leaves have strictly increasing finite times
    RootRay::new(start, roots).unwrap_or_else(|_| RootRay::empty())
}

/// Leaf states as plain booleans; every query evaluates the whole expression.
struct PlainLeafStates<'a> {
    expression: &'a Expression,
    inside: Vec<bool>,
    values: Vec<bool>,
}

impl<'a> PlainLeafStates<'a> {
    fn new(expression: &'a Expression, inside: Vec<bool>) -> Self {
        PlainLeafStates { expression, inside, values: Vec::new() }
    }

    fn evaluate(&mut self) -> impl DoubleEndedIterator<Item = bool> + ExactSizeIterator + '_ {
        let inside = &self.inside;
        self.expression.evaluate(|leaf| inside[leaf.index()], &mut self.values);
        let values = &self.values;
        self.expression.outputs().iter().map(|edge| values[edge.node().index()] ^ edge.is_complemented())
    }
}

impl LeafStates for PlainLeafStates<'_> {
    fn toggle(&mut self, leaf: u32) {
        self.inside[leaf as usize] ^= true;
    }

    fn owner(&mut self) -> u32 {
        self.evaluate().rposition(|inside| inside).map_or(0, |k| k as u32 + 1)
    }

    fn output(&mut self, k: u32) -> bool {
        self.evaluate().nth(k as usize).unwrap_or(false)
    }
}
