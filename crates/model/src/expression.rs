//! The boolean expression of one group: a hash-consed vector in topological order.

use crate::{LeafId, NodeId};
use std::collections::HashMap;

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

/// A boolean expression over the leaves of one group. Equal nodes are stored once, operands stand before
/// the nodes that use them, and node 0 is vacuum, node 1 plenum.
#[derive(Clone, Debug)]
pub struct Expression {
    nodes: Vec<Gate>,
    known: HashMap<Gate, NodeId>,
}

impl Default for Expression {
    fn default() -> Self {
        Expression { nodes: vec![Gate::Vacuum, Gate::Plenum], known: HashMap::new() }
    }
}

impl Expression {
    /// The nodes in topological order.
    pub fn nodes(&self) -> &[Gate] {
        &self.nodes
    }

    /// The node of a leaf.
    pub fn leaf(&mut self, leaf: LeafId) -> Edge {
        self.insert(Gate::Leaf(leaf))
    }

    /// Inside any of the operands.
    pub fn any(&mut self, operands: Vec<Edge>) -> Edge {
        self.join(operands, Edge::VACUUM, |_| 1)
    }

    /// Inside all of the operands.
    pub fn all(&mut self, operands: Vec<Edge>) -> Edge {
        self.join(operands, Edge::PLENUM, |n| n as u32)
    }

    /// Union or intersection: drops the neutral element and repeated operands, and answers at once where an
    /// operand is absorbing or stands beside its own complement.
    fn join(&mut self, mut operands: Vec<Edge>, neutral: Edge, least: impl Fn(usize) -> u32) -> Edge {
        let absorbing = neutral.complement();
        operands.sort_unstable();
        operands.dedup();
        operands.retain(|&e| e != neutral);
        // sorted, so an operand and its complement are neighbours
        let contradiction = operands.windows(2).any(|pair| pair[0].complement() == pair[1]);
        if contradiction || operands.contains(&absorbing) {
            return absorbing;
        }
        match operands[..] {
            [] => neutral,
            [only] => only,
            _ => {
                let rule = Rule::AtLeast(least(operands.len()));
                self.insert(Gate::Join(rule, operands))
            }
        }
    }

    /// Inside an odd number of the operands: complements move to the result and equal operands cancel.
    pub fn odd(&mut self, operands: Vec<Edge>) -> Edge {
        let mut complemented = false;
        let mut nodes: Vec<Edge> = Vec::with_capacity(operands.len());
        for edge in operands {
            complemented ^= edge.is_complemented() | (edge == Edge::PLENUM);
            if edge.node().0 > 1 {
                nodes.push(Edge::new(edge.node(), false));
            }
        }
        nodes.sort_unstable();
        let mut kept: Vec<Edge> = Vec::with_capacity(nodes.len());
        for edge in nodes {
            if kept.last() == Some(&edge) {
                kept.pop();
            } else {
                kept.push(edge);
            }
        }
        let result = match kept[..] {
            [] => Edge::VACUUM,
            [only] => only,
            _ => self.insert(Gate::Join(Rule::Odd, kept)),
        };
        if complemented { result.complement() } else { result }
    }

    /// The expression below an edge as text: leaves by number, `~` complement, `any{..}`, `all{..}`, `odd{..}`.
    /// Linear in the size of the text, which writes shared nodes out wherever they are used.
    pub fn text(&self, edge: Edge) -> String {
        let (mut text, mut tasks) = (String::new(), vec![Err(edge)]);
        while let Some(task) = tasks.pop() {
            match task {
                Ok(piece) => text.push_str(piece),
                Err(edge) => self.write_edge(edge, &mut text, &mut tasks),
            }
        }
        text
    }

    /// Writes what comes first of an operand and leaves the rest, last piece first, on the stack.
    fn write_edge(&self, edge: Edge, text: &mut String, tasks: &mut Vec<Result<&'static str, Edge>>) {
        if edge.is_complemented() {
            text.push('~');
        }
        let (rule, operands) = match &self.nodes[edge.node().index()] {
            Gate::Vacuum => return text.push_str("vacuum"),
            Gate::Plenum => return text.push_str("plenum"),
            Gate::Leaf(leaf) => return text.push_str(&leaf.0.to_string()),
            Gate::Join(rule, operands) => (*rule, operands),
        };
        match rule {
            Rule::AtLeast(1) => text.push_str("any{"),
            Rule::AtLeast(least) if least as usize == operands.len() => text.push_str("all{"),
            Rule::AtLeast(least) => text.push_str(&format!("at_least_{least}{{")),
            Rule::Odd => text.push_str("odd{"),
        }
        tasks.push(Ok("}"));
        for (k, &operand) in operands.iter().enumerate().rev() {
            tasks.push(Err(operand));
            tasks.extend((k > 0).then_some(Ok(", ")));
        }
    }

    fn insert(&mut self, gate: Gate) -> Edge {
        if let Some(&node) = self.known.get(&gate) {
            return Edge::new(node, false);
        }
        let node = NodeId::from(self.nodes.len());
        self.nodes.push(gate.clone());
        self.known.insert(gate, node);
        Edge::new(node, false)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn leaves(count: u32) -> (Expression, Vec<Edge>) {
        let mut e = Expression::default();
        let leaves = (0..count).map(|k| e.leaf(LeafId(k))).collect();
        (e, leaves)
    }

    #[test]
    fn local_rules() {
        let (mut e, x) = leaves(3);
        let not = x[0].complement();
        assert_eq!(e.any(vec![]), Edge::VACUUM);
        assert_eq!(e.all(vec![]), Edge::PLENUM);
        assert_eq!(e.any(vec![x[0], Edge::VACUUM, x[0]]), x[0]);
        assert_eq!(e.any(vec![x[1], x[0], not]), Edge::PLENUM);
        assert_eq!(e.all(vec![x[1], not, x[0]]), Edge::VACUUM);
        assert_eq!(e.all(vec![x[1], Edge::VACUUM]), Edge::VACUUM);
        assert_eq!(e.odd(vec![x[0], x[1], x[0]]), x[1]);
        assert_eq!(e.odd(vec![x[0], not]), Edge::PLENUM);
        assert_eq!(e.odd(vec![Edge::PLENUM, x[2]]), x[2].complement());
        assert_eq!(Edge::VACUUM.complement().complement(), Edge::VACUUM);
    }

    #[test]
    fn equal_nodes_are_stored_once() {
        let (mut e, x) = leaves(2);
        let before = e.any(vec![x[0], x[1]]);
        let size = e.nodes().len();
        assert_eq!(e.any(vec![x[1], x[0]]), before);
        assert_eq!(e.nodes().len(), size);
    }
}
