//! A sweep along one ray: toggles leaves in the network of their group, in order of time.

use crate::gate::{Network, NetworkState};
use crate::weld::{Change, LeafStates, attribute};
use crate::{Event, Face, State};

/// A network with its state, as the [`LeafStates`] of a weld.
#[derive(Debug)]
pub struct NetworkLeafStates<'a> {
    network: &'a Network,
    state: &'a mut NetworkState,
}

impl LeafStates for NetworkLeafStates<'_> {
    #[inline]
    fn toggle(&mut self, leaf: u32) {
        self.network.toggle(self.state, leaf);
    }

    #[inline]
    fn owner(&mut self) -> u32 {
        self.state.owner()
    }

    #[inline]
    fn output(&mut self, k: u32) -> bool {
        self.state.output(k)
    }
}

/// A sweep over events, one time per step.
#[derive(Debug)]
pub struct Sweep<'a> {
    /// The network after the events so far.
    pub leaves: NetworkLeafStates<'a>,
    events: &'a [Event],
    position: usize,
    t_max: f64,
}

impl<'a> Sweep<'a> {
    /// A sweep over events sorted by time; stops before `t_max`.
    pub fn new(network: &'a Network, state: &'a mut NetworkState, events: &'a [Event], t_max: f64) -> Self {
        Sweep::resume(network, state, events, 0, t_max)
    }

    /// Continues after the first `position` events, which are already applied to `state`.
    pub fn resume(
        network: &'a Network,
        state: &'a mut NetworkState,
        events: &'a [Event],
        position: usize,
        t_max: f64,
    ) -> Self {
        Sweep { leaves: NetworkLeafStates { network, state }, events, position, t_max }
    }

    /// The number of events so far.
    pub fn position(&self) -> usize {
        self.position
    }

    /// The time of the next step; `None` if there is none.
    #[inline]
    pub fn next_time(&self) -> Option<f64> {
        self.events.get(self.position).map(|event| event.t).filter(|&t| t < self.t_max)
    }

    /// Applies all events of the next time; returns that time and the index of its first event.
    #[inline]
    pub fn step(&mut self) -> Option<(f64, usize)> {
        let t = self.next_time()?;
        let first = self.position;
        while let Some(event) = self.events.get(self.position).filter(|event| event.t == t) {
            self.leaves.toggle(event.leaf);
            self.position += 1;
        }
        Some((t, first))
    }

    /// Steps to the next change of region. `now` is the state before and is updated; `state` maps a winning
    /// output to its state.
    #[inline]
    pub fn next_change(&mut self, now: &mut State, state: impl Fn(u32) -> State) -> Option<Change> {
        loop {
            let (t, first) = self.step()?;
            let after = state(self.leaves.owner());
            let before = std::mem::replace(now, after);
            if before.region != after.region {
                return Some(Change { t, first, end: self.position, before, after });
            }
        }
    }

    /// Steps to the next time at which output 0 differs from `inside`, and inverts `inside`. Returns that
    /// time and the face to which the change belongs. This makes a placed solid one leaf of the group around
    /// it.
    #[inline]
    pub fn next_event(&mut self, inside: &mut bool) -> Option<(f64, Face)> {
        loop {
            let (t, first) = self.step()?;
            if self.leaves.output(0) != *inside {
                *inside = !*inside;
                let end = self.position;
                let output = |leaves: &mut NetworkLeafStates<'_>| u32::from(leaves.output(0));
                return Some((t, attribute(self.events, first..end, end, &mut self.leaves, output)));
            }
        }
    }

    /// Resets the leaves that may have changed to their initial side, outside.
    pub fn restore(self, touched: impl IntoIterator<Item = u32>) {
        let NetworkLeafStates { network, state } = self.leaves;
        for leaf in touched {
            if state.leaf(leaf) {
                network.toggle(state, leaf);
            }
        }
    }
}
