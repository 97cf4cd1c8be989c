//! Networks of deep trees: heavy-path decomposition with a segment tree on each path.
//!
//! The *heavy* operand of a gate is the one with the most leaves below it. The heavy edges divide the tree into
//! paths, each of which starts at a leaf or at a gate without a heavy operand, and the way from any node to the
//! root passes through at most 1 + log2 n of them, if no inner gate feeds an output (Sleator & Tarjan, "A data structure for dynamic trees", 1983).
//! For fixed values of its other operands a gate is one of four functions of its heavy operand: constant 0,
//! constant 1, identity, complement. A segment tree composes the functions of a path, so that a change costs
//! O(log n) per path.

use super::{Network, NetworkState};
use crate::Rule;

/// A function of one boolean: bit 0 is its value at false, bit 1 at true.
type Function = u8;

const IDENTITY: Function = 0b10;

fn apply(f: Function, x: bool) -> bool {
    f >> u8::from(x) & 1 == 1
}

/// `outer(inner(x))`.
fn compose(inner: Function, outer: Function) -> Function {
    u8::from(apply(outer, apply(inner, false))) | u8::from(apply(outer, apply(inner, true))) << 1
}

/// The paths of a tree; constant along a ray.
#[derive(Clone, Debug)]
pub(super) struct HeavyPaths {
    /// The path of each node (leaves and gates).
    path_of: Vec<u32>,
    /// The position of each gate in its path, counted from the bottom; gates only.
    place_of: Vec<u32>,
    /// The heavy operand of each gate and whether it is complemented; `NONE` if the gate has none.
    heavy: Vec<(u32, bool)>,
    paths: Vec<Path>,
}

/// No node.
const NONE: u32 = u32::MAX;

#[derive(Clone, Debug)]
struct Path {
    /// Index of the path's segment tree in `HeavyPathsState::trees`.
    tree: u32,
    /// The number of leaves of the segment tree, a power of two.
    width: u32,
    /// The leaf at the bottom, or `NONE` if the path begins with a gate without heavy operand.
    bottom: u32,
    top: u32,
}

/// The state along a ray: the segment trees and the value at the top of each path. (For networks that are not
/// trees: the current value of each gate.)
#[derive(Clone, Debug, Default)]
pub(super) struct HeavyPathsState {
    trees: Vec<Function>,
    values: Vec<bool>,
}

impl HeavyPathsState {
    pub fn gate_values(values: &[bool]) -> HeavyPathsState {
        HeavyPathsState { trees: Vec::new(), values: values.to_vec() }
    }

    pub fn bytes(&self) -> usize {
        size_of_val(&self.trees[..]) + size_of_val(&self.values[..])
    }

    /// Stores the value of a gate or path; true if it has changed.
    pub fn changed(&mut self, index: usize, value: bool) -> bool {
        std::mem::replace(&mut self.values[index], value) != value
    }
}

impl HeavyPaths {
    /// Computes the paths and their initial state. `counts` and `values` are those of the network with every
    /// leaf outside; on return `counts` excludes the heavy operands.
    pub fn new(network: &Network, counts: &mut [u32], values: &[bool]) -> (HeavyPaths, HeavyPathsState) {
        let leaves = network.leaf_count as usize;
        let mut this = HeavyPaths {
            path_of: vec![0; leaves + counts.len()],
            place_of: vec![0; counts.len()],
            heavy: heavy_operands(network),
            paths: Vec::new(),
        };
        let mut length = Vec::new();
        for node in 0..leaves + counts.len() {
            let gate = node.checked_sub(leaves);
            let path = match gate.map(|gate| this.heavy[gate].0) {
                Some(below) if below != NONE => this.path_of[below as usize],
                _ => {
                    let bottom = if gate.is_none() { node as u32 } else { NONE };
                    this.paths.push(Path { tree: 0, width: 0, bottom, top: NONE });
                    length.push(0u32);
                    (this.paths.len() - 1) as u32
                }
            };
            this.path_of[node] = path;
            this.paths[path as usize].top = node as u32;
            if let Some(gate) = gate {
                this.place_of[gate] = length[path as usize];
                length[path as usize] += 1;
            }
        }
        let size = this.lay_trees(&length);
        let state = this.first_state(network, counts, values, size);
        (this, state)
    }

    pub fn bytes(&self) -> usize {
        size_of_val(&self.path_of[..])
            + size_of_val(&self.place_of[..])
            + size_of_val(&self.heavy[..])
            + size_of_val(&self.paths[..])
    }

