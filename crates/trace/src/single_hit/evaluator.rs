//! The single-hit evaluator of compiled models.

use super::roots::Roots;
use super::sides::{Sides, Turned};
use super::{Explanation, MAX_NODES, NoObserver, Observer, Stacks, TooLarge, Tree, ValueStep};
use rayweave_math::Vec3;
use rayweave_model::weld::{Change, LeafStates, Paused, Weld, attribute};
use rayweave_model::{
    Crossing, Evaluator, Event, Face, GroupPoint, GroupRay, LeafEvents, LeafId, LeafKind, Limit, Program,
    PrototypeId, Query, RayAnswer, Rays, RegionId, Sink, Start, State, facets_contain, leaf_events,
};
use rayweave_shape::Ray;
use std::ops::Range;
use std::sync::Arc;

/// Evaluator that computes one crossing at a time, by the query "next change after t".
///
/// The tree of the model is evaluated from t_min on, and again from each crossing on. The answers are those
/// of every other evaluator, bit for bit. Every query visits every leaf and so takes time linear in their
/// number: this evaluator is for small models, for explanations, and for checks of the others.
#[derive(Clone, Debug)]
pub struct SingleHit {
    program: Arc<Program>,
    /// The tree of each group.
    trees: Vec<Tree>,
    /// The height and the number of leaves of the largest groups.
    height: u32,
    leaves: usize,
}

/// Scratch memory of a thread for [`SingleHit`].
#[derive(Clone, Debug)]
pub struct SingleHitScratch {
    pub(super) stacks: Stacks,
    /// Buffers per nesting level. A placed solid has at least two placements, and a model has fewer than
    /// 2^31, so there are at most 31 levels.
    pub(super) levels: Vec<Option<Box<Level>>>,
    pub(super) crossings: Vec<Crossing>,
    values: Vec<u32>,
}

/// The buffers for one group along one ray.
#[derive(Clone, Debug)]
pub(super) struct Level {
    pub roots: Roots,
    turned: Turned,
    /// The boundary events near the changes found so far.
    events: Vec<Event>,
    leaf: LeafEvents,
    /// The changes of a placed solid, from the next nesting level.
    inner: Vec<(f64, Face)>,
}

impl SingleHit {
    /// An evaluator of a compiled model.
    ///
    /// # Errors
    /// [`TooLarge`] if the trees of all groups together have more than [`MAX_NODES`] nodes; shared parts are
    /// duplicated at each use. This also bounds the stacks of a thread.
    pub fn new(program: Arc<Program>) -> Result<SingleHit, TooLarge> {
        let mut trees = Vec::with_capacity(program.prototypes().len());
        let mut left = MAX_NODES;
        for group in program.prototypes() {
            let tree =
                Tree::new(&group.expression.nodes().collect::<Vec<_>>(), group.expression.outputs(), left)?;
            left -= tree.nodes().len() as u64;
            trees.push(tree);
        }
        let height = trees.iter().map(Tree::height).max().unwrap_or(0);
        let leaves = program.prototypes().iter().map(|group| group.leaves.len()).max().unwrap_or(0);
        Ok(SingleHit { program, trees, height, leaves })
    }

    /// The tree of a group.
    pub fn tree(&self, group: PrototypeId) -> &Tree {
        &self.trees[group.index()]
    }

    /// Explains the answer for one ray: records every query, decision and crossing.
    ///
    /// Start lists count as in [`Evaluator::crossings`], for ray 0.
    pub fn explain(&self, ray: Ray, query: &Query<'_>) -> Explanation {
        Explanation::new(self, ray, query)
    }

    /// Collects the boundary events of all leaves of a group along a ray.
    pub(super) fn gather(
        &self,
        group: PrototypeId,
        ray: &GroupRay<'_>,
        depth: usize,
        scratch: &mut SingleHitScratch,
    ) -> Box<Level> {
        let mut level = self.take_level(scratch, depth);
        let leaves = &self.program.prototype(group).leaves;
        for leaf in 0..leaves.len() as u32 {
            let id = LeafId(leaves.start + leaf);
            match &self.program.leaf(id).kind() {
                // the tree does not contain it
                _ if !self.program.leaf(id).is_used() => {
                    level.roots.enter(false, std::iter::empty());
                }
                LeafKind::Shape { facets, .. } => self.shape(id, facets, ray, &mut level),
                LeafKind::Instance { prototype, placement } => {
                    let place = &self.program.leaf(id).place();
                    let ray = ray.placed(place, self.program.prototype(*prototype), *placement);
                    let inside = self.instance(*prototype, &ray, depth + 1, scratch, &mut level.inner);
                    level.roots.enter(inside, level.inner.iter().copied());
                }
            }
        }
        level
    }

