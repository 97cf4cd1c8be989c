//! Scratch memory of [`super::Weave`].

use super::nearest::Coming;
use rayweave_bvh::FrontToBack;
use rayweave_model::gate::NetworkState;
use rayweave_model::{Crossing, Event, Face, LeafEvents, Program, PrototypeId};
use std::collections::BinaryHeap;

/// Scratch memory of a thread for [`super::Weave`].
#[derive(Clone, Debug, Default)]
pub struct WeaveScratch {
    /// The network state of each group, allocated on first use; between rays every state is the initial one.
    states: Vec<Option<Box<NetworkState>>>,
    /// Buffers per nesting level.
    levels: Vec<Option<Box<Level>>>,
    pub(super) traversal: TraversalBuffers,
    pub(crate) crossings: Vec<Crossing>,
    /// Number of leaves intersected so far.
    pub(super) intersected_leaves: u64,
}

/// The buffers of one sweep.
#[derive(Clone, Debug, Default)]
pub(crate) struct Level {
    pub touched: Vec<u32>,
    pub events: Vec<Event>,
    /// The changes of a placed solid, from the next nesting level.
    pub inner: Vec<(f64, Face)>,
    pub leaf: LeafEvents,
}

impl Level {
    /// Sorts the events by time, and those at one time by leaf.
    pub fn sort(&mut self) {
        self.events.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.leaf.cmp(&b.leaf)));
    }
}

/// The buffers of a front-to-back sweep.
#[derive(Clone, Debug, Default)]
pub(super) struct TraversalBuffers {
    pub front: FrontToBack,
    /// Future boundary events of the leaves intersected so far, the earliest on top.
    pub coming: BinaryHeap<Coming>,
    /// The latest time of all boundary events found.
    pub latest: f64,
    /// Large placed solids intersected only up to some time.
    pub partly: Vec<Partly>,
}

/// A large placed solid intersected with the ray up to time `until`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Partly {
    pub leaf: u32,
    pub until: f64,
    /// Length of the next piece of the ray.
    pub step: f64,
    /// True before the first piece.
    pub is_new: bool,
}

impl WeaveScratch {
    /// Number of leaves intersected with this scratch, for its whole lifetime.
    pub fn intersected_leaves(&self) -> u64 {
        self.intersected_leaves
    }

    /// Empty buffers for a nesting level.
    pub(crate) fn take_level(&mut self, depth: usize) -> Box<Level> {
        if self.levels.len() <= depth {
            self.levels.resize_with(depth + 1, || None);
        }
        let mut level = self.levels[depth].take().unwrap_or_default();
        level.touched.clear();
        level.events.clear();
        level
    }

    pub(crate) fn give_level(&mut self, depth: usize, level: Box<Level>) {
        self.levels[depth] = Some(level);
    }

    pub(crate) fn take_state(&mut self, program: &Program, group: PrototypeId) -> Box<NetworkState> {
        if self.states.is_empty() {
            self.states.resize_with(program.prototypes().len(), || None);
        }
        let taken = self.states[group.index()].take();
        taken.unwrap_or_else(|| Box::new(program.prototype(group).network.start()))
    }

    pub(super) fn give_state(&mut self, group: PrototypeId, state: Box<NetworkState>) {
        self.states[group.index()] = Some(state);
    }
}
