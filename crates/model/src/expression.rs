//! The boolean expression of one group: gates in topological order.

use crate::simplify::{Formula, Op, Term};
use crate::{LeafId, NodeId};
use std::borrow::Cow;

/// When a gate is inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rule {
    /// Inside at least this many operands: 1 is the union, all of them the intersection.
    AtLeast(u32),
    /// Inside an odd number of operands.
    Odd,
}

impl Rule {
    /// The value of the gate if `count` of its operands are inside.
    pub fn holds(self, count: u32) -> bool {
        match self {
            Rule::AtLeast(least) => count >= least,
            Rule::Odd => count % 2 == 1,
        }
    }
}

/// An operand: a node, possibly complemented.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Edge(u32);

impl Edge {
    /// Never inside.
    pub const VACUUM: Edge = Edge::new(NodeId(0), false);
    /// Always inside.
    pub const PLENUM: Edge = Edge::new(NodeId(1), false);

    /// The node, or its complement.
    pub const fn new(node: NodeId, complemented: bool) -> Edge {
        Edge(node.0 << 1 | complemented as u32)
    }

    /// The node.
    pub fn node(self) -> NodeId {
        NodeId(self.0 >> 1)
    }

    /// True if the operand is the complement of the node.
    pub fn is_complemented(self) -> bool {
        self.0 & 1 == 1
    }

    /// The complement. The complement of vacuum is plenum, so that each constant has one form.
    pub fn complement(self) -> Edge {
        match self {
            Edge::VACUUM => Edge::PLENUM,
            Edge::PLENUM => Edge::VACUUM,
            Edge(bits) => Edge(bits ^ 1),
        }
    }
}

/// A node of an expression.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Gate {
    /// Never inside; node 0.
    Vacuum,
    /// Always inside; node 1.
    Plenum,
    /// A leaf, by its number in the group.
    Leaf(LeafId),
    /// A boolean function of other nodes.
    Join(Rule, Vec<Edge>),
}

/// The boolean expression of one group over its leaves, as its formula was prepared
/// ([`simplify`](crate::simplify)): equal nodes are stored once, operands stand before the nodes that use them, and
/// node 0 is vacuum, node 1 plenum.
#[derive(Clone, Debug)]
pub struct Expression {
    nodes: Vec<Gate>,
}

impl Expression {
    /// The same nodes as those of a formula, under the same numbers.
    pub fn new(formula: &Formula) -> Expression {
        let gate = |(_, term, operands): (NodeId, Term, &[Edge])| match term {
            Term::Vacuum => Gate::Vacuum,
            Term::Plenum => Gate::Plenum,
            Term::Leaf(leaf) => Gate::Leaf(leaf),
            Term::Join(op) => join(op, operands),
        };
        Expression { nodes: formula.nodes().map(gate).collect() }
    }

    /// The nodes in topological order.
    pub fn nodes(&self) -> &[Gate] {
        &self.nodes
    }

    /// The expression below an edge as text: leaves by number, `~` complement, `any{..}`, `all{..}`, `odd{..}`.
    /// Linear in the size of the text, which writes shared nodes out wherever they are used.
    pub fn text(&self, edge: Edge) -> String {
        let writing = |node: NodeId| {
            let (rule, operands) = match &self.nodes[node.index()] {
                Gate::Vacuum => return Writing::Text("vacuum".into()),
                Gate::Plenum => return Writing::Text("plenum".into()),
                Gate::Leaf(leaf) => return Writing::Text(leaf.0.to_string()),
                Gate::Join(rule, operands) => (*rule, operands),
            };
            let name: Cow<'static, str> = match rule {
                Rule::AtLeast(1) => "any".into(),
                Rule::AtLeast(least) if least as usize == operands.len() => "all".into(),
                Rule::AtLeast(least) => format!("at_least_{least}").into(),
                Rule::Odd => "odd".into(),
            };
            Writing::Join(Brackets::named(name), operands)
        };
        write_tree(edge, writing, usize::MAX)
    }

    /// The value of every node for given leaf values, by one pass in order: the plain meaning of the
    /// expression, against which faster networks are tested.
    pub fn evaluate(&self, inside: impl Fn(LeafId) -> bool, values: &mut Vec<bool>) {
        values.clear();
        for gate in &self.nodes {
            let value = match gate {
                Gate::Vacuum => false,
                Gate::Plenum => true,
                Gate::Leaf(leaf) => inside(*leaf),
                Gate::Join(rule, operands) => {
                    let count =
                        operands.iter().filter(|e| values[e.node().index()] ^ e.is_complemented()).count();
                    rule.holds(count as u32)
                }
            };
            values.push(value);
        }
    }
}

/// The gate of an operation.
fn join(op: Op, operands: &[Edge]) -> Gate {
    let count = operands.len() as u32;
    let complements = operands.iter().enumerate();
    match op {
        Op::Union => Gate::Join(Rule::AtLeast(1), operands.to_vec()),
        Op::Difference if count == 0 => Gate::Join(Rule::AtLeast(1), Vec::new()),
        Op::Intersection => Gate::Join(Rule::AtLeast(count), operands.to_vec()),
        Op::AtLeast(least) => Gate::Join(Rule::AtLeast(least), operands.to_vec()),
        Op::SymmetricDifference => Gate::Join(Rule::Odd, operands.to_vec()),
        Op::Difference => Gate::Join(
            Rule::AtLeast(count),
            complements.map(|(k, &edge)| if k == 0 { edge } else { edge.complement() }).collect(),
        ),
    }
}

/// What stands before, between and after operands.
pub(crate) struct Brackets {
    pub open: Cow<'static, str>,
    pub between: &'static str,
    pub close: &'static str,
}

impl Brackets {
    /// As `any{0, 1}`.
    pub fn named(name: impl Into<Cow<'static, str>>) -> Brackets {
        Brackets { open: name.into() + "{", between: ", ", close: "}" }
    }
}

/// How a node is written.
pub(crate) enum Writing<'a> {
    Text(String),
    Join(Brackets, &'a [Edge]),
}

/// What is below an edge as text, with an explicit stack; cut off where it gets longer than `most` bytes.
pub(crate) fn write_tree<'a>(edge: Edge, node: impl Fn(NodeId) -> Writing<'a>, most: usize) -> String {
    let (mut text, mut tasks) = (String::new(), vec![Err(edge)]);
    while let Some(task) = tasks.pop() {
        if text.len() > most {
            return text + "...";
        }
        let edge = match task {
            Ok(piece) => {
                text.push_str(piece);
                continue;
            }
            Err(edge) => edge,
        };
        if edge.is_complemented() {
            text.push('~');
        }
        match node(edge.node()) {
            Writing::Text(piece) => text.push_str(&piece),
            Writing::Join(Brackets { open, between, close }, operands) => {
                text.push_str(&open);
                tasks.push(Ok(close));
                for (k, &operand) in operands.iter().enumerate().rev() {
                    tasks.push(Err(operand));
                    tasks.extend((k > 0).then_some(Ok(between)));
                }
            }
        }
    }
    text
}