    fn shape(&self, id: LeafId, facets: &Range<u32>, ray: &GroupRay<'_>, level: &mut Level) {
        let table = &self.program.facets()[facets.start as usize..facets.end as usize];
        leaf_events(&self.program, table, ray, &mut level.leaf);
        let face = |facet: u32| {
            let surface = table[facet as usize].surface();
            Face { leaf: id, facet, surface, placement: ray.placement }
        };
        let events = level.leaf.list.iter().map(|&(t, facet)| (t, face(facet)));
        level.roots.enter(level.leaf.starts_inside, events);
    }

    /// All changes of a placed solid, by repeated queries. Returns true if it is inside from the start.
    fn instance(
        &self,
        group: PrototypeId,
        ray: &GroupRay<'_>,
        depth: usize,
        scratch: &mut SingleHitScratch,
        out: &mut Vec<(f64, Face)>,
    ) -> bool {
        out.clear();
        let mut level = self.gather(group, ray, depth, scratch);
        let tree = self.tree(group);
        let mut step = scratch.stacks.next_change(tree, &level.roots, f64::NEG_INFINITY, &mut NoObserver);
        let starts_inside = step.before != 0;
        while step.t < f64::INFINITY {
            out.push((step.t, self.face(tree, &mut level, step.t)));
            step = scratch.stacks.next_change(tree, &level.roots, step.t, &mut NoObserver);
        }
        scratch.levels[depth] = Some(level);
        starts_inside
    }

    /// The face through which the only output of a group changes at `t`.
    fn face(&self, tree: &Tree, level: &mut Level, t: f64) -> Face {
        let Level { roots, events, turned, .. } = level;
        events.clear();
        roots.events(t.next_down(), t, events);
        let mut sides = Sides { tree, roots, t, turned };
        attribute(events, 0..events.len(), events.len(), &mut sides, |s| u32::from(s.output(0)))
    }

    fn take_level(&self, scratch: &mut SingleHitScratch, depth: usize) -> Box<Level> {
        if scratch.levels.len() <= depth {
            scratch.levels.resize_with(depth + 1, || None);
        }
        let mut level = scratch.levels[depth].take().unwrap_or_else(|| {
            Box::new(Level {
                roots: Roots::default(),
                turned: Turned::new(self.leaves, self.height),
                events: Vec::new(),
                leaf: LeafEvents::default(),
                inner: Vec::new(),
            })
        });
        level.roots.clear();
        level
    }

    fn one_ray(
        &self,
        ray: Ray,
        query: &Query<'_>,
        starts: &[Start],
        scratch: &mut SingleHitScratch,
    ) -> RegionId {
        let group = PrototypeId(0);
        let seen = GroupRay::world(&self.program, ray, starts);
        let mut level = self.gather(group, &seen, 0, scratch);
        let start = self.walk(ray, query, !starts.is_empty(), &mut level, scratch, &mut NoObserver);
        scratch.levels[0] = Some(level);
        start
    }

    /// Queries from crossing to crossing and welds. Returns the region at the start.
    pub(super) fn walk(
        &self,
        ray: Ray,
        query: &Query<'_>,
        has_starts: bool,
        level: &mut Level,
        scratch: &mut SingleHitScratch,
        observer: &mut impl WalkObserver,
    ) -> RegionId {
        let tree = self.tree(PrototypeId(0));
        let mut welding =
            Welding { program: &self.program, tree, ray, paused: Paused::default(), last: None };
        level.events.clear();
        scratch.crossings.clear();
        let mut step =
            self.question(tree, level, &mut scratch.stacks, first_t_min(query, has_starts), observer);
        let start = RegionId(step.before);
        while step.t < query.window.t_max() {
            if let Some(crossing) = welding.step(step, level) {
                observer.crossing(&crossing);
                scratch.crossings.push(crossing);
                if query.limit == Limit::First {
                    return start;
                }
            }
            step = self.question(tree, level, &mut scratch.stacks, step.t, observer);
        }
        let last = welding.finish(level);
        last.iter().for_each(|crossing| observer.crossing(crossing));
        scratch.crossings.extend(last);
        start
    }

    fn question(
        &self,
        tree: &Tree,
        level: &Level,
        stacks: &mut Stacks,
        t_min: f64,
        observer: &mut impl WalkObserver,
    ) -> ValueStep {
        observer.question(t_min);
        let step = stacks.next_change(tree, &level.roots, t_min, observer);
        observer.answer(step);
        step
    }

