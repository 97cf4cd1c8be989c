//! The sides of all leaves at a time: asked for only where several faces compete for a crossing.

use rayweave_model::Event;
use rayweave_model::gate::{Network, NetworkState};
use rayweave_model::weld::Flips;
use std::ops::Range;

/// The leaves of a group just after some events, from a network that follows them only when somebody looks.
///
/// Hit arrays say when the solid changes, and nearly every change has one flip alone, which needs no more. So most rays never
/// come here.
pub(super) struct Sides<'a> {
    network: &'a Network,
    state: &'a mut NetworkState,
    /// All events of a column; those at t = -inf, which stand for leaves that are inside from the start, come first.
    events: &'a [Event],
    /// How many of them the state has followed.
    done: usize,
    /// How many of them are meant to have happened.
    meant: usize,
}

impl Sides<'_> {
    /// Puts the leaves that were flipped back to rest, that is outside.
    pub fn rest(self) {
        for event in &self.events[..self.done] {
            if self.state.leaf(event.leaf) {
                self.network.flip(self.state, event.leaf);
            }
        }
    }

    fn catch_up(&mut self) {
        for event in &self.events[self.done..self.meant] {
            self.network.flip(self.state, event.leaf);
        }
        self.done = self.meant;
    }
}

impl Flips for Sides<'_> {
    fn flip(&mut self, leaf: u32) {
        self.catch_up();
        self.network.flip(self.state, leaf);
    }

    fn winner(&mut self) -> u32 {
        self.catch_up();
        self.state.winner()
    }

    fn output(&mut self, k: u32) -> bool {
        self.catch_up();
        self.state.output(k)
    }
}

/// The events of a column, passed in order of time.
pub(super) struct Sweep<'a> {
    pub sides: Sides<'a>,
    /// How many events stand for leaves that are inside from the start.
    unbounded: usize,
}

impl<'a> Sweep<'a> {
    /// With the events of a column sorted by time; `state` is at rest, every leaf outside.
    pub fn new(network: &'a Network, state: &'a mut NetworkState, events: &'a [Event]) -> Self {
        let unbounded = events.partition_point(|event| event.t == f64::NEG_INFINITY);
        Sweep { sides: Sides { network, state, events, done: 0, meant: unbounded }, unbounded }
    }

    /// The events after t = -inf.
    pub fn events(&self) -> &'a [Event] {
        &self.sides.events[self.unbounded..]
    }

    /// The number of events passed.
    pub fn position(&self) -> usize {
        self.sides.meant - self.unbounded
    }

    /// Passes all events up to and including those at `t`; which these last ones are.
    pub fn go(&mut self, t: f64) -> Range<usize> {
        let (events, position) = (self.events(), self.position());
        let first = position + events[position..].iter().take_while(|event| event.t < t).count();
        let end = first + events[first..].iter().take_while(|event| event.t == t).count();
        self.sides.meant = self.unbounded + end;
        first..end
    }
}
