//! First crossings: leaves are intersected in the order in which the ray enters their boxes, no farther than
//! needed.
//!
//! Boundary events before the *frontier*, the time at which the ray enters the next box, are final. They are
//! swept, and a crossing is reported as soon as no event beyond the frontier can be welded to it. A leaf does
//! not matter before its box; when it is reached, it is set to the side that it has at the position of the
//! sweep.

use super::list::GroupQuery;
use super::scratch::{Partly, TraversalBuffers};
use super::{Level, Weave, WeaveScratch};
use rayweave_model::gate::NetworkState;
use rayweave_model::weld::{Paused, Weld};
use rayweave_model::{
    Crossing, Event, GroupRay, LeafId, LeafKind, PrototypeId, Query, RegionId, Start, State, Sweep, Window,
};
use rayweave_shape::Ray;
use std::cmp::Ordering;

/// A future event; the greatest in this order is the earliest in time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coming(pub Event);

impl Ord for Coming {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.t.total_cmp(&self.0.t).then(other.0.leaf.cmp(&self.0.leaf))
    }
}

impl PartialOrd for Coming {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Coming {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Coming {}

/// Number of leaves above which a placed solid is intersected with one piece of the ray after the other.
const LARGE: usize = 64;

/// Expected number of leaves that the ray touches in the first piece.
const FIRST_PIECE: f64 = 4.0;

/// A walk along a ray up to its first crossing.
struct Walk<'a> {
    weave: &'a Weave,
    ray: GroupRay<'a>,
    query: &'a Query<'a>,
    level: Box<Level>,
    traversal: TraversalBuffers,
    state: Box<NetworkState>,
    /// Time up to which the sweep has advanced.
    swept: f64,
    /// Number of events swept.
    position: usize,
    paused: Paused,
}

impl Weave {
    /// Appends the first crossing of a ray, if there is one. Returns the region at its start.
    pub(super) fn nearest(
        &self,
        ray: Ray,
        query: &Query<'_>,
        starts: &[Start],
        scratch: &mut WeaveScratch,
    ) -> RegionId {
        let mut walk = Walk {
            weave: self,
            ray: GroupRay::world(&self.program, ray, starts),
            query,
            state: scratch.take_state(&self.program, MODEL),
            level: scratch.take_level(0),
            traversal: std::mem::take(&mut scratch.traversal),
            swept: f64::NEG_INFINITY,
            position: 0,
            paused: Paused::default(),
        };
        walk.begin(scratch);
        let mut now = walk.start(scratch);
        let start = now.region;
        let found = walk.first_crossing(&mut now, scratch);
        scratch.crossings.extend(found);
        let Walk { mut state, level, traversal, .. } = walk;
        let network = &self.program.prototype(MODEL).network;
        Sweep::new(network, &mut state, &[], 0.0).restore(level.touched.iter().copied());
        scratch.traversal = traversal;
        scratch.give_state(MODEL, state);
        scratch.give_level(0, level);
        start
    }
}

/// The group of the model itself.
const MODEL: PrototypeId = PrototypeId(0);

impl Walk<'_> {
    /// Intersects the leaves that have no finite box.
    fn begin(&mut self, scratch: &mut WeaveScratch) {
        self.traversal.coming.clear();
        self.traversal.partly.clear();
        self.traversal.latest = f64::NEG_INFINITY;
        let accel = &self.weave.accel[MODEL.index()];
        accel.begin(&self.ray, self.query.window, &mut self.traversal.front);
        for &leaf in accel.unbounded() {
            self.intersect(leaf, self.query.window, scratch);
            self.level.touched.push(leaf);
        }
    }

    /// Advances to the beginning of the window. Returns the state there.
    fn start(&mut self, scratch: &mut WeaveScratch) -> State {
        let has_starts = !self.ray.starts.is_empty();
        let t_min = self.query.window.t_min();
        // events at 0 are not past
        let first = if has_starts { t_min.max(0.0) } else { t_min };
        while self.frontier() <= first {
            self.step(scratch);
        }
        while let Some(&Coming(event)) = self.traversal.coming.peek()
            && self.query.is_past(event.t, has_starts)
        {
            self.traversal.coming.pop();
            self.toggle(event.leaf);
            self.swept = event.t;
        }
        // with start surfaces, leaves found later may have events before t = 0 outside of their boxes
        self.swept = if self.query.is_past(t_min, has_starts) { t_min } else { 0f64.next_down() };
        self.weave.state(self.state.owner())
    }

    /// Sweeps the final events and intersects more leaves until a crossing is found or nothing is left.
    fn first_crossing(&mut self, now: &mut State, scratch: &mut WeaveScratch) -> Option<Crossing> {
        loop {
            let frontier = self.frontier();
            self.take_final(frontier);
            if let Some(found) = self.sweep(now, frontier) {
                return Some(found);
            }
            if frontier >= self.query.window.t_max() || frontier == f64::INFINITY {
                return None;
            }
            self.step(scratch);
        }
    }

    /// Moves the future events before the frontier to the event list.
    fn take_final(&mut self, frontier: f64) {
        while let Some(&Coming(event)) = self.traversal.coming.peek()
            && event.t < frontier
        {
            self.traversal.coming.pop();
            self.level.events.push(event);
        }
    }

