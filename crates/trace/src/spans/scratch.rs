//! Scratch memory of a thread, for ray queries or for point queries.

use super::level::Level;
use rayweave_model::gate::{NetworkState, OutputSet};
use rayweave_model::{Prototype, PrototypeId};

/// Scratch memory of a thread for columns of one kind `P`: rays or points.
#[derive(Clone, Debug)]
pub(super) struct ColumnScratch<P> {
    /// Buffers per nesting level. A placed solid has at least two placements, and a model has fewer than
    /// 2^31, so there are at most 31 levels. `None` before the first use and
    /// while the buffers are taken.
    pub levels: Vec<Option<Box<Level<P>>>>,
    /// The initial state of each group, allocated on first use. The traversal of a column changes it and then
    /// restores it.
    pub initial_states: Vec<Option<Box<InitialState>>>,
}

/// The initial state of a group, in which every leaf is outside.
#[derive(Clone, Debug)]
pub(super) struct InitialState {
    /// The outputs that are inside when all leaves are outside.
    pub outputs: OutputSet,
    /// The sides of the leaves and the values of the gates.
    pub leaves: NetworkState,
}

impl<P> Default for ColumnScratch<P> {
    fn default() -> Self {
        ColumnScratch { levels: Vec::new(), initial_states: Vec::new() }
    }
}

impl<P> ColumnScratch<P> {
    /// Takes the buffers of a nesting level; the caller puts them back.
    pub fn take_level(&mut self, depth: usize) -> Box<Level<P>> {
        if self.levels.len() <= depth {
            self.levels.resize_with(depth + 1, || None);
        }
        self.levels[depth].take().unwrap_or_default()
    }

    /// Takes the initial state of a group; the caller puts it back.
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