    /// The value of a group's tree at a point: the number of the last output that contains it, or 0.
    fn value_at(&self, group: PrototypeId, point: &GroupPoint, values: &mut Vec<u32>) -> u32 {
        let tree = self.tree(group);
        let first = self.program.prototype(group).leaves.start;
        let holds = |leaf: u32, values: &mut Vec<u32>| {
            let leaf = self.program.leaf(LeafId(first + leaf));
            match &leaf.kind() {
                LeafKind::Shape { facets, .. } => {
                    let table = &self.program.facets()[facets.start as usize..facets.end as usize];
                    facets_contain(&self.program, table, point)
                }
                LeafKind::Instance { prototype, .. } => {
                    self.value_at(*prototype, &point.placed(&leaf.place()), values) != 0
                }
            }
        };
        tree.evaluate(tree.nodes().len() - 1, holds, values)
    }
}

impl Evaluator for SingleHit {
    type Scratch = SingleHitScratch;

    fn name(&self) -> &'static str {
        "single_hit"
    }

    fn program(&self) -> &Program {
        &self.program
    }

    fn scratch(&self) -> SingleHitScratch {
        SingleHitScratch {
            stacks: Stacks::new(self.height),
            levels: Vec::new(),
            crossings: Vec::new(),
            values: Vec::new(),
        }
    }

    fn crossings(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut SingleHitScratch,
        sink: &mut dyn Sink,
    ) {
        for i in 0..rays.len() {
            let starts = query.starts.map_or(&[][..], |lists| lists.of(i));
            let start = self.one_ray(rays.get(i), query, starts, scratch);
            sink.ray(RayAnswer { ray: i, start, crossings: &scratch.crossings });
        }
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut SingleHitScratch, out: &mut [RegionId]) {
        for (i, region) in out.iter_mut().enumerate() {
            let point = GroupPoint::world(Vec3::new(points[0][i], points[1][i], points[2][i]));
            *region = RegionId(self.value_at(PrototypeId(0), &point, &mut scratch.values));
        }
    }
}

/// Observer of a ray.
pub(super) trait WalkObserver: Observer {
    /// A query of the model for its next change after a time begins.
    fn question(&mut self, _t_min: f64) {}
    /// The query returns.
    fn answer(&mut self, _step: ValueStep) {}
    /// The weld reports a crossing.
    fn crossing(&mut self, _crossing: &Crossing) {}
}

impl WalkObserver for NoObserver {}

/// Converts the changes of a ray to crossings.
struct Welding<'a> {
    program: &'a Program,
    tree: &'a Tree,
    ray: Ray,
    paused: Paused,
    /// The time up to which boundary events have been collected.
    last: Option<f64>,
}

impl Welding<'_> {
    /// Takes the next change of the owner.
    fn step(&mut self, step: ValueStep, level: &mut Level) -> Option<Crossing> {
        let (before, after) = (self.state(step.before), self.state(step.after));
        if before.region == after.region {
            return None;
        }
        let Level { roots, events, turned, .. } = level;
        roots.events(self.last.unwrap_or(step.t.next_down()), step.t, events);
        self.last = Some(step.t);
        let first = events.partition_point(|event| event.t < step.t);
        let change = Change { t: step.t, first, end: events.len(), before, after };
        let mut sides = Sides { tree: self.tree, roots, t: step.t, turned };
        let mut weld = Weld::resume(self.program, self.ray, events, self.paused);
        let crossing = weld.change(change, &mut sides);
        self.paused = weld.pause();
        crossing
    }

    /// The last crossing.
    fn finish(self, level: &mut Level) -> Option<Crossing> {
        let Level { roots, events, turned, .. } = level;
        let mut sides = Sides { tree: self.tree, roots, t: self.last?, turned };
        Weld::resume(self.program, self.ray, events, self.paused).finish(events.len(), &mut sides)
    }

    fn state(&self, region: u32) -> State {
        let region = RegionId(region);
        State { region, medium: self.program.medium_of(region) }
    }
}

/// The time from which the first query starts: just before 0 if the ray starts on surfaces, as these may be
/// crossed at 0.
fn first_t_min(query: &Query<'_>, has_starts: bool) -> f64 {
    match query.window.t_min() {
        t_min if has_starts && t_min <= 0.0 => 0.0f64.next_down(),
        t_min => t_min,
    }
}