    /// Sweeps the events, which are complete up to the frontier. Returns the first crossing if it is certain.
    fn sweep(&mut self, now: &mut State, frontier: f64) -> Option<Crossing> {
        if self.position == self.level.events.len() && self.paused.is_idle() {
            return None;
        }
        let last_event = self.traversal.last_event(frontier);
        let Walk { weave, query, level, state, .. } = self;
        let (program, events, t_max) = (&*weave.program, &level.events, query.window.t_max());
        let network = &program.prototype(MODEL).network;
        let mut sweep = Sweep::resume(network, state, events, self.position, t_max);
        let mut weld = Weld::resume(program, self.ray.ray, events, self.paused);
        while let Some(change) = sweep.next_change(now, |owner| weave.state(owner)) {
            let found = weld.change(change, &mut sweep.leaves);
            if found.is_some() {
                return found;
            }
        }
        self.position = sweep.position();
        self.swept = events[..self.position].last().map_or(self.swept, |event| event.t);
        let last = frontier >= t_max;
        if last || weld.is_resolved((frontier, last_event.min(t_max))) {
            let found = weld.finish(self.position, &mut sweep.leaves);
            if found.is_some() {
                return found;
            }
        }
        self.paused = weld.pause();
        None
    }

    /// Lower bound of the times of all events not found yet.
    fn frontier(&self) -> f64 {
        let partly = self.traversal.partly.iter().map(|partly| partly.until);
        partly.fold(self.traversal.front.time(), f64::min)
    }

    /// Advances the frontier by one step: opens a box or intersects a leaf.
    fn step(&mut self, scratch: &mut WeaveScratch) {
        let time = self.traversal.front.time();
        if let Some(at) = self.traversal.partly.iter().position(|partly| partly.until <= time) {
            let partly = self.traversal.partly.swap_remove(at);
            return self.intersect_piece(partly, scratch);
        }
        let Some(leaf) = self.weave.accel[MODEL.index()].next(&mut self.traversal.front) else {
            return self.weave.read_ahead(MODEL, self.traversal.front.fresh(), &self.state);
        };
        self.level.touched.push(leaf);
        match self.first_piece(leaf) {
            Some(step) => {
                let until = time.max(self.query.window.t_min());
                self.intersect_piece(Partly { leaf, until, step, is_new: true }, scratch);
            }
            None => self.intersect(leaf, self.query.window, scratch),
        }
    }

    /// Length of the first piece of the ray for a leaf; `None` if the leaf is intersected with the whole
    /// window.
    fn first_piece(&self, leaf: u32) -> Option<f64> {
        let program = &self.weave.program;
        let leaf = program.leaf(LeafId(program.prototype(MODEL).leaves.start + leaf));
        let LeafKind::Instance { prototype, .. } = leaf.kind() else { return None };
        let leaves = program.prototype(prototype).leaves.len();
        if leaves <= LARGE {
            return None;
        }
        let size = self.weave.accel[prototype.index()].size();
        let speed = leaf.place().local_from_world.vector(self.ray.ray.direction).length();
        Some(FIRST_PIECE * size / libm::cbrt(leaves as f64) / speed)
    }

    /// Intersects a large placed solid with the next piece of the ray, from its `until` on.
    fn intersect_piece(&mut self, Partly { leaf, until, step, is_new }: Partly, scratch: &mut WeaveScratch) {
        let (end, t_max) = (until + step, self.query.window.t_max());
        let ends = end >= self.traversal.front.end().min(t_max);
        let piece = Window::new(until, end).ok().filter(|_| !ends);
        let Some(window) = piece.or_else(|| Window::new(until, t_max).ok()) else { return };
        let known = self.level.events.len();
        let group_query = GroupQuery { group: MODEL, ray: &self.ray, window, depth: 0 };
        let starts = self.weave.leaf(group_query, leaf, scratch, &mut self.level);
        if is_new && starts {
            self.toggle(leaf);
        }
        self.take_events(known);
        if piece.is_some() {
            self.traversal.partly.push(Partly { leaf, until: end, step: 2.0 * step, is_new: false });
        }
    }

    /// Moves the events from index `known` on to the future events; those already swept past toggle their leaf
    /// at once.
    fn take_events(&mut self, known: usize) {
        for k in known..self.level.events.len() {
            let event = self.level.events[k];
            if event.t <= self.swept {
                self.toggle(event.leaf);
            } else {
                self.traversal.latest = self.traversal.latest.max(event.t);
                self.traversal.coming.push(Coming(event));
            }
        }
        self.level.events.truncate(known);
    }

    /// Intersects a leaf with the ray in a window.
    fn intersect(&mut self, leaf: u32, window: Window, scratch: &mut WeaveScratch) {
        let known = self.level.events.len();
        let group_query = GroupQuery { group: MODEL, ray: &self.ray, window, depth: 0 };
        let starts = self.weave.leaf(group_query, leaf, scratch, &mut self.level);
        if starts != self.state.leaf(leaf) {
            self.toggle(leaf);
        }
        self.take_events(known);
    }

    fn toggle(&mut self, leaf: u32) {
        self.weave.program.prototype(MODEL).network.toggle(&mut self.state, leaf);
    }
}

impl TraversalBuffers {
    /// Upper bound of the times of all events not swept yet; not less than the frontier.
    fn last_event(&self, frontier: f64) -> f64 {
        self.front.end().max(self.latest).max(frontier)
    }
}
