//! The boolean expression of one group: gates in topological order.

use crate::simplify::{Formula, Op, Term};
use crate::{LeafId, NodeId};
use std::borrow::Cow;

/// Node number of leaf 0.
const FIRST_LEAF: u32 = 2;

/// The function that a gate computes of its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rule {
    /// True if at least this many operands are inside: 1 is the union, the number of operands the
    /// intersection.
    AtLeast(u32),
    /// True if an odd number of operands is inside.
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
    pub const EMPTY: Edge = Edge::new(NodeId(0), false);
    /// Always inside.
    pub const UNIVERSE: Edge = Edge::new(NodeId(1), false);

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

    /// The complement. The complement of empty is universe, so that each constant has one form.
    pub fn complement(self) -> Edge {
        match self {
            Edge::EMPTY => Edge::UNIVERSE,
            Edge::UNIVERSE => Edge::EMPTY,
            Edge(bits) => Edge(bits ^ 1),
        }
    }
}

/// A node of an expression.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Gate<'e> {
    /// Never inside; node 0.
    Empty,
    /// Always inside; node 1.
    Universe,
    /// A leaf, by its number in the group; node number + 2.
    Leaf(LeafId),
    /// A boolean function of other nodes.
    Join(Rule, Cow<'e, [Edge]>),
}

/// The boolean expression of one group over its leaves, after simplification ([`simplify`](crate::simplify)):
/// equal nodes are stored once, and operands come before the nodes that use them.
///
/// Node 0 is empty, node 1 universe, node k + 2 leaf k of the group, whether it is used or not; the others
/// are joins. A leaf takes no memory except four bytes for each use of it.
#[derive(Clone, Debug)]
pub struct Expression {
    leaf_count: u32,
    joins: Vec<Join>,
    operands: Vec<Edge>,
    outputs: Vec<Edge>,
}

/// A join of an expression.
#[derive(Clone, Copy, Debug)]
struct Join {
    rule: Rule,
    /// End of its operands; they begin at the end of those of the join before it.
    end: u32,
}

impl Expression {
    /// The joins of a formula, in the same order, over `leaf_count` leaves.
    pub fn new(formula: &Formula, leaf_count: usize) -> Expression {
        let mut expression = Expression {
            leaf_count: leaf_count as u32,
            joins: Vec::new(),
            operands: Vec::new(),
            outputs: Vec::new(),
        };
        let mut number: Vec<NodeId> = Vec::with_capacity(formula.node_count());
        let renumbered =
            |number: &[NodeId], edge: Edge| Edge::new(number[edge.node().index()], edge.is_complemented());
        for (node, term, operands) in formula.nodes() {
            number.push(match term {
                Term::Empty | Term::Universe => node,
                Term::Leaf(leaf) => NodeId(FIRST_LEAF + leaf.0),
                Term::Join(op) => {
                    expression.operands.extend(operands.iter().map(|&edge| renumbered(&number, edge)));
                    expression.join(op, operands.len())
                }
            });
        }
        expression.outputs = formula.outputs().iter().map(|&edge| renumbered(&number, edge)).collect();
        expression.joins.shrink_to_fit();
        expression.operands.shrink_to_fit();
        expression
    }

    /// Appends a join of the last `count` operands.
    fn join(&mut self, op: Op, count: usize) -> NodeId {
        let first = self.operands.len() - count;
        if op == Op::Difference {
            self.operands[first..].iter_mut().skip(1).for_each(|edge| *edge = edge.complement());
        }
        let rule = match op {
            Op::Union => Rule::AtLeast(1),
            Op::Difference if count == 0 => Rule::AtLeast(1),
            Op::Intersection | Op::Difference => Rule::AtLeast(count as u32),
            Op::AtLeast(least) => Rule::AtLeast(least),
            Op::SymmetricDifference => Rule::Odd,
        };
        self.joins.push(Join { rule, end: self.operands.len() as u32 });
        NodeId::from(self.node_count() - 1)
    }

