//! The weave: gather the flips of the leaves that a ray can touch, sort them once, sweep.
//!
//! For each ray the leaves whose bounds it passes give their flips; these are sorted by time and run through
//! the boolean network of the group, which tells after each flip what has changed. Only the leaves touched
//! are put back afterwards, so a ray costs what it meets and not what the model holds. A placed solid is one
//! leaf of the group around it, whose flips come from a sweep of its own group in its own frame.

use crate::accel::Accel;
use rayweave_math::Vec3;
use rayweave_model::gate::NetworkState;
use rayweave_model::weld::{Flips, Weld};
use rayweave_model::{
    Crossing, Evaluator, Event, Face, GroupPoint, GroupRay, LeafEvents, LeafId, LeafKind, Limit, Program,
    PrototypeId, Query, RayAnswer, Rays, RegionId, Sink, Start, State, Sweep, Window, facets_contain,
    leaf_events,
};
use rayweave_shape::Ray;
use std::sync::Arc;

/// The evaluator for daily use.
#[derive(Clone, Debug)]
pub struct Weave {
    program: Arc<Program>,
    /// A hierarchy over the leaves of each group.
    accel: Vec<Accel>,
}

/// Memory of a thread.
#[derive(Clone, Debug, Default)]
pub struct WeaveScratch {
    /// The network state of each group, made when it is first needed; always at rest between rays.
    states: Vec<Option<Box<NetworkState>>>,
    /// Buffers for each level of nesting.
    levels: Vec<Option<Box<Level>>>,
    crossings: Vec<Crossing>,
    /// Leaves asked so far.
    asked: u64,
}

/// The buffers of one sweep.
#[derive(Clone, Debug, Default)]
struct Level {
    touched: Vec<u32>,
    events: Vec<Event>,
    /// The changes of a placed solid, found one level further in.
    inner: Vec<(f64, Face)>,
    leaf: LeafEvents,
}

impl Weave {
    /// An evaluator of a compiled model.
    pub fn new(program: Arc<Program>) -> Weave {
        let accel = program.prototypes().iter().map(|group| Accel::new(&program, group)).collect();
        Weave { program, accel }
    }

    /// What the hierarchies over the leaves take.
    pub fn hierarchy_bytes(&self) -> usize {
        self.accel.iter().map(Accel::bytes).sum()
    }

