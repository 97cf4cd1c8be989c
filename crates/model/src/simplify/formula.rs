//! A boolean formula over leaves: a flat list of nodes, operands before the nodes that use them.

use crate::expression::{Brackets, Writing, write_tree};
use crate::{Edge, LeafId, NodeId};
use std::borrow::Cow;

/// The operation of a node on its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Inside any operand; without operands empty.
    Union,
    /// Inside all operands; without operands the universe.
    Intersection,
    /// Inside the first operand and none of the others; without operands empty.
    Difference,
    /// Inside an odd number of operands.
    SymmetricDifference,
    /// Inside at least this many operands.
    AtLeast(u32),
}

impl Op {
    /// The value of the operation for given values of the operands.
    pub fn of(self, mut operands: impl Iterator<Item = bool>) -> bool {
        match self {
            Op::Union => operands.any(|inside| inside),
            Op::Intersection => operands.all(|inside| inside),
            Op::Difference => operands.next().unwrap_or(false) && !operands.any(|inside| inside),
            Op::SymmetricDifference => operands.fold(false, |odd, inside| odd ^ inside),
            Op::AtLeast(least) => operands.filter(|&inside| inside).count() >= least as usize,
        }
    }
}

/// The kind of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Term {
    /// Never inside; node 0.
    Empty,
    /// Always inside; node 1.
    Universe,
    /// A leaf, by its number in the group.
    Leaf(LeafId),
    /// A boolean function of other nodes.
    Join(Op),
}

/// A formula with one or more outputs.
///
/// Node 0 is empty, node 1 universe, and operands come before their users. A complement is a flag of an
/// operand ([`Edge`]). A common part may be stored once. Each node has a *tag*, which the passes preserve:
/// the number of the node of the original formula from which it derives.
#[derive(Clone, Debug)]
pub struct Formula {
    terms: Vec<Term>,
    /// End of the operands of each node.
    ends: Vec<u32>,
    operands: Vec<Edge>,
    tags: Vec<u32>,
    outputs: Vec<Edge>,
}

impl Default for Formula {
    fn default() -> Self {
        Formula::with_capacity(0, 0)
    }
}

impl Formula {
    /// A formula with the two constants and capacity for more nodes and operands.
    pub fn with_capacity(nodes: usize, operands: usize) -> Formula {
        let mut formula = Formula {
            terms: Vec::with_capacity(nodes + 2),
            ends: Vec::with_capacity(nodes + 2),
            operands: Vec::with_capacity(operands),
            tags: Vec::with_capacity(nodes + 2),
            outputs: Vec::new(),
        };
        formula.push(Term::Empty, 0);
        formula.push(Term::Universe, 1);
        formula
    }

    /// An empty formula with the capacity of another one.
    pub(super) fn like(other: &Formula) -> Formula {
        Formula::with_capacity(other.terms.len(), other.operands.len())
    }

    fn push(&mut self, term: Term, tag: u32) -> Edge {
        let node = NodeId::from(self.terms.len());
        self.terms.push(term);
        self.ends.push(self.operands.len() as u32);
        self.tags.push(tag);
        Edge::new(node, false)
    }

    /// Appends a leaf.
    pub fn leaf(&mut self, leaf: LeafId) -> Edge {
        let tag = self.terms.len() as u32;
        self.push(Term::Leaf(leaf), tag)
    }

    /// Appends a node with its operands, unchanged.
    pub fn join(&mut self, op: Op, operands: &[Edge]) -> Edge {
        let tag = self.terms.len() as u32;
        self.tagged(Term::Join(op), operands, tag)
    }

    /// Appends a node with the given tag.
    pub(super) fn tagged(&mut self, term: Term, operands: &[Edge], tag: u32) -> Edge {
        debug_assert!(operands.iter().all(|edge| edge.node().index() < self.terms.len()));
        self.operands.extend_from_slice(operands);
        self.push(term, tag)
    }

    /// Complements some leaves in all their uses.
    pub(crate) fn complement_leaves(&mut self, complements: impl Fn(LeafId) -> bool) {
        let complemented = |term: &Term| matches!(term, Term::Leaf(leaf) if complements(*leaf));
        let nodes: Vec<bool> = self.terms.iter().map(complemented).collect();
        if nodes.contains(&true) {
            for edge in self.operands.iter_mut().chain(&mut self.outputs) {
                *edge = if nodes[edge.node().index()] { edge.complement() } else { *edge };
            }
        }
    }

    /// Adds an output.
    pub fn add_output(&mut self, output: Edge) {
        self.outputs.push(output);
    }

    /// The outputs of the formula.
    pub fn outputs(&self) -> &[Edge] {
        &self.outputs
    }

    /// The number of nodes, the two constants included.
    pub fn node_count(&self) -> usize {
        self.terms.len()
    }

