//! For a time t, the side of each leaf on which the ray is; sides can be inverted to find which faces matter.

use super::Tree;
use super::roots::Roots;
use rayweave_model::weld::LeafStates;

/// Memory for [`Sides`].
#[derive(Clone, Debug, Default)]
pub(super) struct Turned {
    /// For each leaf, whether its side is inverted; all false between queries.
    leaves: Vec<bool>,
    values: Vec<u32>,
}

impl Turned {
    /// Memory for groups of at most `leaves` leaves and trees of at most this height.
    pub fn new(leaves: usize, height: u32) -> Turned {
        Turned { leaves: vec![false; leaves], values: Vec::with_capacity(height as usize + 1) }
    }
}

/// The sides of the leaves just after `t`, for the rule of attribution. Every query evaluates the tree.
pub(super) struct Sides<'a> {
    pub tree: &'a Tree,
    pub roots: &'a Roots,
    pub t: f64,
    pub turned: &'a mut Turned,
}

impl Sides<'_> {
    fn value(&mut self, node: usize) -> u32 {
        let Turned { leaves, values } = &mut *self.turned;
        let inside = |leaf: u32, _: &mut Vec<u32>| self.roots.is_inside(leaf, self.t) ^ leaves[leaf as usize];
        self.tree.evaluate(node, inside, values)
    }
}

impl LeafStates for Sides<'_> {
    fn toggle(&mut self, leaf: u32) {
        self.turned.leaves[leaf as usize] ^= true;
    }

    fn owner(&mut self) -> u32 {
        self.value(self.tree.nodes().len() - 1)
    }

    fn output(&mut self, k: u32) -> bool {
        self.value(self.tree.output(k)) != 0
    }
}