    /// Gathers the flips of the leaves of a group that the ray can touch in the window, sorted by time, and
    /// flips in `state` the leaves that are inside from the start.
    fn gather(
        &self,
        group: PrototypeId,
        ray: &GroupRay<'_>,
        window: Window,
        depth: usize,
        scratch: &mut WeaveScratch,
        state: &mut NetworkState,
    ) -> Box<Level> {
        let mut level = scratch.take_level(depth);
        level.events.clear();
        level.touched.clear();
        self.accel[group.index()].touched(ray, window, &mut level.touched);
        scratch.asked += level.touched.len() as u64;
        let prototype = self.program.prototype(group);
        for k in 0..level.touched.len() {
            let leaf = level.touched[k];
            let id = LeafId(prototype.leaves.start + leaf);
            let starts_inside = match &self.program.leaf(id).kind {
                LeafKind::Shape { facets, .. } => self.shape(id, leaf, facets, ray, &mut level),
                LeafKind::Instance { prototype, placement } => {
                    let place = &self.program.leaf(id).transform;
                    let local = ray.placed(place, self.program.prototype(*prototype), *placement);
                    level.inner.clear();
                    let starts = self.instance(*prototype, &local, depth + 1, scratch, &mut level.inner);
                    level.events.extend(level.inner.iter().map(|&(t, face)| Event { t, leaf, face }));
                    starts
                }
            };
            if starts_inside {
                prototype.network.flip(state, leaf);
            }
        }
        level.events.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.leaf.cmp(&b.leaf)));
        level
    }

    /// The flips of a leaf that is a shape; true if it is inside from the start.
    fn shape(
        &self,
        id: LeafId,
        leaf: u32,
        facets: &std::ops::Range<u32>,
        ray: &GroupRay<'_>,
        level: &mut Level,
    ) -> bool {
        let table = &self.program.facets()[facets.start as usize..facets.end as usize];
        leaf_events(&self.program, table, ray, &mut level.leaf);
        level.events.extend(level.leaf.flips.iter().map(|&(t, facet)| {
            let surface = table[facet as usize].surface;
            Event { t, leaf, face: Face { leaf: id, facet, surface, placement: ray.placement } }
        }));
        level.leaf.starts_inside
    }

    /// The changes of a placed solid, as flips of one leaf; true if it is inside from the start.
    fn instance(
        &self,
        group: PrototypeId,
        ray: &GroupRay<'_>,
        depth: usize,
        scratch: &mut WeaveScratch,
        out: &mut Vec<(f64, Face)>,
    ) -> bool {
        let prototype = self.program.prototype(group);
        let mut state = self.take_state(group, scratch);
        let level = self.gather(group, ray, Window::ALL, depth, scratch, &mut state);
        let starts_inside = state.output(0);
        let mut sweep = Sweep::new(&prototype.network, &mut state, &level.events, f64::INFINITY);
        let mut inside = starts_inside;
        out.extend(std::iter::from_fn(|| sweep.next_flip(&mut inside)));
        sweep.rest(level.touched.iter().copied());
        scratch.give_back(group, state, depth, level);
        starts_inside
    }

    fn take_state(&self, group: PrototypeId, scratch: &mut WeaveScratch) -> Box<NetworkState> {
        scratch.states.resize_with(self.program.prototypes().len(), || None);
        scratch.states[group.index()]
            .take()
            .unwrap_or_else(|| Box::new(self.program.prototype(group).network.start()))
    }

    fn one_ray(&self, ray: Ray, query: &Query<'_>, starts: &[Start], scratch: &mut WeaveScratch) -> RegionId {
        let group = PrototypeId(0);
        let prototype = self.program.prototype(group);
        let seen = GroupRay::world(&self.program, ray, starts);
        let mut state = self.take_state(group, scratch);
        let level = self.gather(group, &seen, query.window, 0, scratch, &mut state);
        let mut sweep = Sweep::new(&prototype.network, &mut state, &level.events, query.window.t_max());
        let start =
            self.sweep(ray, query, &level.events, &mut sweep, !starts.is_empty(), &mut scratch.crossings);
        sweep.rest(level.touched.iter().copied());
        scratch.give_back(group, state, 0, level);
        start
    }

    /// Runs the events of the model through its network and the changes of region through the weld.
    fn sweep(
        &self,
        ray: Ray,
        query: &Query<'_>,
        events: &[Event],
        sweep: &mut Sweep<'_>,
        has_starts: bool,
        out: &mut Vec<Crossing>,
    ) -> RegionId {
        while sweep.next_time().is_some_and(|t| query.is_past(t, has_starts)) {
            sweep.step();
        }
        let mut now = self.state(sweep.flips.winner());
        let start = now.region;
        let mut weld = Weld::new(&self.program, ray, events);
        while let Some(change) = sweep.next_change(&mut now, |winner| self.state(winner)) {
            if let Some(crossing) = weld.change(change, &mut sweep.flips) {
                out.push(crossing);
                if query.limit == Limit::First {
                    return start;
                }
            }
        }
        out.extend(weld.finish(sweep.position(), &mut sweep.flips));
        start
    }

    fn state(&self, winner: u32) -> State {
        let region = RegionId(winner);
        State { region, medium: self.program.medium_of(region) }
    }

    /// Flips the leaves of a group that hold a point, and returns them so that they can be flipped back.
    fn flip_containing(
        &self,
        group: PrototypeId,
        point: &GroupPoint,
        depth: usize,
        scratch: &mut WeaveScratch,
        state: &mut NetworkState,
    ) -> Box<Level> {
        let mut level = scratch.take_level(depth);
        level.touched.clear();
        let prototype = self.program.prototype(group);
        self.accel[group.index()].around(point, &mut level.touched);
        let holds = |leaf: u32, scratch: &mut WeaveScratch| {
            let leaf = self.program.leaf(LeafId(prototype.leaves.start + leaf));
            match &leaf.kind {
                LeafKind::Shape { facets, .. } => {
                    let table = &self.program.facets()[facets.start as usize..facets.end as usize];
                    facets_contain(&self.program, table, point)
                }
                LeafKind::Instance { prototype, .. } => {
                    self.instance_holds(*prototype, &point.placed(&leaf.transform), depth + 1, scratch)
                }
            }
        };
        level.touched.retain(|&leaf| holds(leaf, scratch));
        level.touched.iter().for_each(|&leaf| prototype.network.flip(state, leaf));
        level
    }

    fn instance_holds(
        &self,
        group: PrototypeId,
        point: &GroupPoint,
        depth: usize,
        scratch: &mut WeaveScratch,
    ) -> bool {
        let mut state = self.take_state(group, scratch);
        let level = self.flip_containing(group, point, depth, scratch, &mut state);
        let inside = state.output(0);
        let network = &self.program.prototype(group).network;
        level.touched.iter().for_each(|&leaf| network.flip(&mut state, leaf));
        scratch.give_back(group, state, depth, level);
        inside
    }
}

impl Evaluator for Weave {
    type Scratch = WeaveScratch;

    fn name(&self) -> &'static str {
        "weave"
    }

    fn program(&self) -> &Program {
        &self.program
    }

    fn scratch(&self) -> WeaveScratch {
        WeaveScratch::default()
    }

    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>, scratch: &mut WeaveScratch, sink: &mut dyn Sink) {
        for i in 0..rays.len() {
            let starts = query.starts.map_or(&[][..], |lists| lists.of(i));
            scratch.crossings.clear();
            let start = self.one_ray(rays.get(i), query, starts, scratch);
            sink.ray(RayAnswer { ray: i, start, crossings: &scratch.crossings });
        }
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut WeaveScratch, out: &mut [RegionId]) {
        let group = PrototypeId(0);
        let network = &self.program.prototype(group).network;
        let mut state = self.take_state(group, scratch);
        for (i, region) in out.iter_mut().enumerate() {
            let point = Vec3::new(points[0][i], points[1][i], points[2][i]);
            let level = self.flip_containing(group, &GroupPoint::world(point), 0, scratch, &mut state);
            *region = RegionId(state.winner());
            level.touched.iter().for_each(|&leaf| network.flip(&mut state, leaf));
            scratch.levels[0] = Some(level);
        }
        scratch.states[group.index()] = Some(state);
    }
}

impl WeaveScratch {
    /// How many leaves have been asked for their flips with this scratch.
    pub fn asked(&self) -> u64 {
        self.asked
    }

    fn take_level(&mut self, depth: usize) -> Box<Level> {
        if self.levels.len() <= depth {
            self.levels.resize_with(depth + 1, || None);
        }
        self.levels[depth].take().unwrap_or_default()
    }

    fn give_back(&mut self, group: PrototypeId, state: Box<NetworkState>, depth: usize, level: Box<Level>) {
        self.states[group.index()] = Some(state);
        self.levels[depth] = Some(level);
    }
}