    fn lay_trees(&mut self, length: &[u32]) -> usize {
        let mut next = 0;
        for (path, &length) in self.paths.iter_mut().zip(length) {
            path.tree = next;
            path.width = length.max(1).next_power_of_two();
            next += 2 * path.width;
        }
        next as usize
    }

    fn first_state(
        &self,
        network: &Network,
        counts: &mut [u32],
        values: &[bool],
        size: usize,
    ) -> HeavyPathsState {
        let mut trees = vec![IDENTITY; size];
        for gate in 0..counts.len() {
            let (below, complemented) = self.heavy[gate];
            if below != NONE {
                counts[gate] -= u32::from(values[below as usize] ^ complemented);
            }
            let path = &self.paths[self.path_of[network.leaf_count as usize + gate] as usize];
            let slot = path.tree + path.width + self.place_of[gate];
            trees[slot as usize] = self.function(network, gate, counts[gate]);
        }
        for path in &self.paths {
            for k in (1..path.width).rev() {
                let at = |k: u32| trees[(path.tree + k) as usize];
                trees[(path.tree + k) as usize] = compose(at(2 * k), at(2 * k + 1));
            }
        }
        let values = self.paths.iter().map(|path| values[path.top as usize]).collect();
        HeavyPathsState { trees, values }
    }

    /// A gate as a function of its heavy operand, with `light` of the other operands inside.
    fn function(&self, network: &Network, gate: usize, light: u32) -> Function {
        let rule: Rule = network.rules[gate];
        let alone = rule.holds(light);
        let (below, complemented) = self.heavy[gate];
        let joined = if below == NONE { alone } else { rule.holds(light + 1) };
        let plain = u8::from(alone) | u8::from(joined) << 1;
        if complemented { compose(0b01, plain) } else { plain }
    }

    /// Propagates the change of a leaf, already inverted in the state: updates the value of its path, then of the paths above, as
    /// long as values change.
    pub fn toggle(&self, network: &Network, state: &mut NetworkState, leaf: u32) {
        let mut path = self.path_of[leaf as usize];
        loop {
            let this = &self.paths[path as usize];
            let function = state.heavy.trees[(this.tree + 1) as usize];
            let value = apply(function, this.bottom != NONE && state.leaves[this.bottom as usize]);
            if !state.heavy.changed(path as usize, value) {
                return;
            }
            network.feed(&mut state.output_set, this.top, value);
            let &[user] = network.users_of(this.top) else {
                return;
            };
            match self.count_light(network, state, user, value) {
                Some(above) => path = above,
                None => return,
            }
        }
    }

    /// Updates the count of the gate above the top of a path, and the path of that gate, which it returns; `None` if the path as a
    /// function of its bottom stays the same. Most changes end here, such as those of an operand of a union with another one inside.
    fn count_light(
        &self,
        network: &Network,
        state: &mut NetworkState,
        user: u32,
        inside: bool,
    ) -> Option<u32> {
        let gate = ((user >> 1) - network.leaf_count) as usize;
        let path = self.path_of[(user >> 1) as usize];
        let light = &mut state.counts[gate];
        *light = if inside ^ (user & 1 == 1) { *light + 1 } else { *light - 1 };
        let function = self.function(network, gate, *light);
        let this = &self.paths[path as usize];
        let tree = &mut state.heavy.trees[this.tree as usize..][..2 * this.width as usize];
        let mut k = (this.width + self.place_of[gate]) as usize;
        let mut function = function;
        while std::mem::replace(&mut tree[k], function) != function {
            if k == 1 {
                return Some(path);
            }
            k /= 2;
            function = compose(tree[2 * k], tree[2 * k + 1]);
        }
        None
    }
}

/// For each gate the operand with most leaves below, as (node, complemented). A node that feeds an output is
/// never heavy, so that its value is always that of the top of a path.
fn heavy_operands(network: &Network) -> Vec<(u32, bool)> {
    let leaves = network.leaf_count as usize;
    let mut size = vec![1u32; leaves];
    size.resize(leaves + network.rules.len(), 0);
    let mut heavy = vec![(NONE, false); network.rules.len()];
    let mut best = vec![0u32; network.rules.len()];
    for node in 0..size.len() {
        let &[user] = network.users_of(node as u32) else {
            continue;
        };
        let gate = (user >> 1) as usize - leaves;
        size[gate + leaves] += size[node];
        if size[node] > best[gate] && !network.feeds.any(node as u32) {
            (best[gate], heavy[gate]) = (size[node], (node as u32, user & 1 == 1));
        }
    }
    heavy
}