    /// The kind of a node.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn term(&self, node: NodeId) -> Term {
        self.terms[node.index()]
    }

    /// The operands of a node; empty for a leaf or a constant.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn operands(&self, node: NodeId) -> &[Edge] {
        let begin = node.index().checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.operands[begin as usize..self.ends[node.index()] as usize]
    }

    /// The tag of a node: the number of the node of the original formula from which it derives.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn tag(&self, node: NodeId) -> u32 {
        self.tags[node.index()]
    }

    /// All nodes in order.
    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = (NodeId, Term, &[Edge])> {
        (0..self.terms.len()).map(|k| {
            let node = NodeId::from(k);
            (node, self.terms[k], self.operands(node))
        })
    }

    /// The number of uses of each node, by reachable nodes and by outputs; 0 for nodes that no output
    /// reaches.
    pub fn uses(&self) -> Vec<u32> {
        let mut uses = vec![0; self.terms.len()];
        self.outputs.iter().for_each(|edge| uses[edge.node().index()] += 1);
        for (node, _, operands) in self.nodes().rev() {
            if uses[node.index()] > 0 {
                operands.iter().for_each(|edge| uses[edge.node().index()] += 1);
            }
        }
        uses
    }

    /// Computes the value of every node for given values of the leaves: the definition of the formula.
    pub fn evaluate(&self, inside: impl Fn(LeafId) -> bool, values: &mut Vec<bool>) {
        values.clear();
        for (_, term, operands) in self.nodes() {
            let value = match term {
                Term::Empty => false,
                Term::Universe => true,
                Term::Leaf(leaf) => inside(leaf),
                Term::Join(op) => {
                    op.of(operands.iter().map(|e| values[e.node().index()] ^ e.is_complemented()))
                }
            };
            values.push(value);
        }
    }

    /// The formula below an edge as text: leaves by number, `~` complement, `any{..}`, `all{..}`,
    /// `minus{..}`, `odd{..}`, `at_least_2{..}`. Linear in the size of the text, which repeats shared nodes
    /// at each use.
    pub fn text(&self, edge: Edge) -> String {
        let writing = |node| match self.term(node) {
            Term::Empty => Writing::Text("empty".into()),
            Term::Universe => Writing::Text("universe".into()),
            Term::Leaf(leaf) => Writing::Text(leaf.0.to_string()),
            Term::Join(op) => Writing::Join(Brackets::named(prefix(op)), self.operands(node)),
        };
        write_tree(edge, writing, usize::MAX)
    }

    /// The formula below an edge in infix notation with names of leaves: `front & (back | ~rim)`; cut off
    /// once it is longer than `most` bytes.
    pub(super) fn infix(&self, edge: Edge, leaf_name: impl Fn(LeafId) -> String, most: usize) -> String {
        let writing = |node| match self.term(node) {
            Term::Empty => Writing::Text("empty".into()),
            Term::Universe => Writing::Text("universe".into()),
            Term::Leaf(leaf) => Writing::Text(leaf_name(leaf)),
            Term::Join(op) if self.operands(node).is_empty() => {
                let value = op.of(std::iter::empty());
                Writing::Text(if value { "universe" } else { "empty" }.into())
            }
            Term::Join(op) => {
                let brackets = infix(op, node == edge.node() && !edge.is_complemented());
                Writing::Join(brackets, self.operands(node))
            }
        };
        write_tree(edge, writing, most)
    }
}

fn prefix(op: Op) -> Cow<'static, str> {
    match op {
        Op::Union => "any".into(),
        Op::Intersection => "all".into(),
        Op::Difference => "minus".into(),
        Op::SymmetricDifference => "odd".into(),
        Op::AtLeast(least) => format!("at_least_{least}").into(),
    }
}

fn infix(op: Op, outermost: bool) -> Brackets {
    let between = match op {
        Op::Union => " | ",
        Op::Intersection => " & ",
        Op::Difference => " - ",
        Op::SymmetricDifference => " ^ ",
        Op::AtLeast(least) => {
            return Brackets { open: format!("at_least_{least}(").into(), between: ", ", close: ")" };
        }
    };
    match outermost {
        true => Brackets { open: "".into(), between, close: "" },
        false => Brackets { open: "(".into(), between, close: ")" },
    }
}

/// Map from the nodes of a formula to edges of the next one: a node may become a complement.
pub(super) struct Renumbered(Vec<Edge>);

impl Renumbered {
    pub fn new(formula: &Formula) -> Renumbered {
        let mut to = vec![Edge::EMPTY; formula.node_count()];
        to[1] = Edge::UNIVERSE;
        Renumbered(to)
    }

    pub fn set(&mut self, node: NodeId, edge: Edge) {
        self.0[node.index()] = edge;
    }

    pub fn edge(&self, edge: Edge) -> Edge {
        let to = self.0[edge.node().index()];
        if edge.is_complemented() { to.complement() } else { to }
    }

    pub fn copy_outputs(&self, from: &Formula, to: &mut Formula) {
        from.outputs().iter().for_each(|&output| to.add_output(self.edge(output)));
    }
}