    /// The outputs of the group: one edge per region for the model, one for a placed solid.
    pub fn outputs(&self) -> &[Edge] {
        &self.outputs
    }

    /// The number of nodes, constants and leaves included.
    pub fn node_count(&self) -> usize {
        (FIRST_LEAF + self.leaf_count) as usize + self.joins.len()
    }

    /// The number of leaves of the group, whether they are used or not.
    pub fn leaf_count(&self) -> usize {
        self.leaf_count as usize
    }

    /// A node.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn node(&self, id: NodeId) -> Gate<'_> {
        match (id.0, id.0.checked_sub(FIRST_LEAF)) {
            (0, _) => Gate::Empty,
            (_, None) => Gate::Universe,
            (_, Some(leaf)) if leaf < self.leaf_count => Gate::Leaf(LeafId(leaf)),
            (_, Some(k)) => {
                let (rule, operands) = self.join_at((k - self.leaf_count) as usize);
                Gate::Join(rule, Cow::Borrowed(operands))
            }
        }
    }

    /// The nodes in topological order.
    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = Gate<'_>> + ExactSizeIterator {
        (0..self.node_count()).map(|k| self.node(NodeId::from(k)))
    }

    /// The joins in topological order; the first one is node `leaf_count` + 2.
    pub fn joins(&self) -> impl DoubleEndedIterator<Item = (Rule, &[Edge])> + ExactSizeIterator {
        (0..self.joins.len()).map(|k| self.join_at(k))
    }

    fn join_at(&self, k: usize) -> (Rule, &[Edge]) {
        let begin = k.checked_sub(1).map_or(0, |before| self.joins[before].end);
        (self.joins[k].rule, &self.operands[begin as usize..self.joins[k].end as usize])
    }

    /// The same expression as a formula, with the same node numbers.
    pub fn formula(&self) -> Formula {
        let mut formula = Formula::with_capacity(self.node_count(), self.operands.len());
        (0..self.leaf_count).for_each(|leaf| _ = formula.leaf(LeafId(leaf)));
        for (rule, operands) in self.joins() {
            let op = match rule {
                Rule::AtLeast(least) => Op::AtLeast(least),
                Rule::Odd => Op::SymmetricDifference,
            };
            formula.join(op, operands);
        }
        self.outputs.iter().for_each(|&output| formula.add_output(output));
        formula
    }

    /// Size in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.joins[..]) + size_of_val(&self.operands[..]) + size_of_val(&self.outputs[..])
    }

    /// The expression below an edge as text: leaves by number, `~` complement, `any{..}`, `all{..}`,
    /// `odd{..}`. Linear in the size of the text, which repeats shared nodes at each use.
    pub fn text(&self, edge: Edge) -> String {
        let writing = |node: NodeId| {
            let (rule, operands) = match self.node(node) {
                Gate::Empty => return Writing::Text("empty".into()),
                Gate::Universe => return Writing::Text("universe".into()),
                Gate::Leaf(leaf) => return Writing::Text(leaf.0.to_string()),
                Gate::Join(..) => self.join_at(node.index() - (FIRST_LEAF + self.leaf_count) as usize),
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

    /// Computes the value of every node for given leaf values in one pass: the definition of the expression,
    /// against which faster networks are tested.
    pub fn evaluate(&self, inside: impl Fn(LeafId) -> bool, values: &mut Vec<bool>) {
        values.clear();
        values.extend([false, true]);
        values.extend((0..self.leaf_count).map(|leaf| inside(LeafId(leaf))));
        for (rule, operands) in self.joins() {
            let holds = |edge: &&Edge| values[edge.node().index()] ^ edge.is_complemented();
            let count = operands.iter().filter(holds).count();
            values.push(rule.holds(count as u32));
        }
    }
}

/// Text before, between and after operands.
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

/// The text of a node.
pub(crate) enum Writing<'a> {
    Text(String),
    Join(Brackets, &'a [Edge]),
}

/// The expression below an edge as text, with an explicit stack; cut off once it is longer than `most` bytes.
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
