//! The sides of all leaves at a time, computed only where several faces compete for a crossing.

use rayweave_model::Event;
use rayweave_model::gate::{Network, NetworkState};
use rayweave_model::weld::LeafStates;
use std::ops::Range;

/// The leaves of a group just after some events, in a network that is updated lazily.
///
/// Hit arrays give the times at which the solid changes, and nearly every change has one boundary event,
/// whose face needs no network. So most rays never update it.
pub(super) struct Sides<'a> {
    network: &'a Network,
    state: &'a mut NetworkState,
    /// All events of a column; those at t = -inf, which mark leaves that are inside from the start, come
    /// first.
    events: &'a [Event],
    /// Number of events that the state includes.
    done: usize,
    /// Number of events that the state must include when it is read.
    meant: usize,
}

impl Sides<'_> {
    /// Restores the inverted leaves to the initial side, outside.
    pub fn restore(self) {
        for event in &self.events[..self.done] {
            if self.state.leaf(event.leaf) {
                self.network.toggle(self.state, event.leaf);
            }
        }
    }

    fn catch_up(&mut self) {
        for event in &self.events[self.done..self.meant] {
            self.network.toggle(self.state, event.leaf);
        }
        self.done = self.meant;
    }
}

impl LeafStates for Sides<'_> {
    fn toggle(&mut self, leaf: u32) {
        self.catch_up();
        self.network.toggle(self.state, leaf);
    }

    fn owner(&mut self) -> u32 {
        self.catch_up();
        self.state.owner()
    }

    fn output(&mut self, k: u32) -> bool {
        self.catch_up();
        self.state.output(k)
    }
}

/// The events of a column, processed in order of time.
pub(super) struct Sweep<'a> {
    pub sides: Sides<'a>,
    /// Number of events that mark leaves inside from the start.
    unbounded: usize,
}

impl<'a> Sweep<'a> {
    /// A sweep over the events of a column, sorted by time; in `state` every leaf is outside.
    pub fn new(network: &'a Network, state: &'a mut NetworkState, events: &'a [Event]) -> Self {
        let unbounded = events.partition_point(|event| event.t == f64::NEG_INFINITY);
        Sweep { sides: Sides { network, state, events, done: 0, meant: unbounded }, unbounded }
    }

    /// The events after t = -inf.
    pub fn events(&self) -> &'a [Event] {
        &self.sides.events[self.unbounded..]
    }

    /// The number of these events that have been passed.
    pub fn position(&self) -> usize {
        self.sides.meant - self.unbounded
    }

    /// Passes all events up to and including those at `t`. Returns the range of those at `t`.
    pub fn go(&mut self, t: f64) -> Range<usize> {
        let (events, position) = (self.events(), self.position());
        let first = position + events[position..].iter().take_while(|event| event.t < t).count();
        let end = first + events[first..].iter().take_while(|event| event.t == t).count();
        self.sides.meant = self.unbounded + end;
        first..end
    }
}
