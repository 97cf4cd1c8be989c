//! Sharing of equal sub-formulas (common subexpression elimination).

use super::fold::{Folded, fold_join};
use super::formula::{Formula, Renumbered, Term};
use crate::name_map::NameState;
use crate::number_map::NumberMap;
use crate::{Edge, LeafId, NodeId};
use std::hash::BuildHasher;

/// Stores equal sub-formulas once; keeps the value.
///
/// Value numbering from the leaves upwards (hash-consing: Ershov, 1958). Where operands turn out to be equal,
/// the rules of [`fold`](super::fold()) are applied again.
pub fn share(formula: &Formula) -> Formula {
    let uses = formula.uses();
    let mut shared = Shared { out: Formula::like(formula), ..Shared::default() };
    let mut to = Renumbered::new(formula);
    let mut operands = Vec::new();
    for (node, term, all) in formula.nodes() {
        let tag = formula.tag(node);
        match term {
            _ if uses[node.index()] == 0 => {}
            Term::Empty | Term::Universe => {}
            Term::Leaf(leaf) => to.set(node, shared.leaf(leaf, tag)),
            Term::Join(op) => {
                operands.clear();
                operands.extend(all.iter().map(|&edge| to.edge(edge)));
                let edge = match fold_join(op, &mut operands) {
                    Folded::Edge(edge) => edge,
                    Folded::Join { op, complemented } => {
                        let edge = shared.insert(Term::Join(op), &operands, tag);
                        if complemented { edge.complement() } else { edge }
                    }
                };
                to.set(node, edge);
            }
        }
    }
    to.copy_outputs(formula, &mut shared.out);
    shared.out
}

/// A hash table of nodes; nodes with the same hash form a chain.
#[derive(Default)]
struct Shared {
    out: Formula,
    hasher: NameState,
    newest: NumberMap<u64, NodeId>,
    /// For each node the previous one with the same hash; node 0 ends the chain.
    older: Vec<NodeId>,
    /// The node of each leaf; node 0 if there is none yet.
    leaves: Vec<NodeId>,
}

impl Shared {
    fn leaf(&mut self, leaf: LeafId, tag: u32) -> Edge {
        if self.leaves.len() <= leaf.index() {
            self.leaves.resize(leaf.index() + 1, NodeId(0));
        }
        let node = &mut self.leaves[leaf.index()];
        if *node == NodeId(0) {
            *node = self.out.tagged(Term::Leaf(leaf), &[], tag).node();
        }
        Edge::new(*node, false)
    }

    fn insert(&mut self, term: Term, operands: &[Edge], tag: u32) -> Edge {
        let hash = self.hasher.hash_one((term, operands));
        let newest = self.newest.get(&hash).copied().unwrap_or(NodeId(0));
        let mut node = newest;
        while node != NodeId(0) {
            if self.out.term(node) == term && self.out.operands(node) == operands {
                return Edge::new(node, false);
            }
            node = self.older[node.index()];
        }
        let edge = self.out.tagged(term, operands, tag);
        self.older.resize(edge.node().index(), NodeId(0));
        self.older.push(newest);
        self.newest.insert(hash, edge.node());
        edge
    }
}
