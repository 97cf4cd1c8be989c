//! The names of the nodes of a tree.

use super::explain::Meaning;
use super::{GateOp, SingleHit, Tree, TreeNode, TreeNodeKind};
use rayweave_model::{Evaluator, LeafId, Program, PrototypeId};
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// Number of nodes above which an operand is abbreviated in a formula: three leaves.
const WRITTEN_OUT: usize = 5;

/// The names of the nodes of a model's tree.
pub(super) struct Names<'a> {
    program: &'a Program,
    tree: &'a Tree,
    /// Number of leaves with each name.
    namesakes: HashMap<Cow<'a, str>, u32>,
    /// The nodes of the outputs with their numbers, sorted by node.
    outputs: Vec<(usize, usize)>,
    depths: Vec<u32>,
    /// Cache of the names.
    known: HashMap<usize, Arc<str>>,
}

impl<'a> Names<'a> {
    pub fn new(evaluator: &'a SingleHit) -> Names<'a> {
        let (program, tree) = (evaluator.program(), evaluator.tree(PrototypeId(0)));
        let mut namesakes = HashMap::new();
        let leaves = &program.prototype(PrototypeId(0)).leaves;
        for leaf in leaves.clone() {
            *namesakes.entry(program.leaf(LeafId(leaf)).name()).or_insert(0) += 1;
        }
        let outputs = (0..program.regions().len()).map(|k| (tree.output(k as u32), k)).collect();
        Names { program, tree, namesakes, outputs, depths: depths(tree), known: HashMap::new() }
    }

    pub fn program(&self) -> &'a Program {
        self.program
    }

    pub fn node(&self, node: usize) -> &'a TreeNode {
        &self.tree.nodes()[node]
    }

    pub fn operands(&self, gate: usize) -> [usize; 2] {
        self.tree.operands(gate)
    }

    /// The number of the leaf at a node.
    pub fn leaf(&self, node: usize) -> Option<u32> {
        match self.node(node).kind {
            TreeNodeKind::Leaf(leaf) => Some(leaf),
            _ => None,
        }
    }

    pub fn leaf_id(&self, leaf: u32) -> LeafId {
        LeafId(self.program.prototype(PrototypeId(0)).leaves.start + leaf)
    }

    /// The distance of a node from the root.
    pub fn depth(&self, node: usize) -> u32 {
        self.depths[node]
    }

    /// The name of a node, without its complement: `a`, `a | b`, `(a ... k) - l`.
    pub fn of(&mut self, node: usize) -> Arc<str> {
        if let Some(name) = self.known.get(&node) {
            return name.clone();
        }
        let name: Arc<str> = self.name(node).into();
        self.known.insert(node, name.clone());
        name
    }

    fn name(&self, node: usize) -> String {
        match self.node(node).kind {
            TreeNodeKind::Constant(0) => "empty".to_owned(),
            TreeNodeKind::Constant(_) => "universe".to_owned(),
            TreeNodeKind::Leaf(leaf) => self.leaf_name(leaf),
            TreeNodeKind::Gate(GateOp::Last) => self.regions_name(node),
            TreeNodeKind::Gate(op) => self.formula(op, node),
        }
    }

    fn leaf_name(&self, leaf: u32) -> String {
        let name = self.program.leaf(self.leaf_id(leaf)).name();
        match self.namesakes.get(&name) {
            Some(&count) if count > 1 => format!("{name} {leaf}"),
            _ => name.into_owned(),
        }
    }

    fn regions_name(&self, node: usize) -> String {
        let first = self.outputs.partition_point(|output| output.0 < self.node(node).begin as usize);
        let inside = &self.outputs[first..self.outputs.partition_point(|output| output.0 <= node)];
        let name = |output: &(usize, usize)| &*self.program.regions()[output.1].name;
        match inside {
            [first, last] => format!("{} and {}", name(first), name(last)),
            [first, .., last] => format!("{} to {}", name(first), name(last)),
            _ => "the regions".to_owned(),
        }
    }

    fn formula(&self, op: GateOp, node: usize) -> String {
        let [a, b] = self.operands(node);
        let sign = match op {
            GateOp::AtLeast { least: 1, most: [1, 1] } => "|",
            GateOp::AtLeast { least: 2, most: [1, 1] } if self.node(b).complemented => {
                return format!("{} - {}", self.operand(a, op), self.bracketed(b, None));
            }
            GateOp::AtLeast { least: 2, most: [1, 1] } => "&",
            GateOp::Odd => "^",
            GateOp::AtLeast { least, .. } => return format!("at least {least} of {}", self.ends(node)),
            GateOp::Sum | GateOp::Last => return format!("the number of {}", self.ends(node)),
        };
        format!("{} {sign} {}", self.operand(a, op), self.operand(b, op))
    }

    /// An operand in a formula, with its complement.
    fn operand(&self, node: usize, above: GateOp) -> String {
        if self.node(node).complemented {
            format!("~{}", self.bracketed(node, None))
        } else {
            self.bracketed(node, Some(above))
        }
    }

    /// The name in brackets, except for leaves and gates like the one above.
    fn bracketed(&self, node: usize, above: Option<GateOp>) -> String {
        match self.node(node).kind {
            TreeNodeKind::Gate(_) if node + 1 - self.node(node).begin as usize > WRITTEN_OUT => {
                self.ends(node)
            }
            TreeNodeKind::Gate(op) if Some(op) != above || self.is_difference(node) => {
                format!("({})", self.name(node))
            }
            _ => self.name(node),
        }
    }

    fn is_difference(&self, node: usize) -> bool {
        let and = matches!(self.node(node).kind, TreeNodeKind::Gate(GateOp::AtLeast { least: 2, .. }));
        and && self.node(self.operands(node)[1]).complemented
    }

    /// The first and the last of the leaves below a node.
    fn ends(&self, node: usize) -> String {
        let leaf = |node: usize| self.leaf(node).map(|leaf| self.leaf_name(leaf));
        let mut below = self.node(node).begin as usize..node;
        let (first, last) = (below.find_map(leaf), below.rev().find_map(leaf));
        format!("({} ... {})", first.unwrap_or_default(), last.unwrap_or_default())
    }

    /// The value of a gate for values of its operands, before any complement.
    pub fn gate_value(&self, gate: usize, [a, b]: [u32; 2]) -> u32 {
        match self.node(gate).kind {
            TreeNodeKind::Gate(op) => op.of(a, b),
            _ => 0,
        }
    }

    /// The meaning of the values of a node.
    pub fn meaning(&self, node: usize) -> Meaning {
        match self.node(node).kind {
            TreeNodeKind::Gate(GateOp::Sum) => Meaning::Count,
            TreeNodeKind::Gate(GateOp::Last) => Meaning::Region,
            _ => Meaning::Solid,
        }
    }
}

/// The distance of each node from the root.
fn depths(tree: &Tree) -> Vec<u32> {
    let mut depths = vec![0; tree.nodes().len()];
    for node in (0..depths.len()).rev() {
        if let TreeNodeKind::Gate(_) = tree.nodes()[node].kind {
            let below = depths[node] + 1;
            tree.operands(node).into_iter().for_each(|operand| depths[operand] = below);
        }
    }
    depths
}
