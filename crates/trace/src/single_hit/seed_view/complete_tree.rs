//! Complete binary trees in level order, with navigation by the bits of a node's number.

use super::Operator;
use crate::single_hit::{GateOp, Tree, TreeNodeKind};
use std::ops::Range;

/// Largest height that [`CompleteTree::view`] accepts: 2^21 - 1 slots.
const MAX_HEIGHT: u32 = 20;

/// The content of a slot of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// Nothing: the tree is not perfect.
    Empty,
    /// A leaf.
    Leaf {
        /// Its number.
        leaf: u32,
        /// True if it is complemented.
        complemented: bool,
    },
    /// An operator on its two children.
    Operator(Operator),
}

/// A complete binary tree. Nodes are numbered in level order from 1, the root: the children of i are 2i and
/// 2i + 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompleteTree {
    height: u32,
    /// Node i is slot i - 1.
    slots: Vec<Slot>,
}

impl CompleteTree {
    /// A tree of one leaf.
    pub fn leaf(leaf: u32, complemented: bool) -> CompleteTree {
        CompleteTree { height: 0, slots: vec![Slot::Leaf { leaf, complemented }] }
    }

    /// Joins two trees below an operator. The number of slots doubles with every level: for small trees only.
    pub fn join(operator: Operator, first: &CompleteTree, second: &CompleteTree) -> CompleteTree {
        let height = 1 + first.height.max(second.height);
        let mut slots = vec![Slot::Empty; (2usize << height) - 1];
        slots[0] = Slot::Operator(operator);
        for (tree, side) in [(first, 1), (second, 2)] {
            for (k, &slot) in tree.slots.iter().enumerate() {
                // number i of level l, which begins with 2^l, moves to level l + 1
                let number = k + 1;
                slots[number + (side << number.ilog2()) - 1] = slot;
            }
        }
        CompleteTree { height, slots }
    }

    /// A tree of the evaluator in positive form: unions and intersections only, complements at the leaves (De
    /// Morgan).
    ///
    /// Returns `None` for nodes that the original does not support (symmetric differences, k of n, constants,
    /// several regions), and for more than 20 levels.
    pub fn view(tree: &Tree) -> Option<CompleteTree> {
        let complemented = pushed_down(tree);
        let mut done: Vec<CompleteTree> = Vec::new();
        for (node, &complemented) in tree.nodes().iter().zip(&complemented) {
            let operator = match node.kind {
                TreeNodeKind::Leaf(leaf) => {
                    done.push(CompleteTree::leaf(leaf, complemented));
                    continue;
                }
                TreeNodeKind::Gate(GateOp::AtLeast { least: 1, most: [1, 1] }) => {
                    [Operator::Union, Operator::Intersection]
                }
                TreeNodeKind::Gate(GateOp::AtLeast { least: 2, most: [1, 1] }) => {
                    [Operator::Intersection, Operator::Union]
                }
                _ => return None,
            };
            let (second, first) = (done.pop()?, done.pop()?);
            if first.height.max(second.height) >= MAX_HEIGHT {
                return None;
            }
            done.push(CompleteTree::join(operator[usize::from(complemented)], &first, &second));
        }
        done.pop()
    }

    /// The number of levels below the root.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The number of slots, empty ones included.
    pub fn slots(&self) -> &[Slot] {
        &self.slots
    }

    /// The content of node `i`; empty for any number that is not in the tree.
    pub fn get(&self, i: u32) -> Slot {
        (i as usize).checked_sub(1).and_then(|k| self.slots.get(k)).copied().unwrap_or(Slot::Empty)
    }

    /// The number of levels between a node and the lowest one.
    pub fn elevation(&self, i: u32) -> u32 {
        self.height.saturating_sub(i.max(1).ilog2())
    }

    /// The first node of the post-order: the leftmost of the lowest level.
    pub fn first(&self) -> u32 {
        1 << self.height
    }

    /// The node after `i` in post-order; 0 after the root.
    ///
    /// A right child (odd) is followed by its parent; a left one by the leftmost descendant of its sibling on
    /// the lowest level, `(i + 1) << e`.
    pub fn next(&self, i: u32) -> u32 {
        let e = self.elevation(i);
        if i & 1 == 1 { i >> 1 } else { (i << e) + (1 << e) }
    }

    /// The slice of the post-order that is the first sub-tree of an operator: from its first node to one past
    /// its last, which is the first node of the second sub-tree; 0..0 for nodes without children.
    pub fn left_slice(&self, i: u32) -> Range<u32> {
        self.halves(i).map_or(0..0, |[first, second]| first..second)
    }

    /// The slice of the post-order that is the second sub-tree; the operator itself comes next.
    pub fn right_slice(&self, i: u32) -> Range<u32> {
        self.halves(i).map_or(0..0, |[_, second]| second..i)
    }

    /// The first nodes of both sub-trees of a node; `None` on the lowest level and outside of the tree.
    fn halves(&self, i: u32) -> Option<[u32; 2]> {
        let inner = i > 0 && i < self.first();
        inner.then(|| [2 * i, 2 * i + 1].map(|child| child << self.elevation(child)))
    }

    /// All nodes in post-order.
    pub fn post_order(&self) -> impl Iterator<Item = u32> + '_ {
        std::iter::successors(Some(self.first()), |&i| Some(self.next(i)).filter(|&i| i != 0))
    }
}

/// For each node, whether it is complemented once complements are pushed down to the leaves.
fn pushed_down(tree: &Tree) -> Vec<bool> {
    let nodes = tree.nodes();
    let mut complemented: Vec<bool> = nodes.iter().map(|node| node.complemented).collect();
    for (gate, node) in nodes.iter().enumerate().rev() {
        if let TreeNodeKind::Gate(_) = node.kind {
            for operand in tree.operands(gate) {
                complemented[operand] ^= complemented[gate];
            }
        }
    }
    complemented
}
