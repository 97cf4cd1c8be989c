//! The memory of a thread that weaves.

use super::nearest::Coming;
use crate::accel::Front;
use rayweave_model::gate::NetworkState;
use rayweave_model::{Crossing, Event, Face, LeafEvents, Program, PrototypeId};
use std::collections::BinaryHeap;

/// Memory of a thread.
#[derive(Clone, Debug, Default)]
pub struct WeaveScratch {
    /// The network state of each group, made when it is first needed; always at rest between rays.
    states: Vec<Option<Box<NetworkState>>>,
    /// Buffers for each level of nesting.
    levels: Vec<Option<Box<Level>>>,
    pub(super) near: Near,
    pub(super) crossings: Vec<Crossing>,
    /// Leaves asked so far.
    pub(super) asked: u64,
}

/// The buffers of one sweep.
#[derive(Clone, Debug, Default)]
pub(super) struct Level {
    pub touched: Vec<u32>,
    pub events: Vec<Event>,
    /// The changes of a placed solid, found one level further in.
    pub inner: Vec<(f64, Face)>,
    pub leaf: LeafEvents,
}

/// The buffers of a sweep that goes with the ray.
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    pub front: Front,
    /// Flips of the leaves asked so far, the first one on top.
    pub coming: BinaryHeap<Coming>,
    /// The latest of all flips found.
    pub latest: f64,
    /// Large placed solids that have been asked about times up to here only.
    pub partly: Vec<Partly>,
}

/// A large placed solid that has been asked about times up to `until`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Partly {
    pub leaf: u32,
    pub until: f64,
    /// How long the next piece of the ray is.
    pub step: f64,
    /// True before the first piece.
    pub is_new: bool,
}

impl WeaveScratch {
    /// How many leaves have been asked for their flips with this scratch.
    pub fn asked(&self) -> u64 {
        self.asked
    }

    /// The buffers for a level of nesting, empty.
    pub(super) fn take_level(&mut self, depth: usize) -> Box<Level> {
        if self.levels.len() <= depth {
            self.levels.resize_with(depth + 1, || None);
        }
        let mut level = self.levels[depth].take().unwrap_or_default();
        level.touched.clear();
        level.events.clear();
        level
    }

    pub(super) fn give_level(&mut self, depth: usize, level: Box<Level>) {
        self.levels[depth] = Some(level);
    }

    pub(super) fn take_state(&mut self, program: &Program, group: PrototypeId) -> Box<NetworkState> {
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
