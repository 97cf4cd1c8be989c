//! Memory of a thread for rays or for points.

use super::level::Level;
use rayweave_model::gate::{NetworkState, OutputSet};
use rayweave_model::{Prototype, PrototypeId};

/// Memory of a thread for columns of one kind.
#[derive(Clone, Debug)]
pub(super) struct ColumnScratch<P> {
    /// Buffers per nesting level: at most 31, as a placed solid has at least two placements.
    pub levels: Vec<Option<Box<Level<P>>>>,
    /// The outputs and leaves of each group, allocated on first use and restored to the initial state after
    /// each column.
    pub initial_states: Vec<Option<Box<InitialState>>>,
}

/// The initial state of a group: that on a column that touches no leaf.
#[derive(Clone, Debug)]
pub(super) struct InitialState {
    pub outputs: OutputSet,
    pub leaves: NetworkState,
}

impl<P> Default for ColumnScratch<P> {
    fn default() -> Self {
        ColumnScratch { levels: Vec::new(), initial_states: Vec::new() }
    }
}

impl<P> ColumnScratch<P> {
    pub fn take_level(&mut self, depth: usize) -> Box<Level<P>> {
        if self.levels.len() <= depth {
            self.levels.resize_with(depth + 1, || None);
        }
        self.levels[depth].take().unwrap_or_default()
    }

    pub fn take_initial_state(&mut self, groups: &[Prototype], group: PrototypeId) -> Box<InitialState> {
        self.initial_states.resize_with(groups.len(), || None);
        self.initial_states[group.index()]
            .take()
            .unwrap_or_else(|| Box::new(InitialState::new(&groups[group.index()])))
    }
}

impl InitialState {
    fn new(group: &Prototype) -> InitialState {
        let mut outputs = OutputSet::new(group.expression.outputs().len());
        for (k, edge) in group.expression.outputs().iter().enumerate() {
            outputs.set(k as u32, edge.is_complemented());
        }
        InitialState { outputs, leaves: group.network.start() }
    }
}
