//! The expression of a group as one binary tree in post-order.

use super::GateOp;
use rayweave_error::{Classified, ErrorKind};
use rayweave_model::simplify::{BalanceStep, balanced};
use rayweave_model::{Edge, Gate, Rule};
use std::fmt;

/// Largest number of nodes over all groups of a model (2^22): 128 MiB of trees, and stacks of at most the
/// same size per thread, if the tree is a chain.
pub const MAX_NODES: u64 = 1 << 22;

/// Error: the tree of the model would have too many nodes.
///
/// The tree does not share nodes: a part with several uses is duplicated at each of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLarge {
    /// The number of nodes of the tree; `u64::MAX` if it is that or more.
    pub nodes: u64,
    /// The largest number allowed.
    pub most: u64,
}

impl Classified for TooLarge {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Compile
    }
}

impl fmt::Display for TooLarge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the tree of the single-hit evaluator has {} nodes, more than {}: shared parts are duplicated \
             at each use. Use a different evaluator.",
            match self.nodes {
                u64::MAX => "at least 2^64".to_owned(),
                nodes => nodes.to_string(),
            },
            self.most
        )
    }
}

impl std::error::Error for TooLarge {}

/// The kind of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TreeNodeKind {
    /// A constant value.
    Constant(u32),
    /// A leaf, by its number in its group.
    Leaf(u32),
    /// A function of two sub-trees.
    Gate(GateOp),
}

/// A node; its sub-tree is the slice of the post-order that ends with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeNode {
    /// The kind.
    pub kind: TreeNodeKind,
    /// The first node of its sub-tree.
    pub begin: u32,
    /// True if the node is complemented.
    pub complemented: bool,
    /// Factor of the value: 1, or the number of the region whose solid this is.
    pub weight: u32,
}

impl TreeNode {
    /// The value of the node, with complement and weight, for a value of its kind.
    pub fn value(&self, value: u32) -> u32 {
        (value ^ u32::from(self.complemented)) * self.weight
    }
}

/// A binary tree over the leaves of a group. Its value is the number, from 1, of the last output that is
/// inside; 0 if none is.
#[derive(Clone, Debug)]
pub struct Tree {
    nodes: Vec<TreeNode>,
    /// The node of each output.
    outputs: Vec<u32>,
    height: u32,
}

impl Tree {
    /// Builds the tree of a list of gates, operands before users, as in
    /// [`rayweave_model::Expression::nodes`].
    ///
    /// Gates with more than two operands become balanced trees, in the order of their operands.
    ///
    /// # Errors
    /// [`TooLarge`] if there would be more than `most` nodes.
    pub fn new(gates: &[Gate], outputs: &[Edge], most: u64) -> Result<Tree, TooLarge> {
        let nodes = expanded_size(gates, outputs);
        if nodes > most {
            return Err(TooLarge { nodes, most });
        }
        let mut builder = Builder {
            gates,
            outputs,
            tasks: Vec::new(),
            nodes: Vec::with_capacity(nodes as usize),
            open: Vec::new(),
            output_nodes: Vec::with_capacity(outputs.len()),
        };
        builder.run();
        let height = builder.open.last().map_or(0, |root| root.height);
        Ok(Tree { nodes: builder.nodes, outputs: builder.output_nodes, height })
    }

    /// The nodes in post-order.
    pub fn nodes(&self) -> &[TreeNode] {
        &self.nodes
    }

    /// The index of the node of output `k`, from 0.
    ///
    /// # Panics
    /// If there are not more than `k` outputs.
    pub fn output(&self, k: u32) -> usize {
        self.outputs[k as usize] as usize
    }

    /// The number of gates on the longest path from the root to a leaf.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The indices of the operands of a gate.
    ///
    /// # Panics
    /// May panic if the node is not a gate.
    pub fn operands(&self, gate: usize) -> [usize; 2] {
        let second = gate - 1;
        [self.nodes[second].begin as usize - 1, second]
    }

    /// The value of a node for given leaf values. `values` is a stack, left as it was; `inside` may use it,
    /// too.
    pub fn evaluate(
        &self,
        node: usize,
        mut inside: impl FnMut(u32, &mut Vec<u32>) -> bool,
        values: &mut Vec<u32>,
    ) -> u32 {
        for node in &self.nodes[self.nodes[node].begin as usize..=node] {
            let value = match node.kind {
                TreeNodeKind::Constant(value) => value,
                TreeNodeKind::Leaf(leaf) => u32::from(inside(leaf, values)),
                TreeNodeKind::Gate(op) => {
                    let second = values.pop().unwrap_or(0);
                    op.of(values.pop().unwrap_or(0), second)
                }
            };
            values.push(node.value(value));
        }
        values.pop().unwrap_or(0)
    }
}

/// The number of nodes of the tree, saturated at `u64::MAX`.
fn expanded_size(gates: &[Gate], outputs: &[Edge]) -> u64 {
    let mut sizes: Vec<u64> = Vec::with_capacity(gates.len());
    for gate in gates {
        sizes.push(match gate {
            Gate::Join(_, operands) => joined_size(&sizes, operands),
            _ => 1,
        });
    }
    joined_size(&sizes, outputs)
}

fn joined_size(sizes: &[u64], operands: &[Edge]) -> u64 {
    let sum = operands.iter().fold(0u64, |sum, edge| sum.saturating_add(sizes[edge.node().index()]));
    sum.saturating_add((operands.len() as u64).saturating_sub(1)).max(1)
}

/// Pending work of the builder, a stack.
enum Task {
    /// Records the last node as the root of the next output.
    Mark,
    /// Writes an operand with a weight.
    Operand(Edge, u32),
    /// Writes a gate over the two sub-trees before it.
    Gate { op: GateOp, complemented: bool, weight: u32 },
}

/// A sub-tree that no gate uses yet.
struct Open {
    begin: u32,
    height: u32,
    /// The largest value that it can take.
    most: u32,
}

struct Builder<'a> {
    gates: &'a [Gate<'a>],
    outputs: &'a [Edge],
    tasks: Vec<Task>,
    nodes: Vec<TreeNode>,
    open: Vec<Open>,
    output_nodes: Vec<u32>,
}

impl<'a> Builder<'a> {
    fn run(&mut self) {
        self.outputs();
        while let Some(task) = self.tasks.pop() {
            match task {
                Task::Mark => self.output_nodes.push(self.nodes.len() as u32 - 1),
                Task::Operand(edge, weight) => self.operand(edge, weight),
                Task::Gate { op, complemented, weight } => self.gate(op, complemented, weight),
            }
        }
    }

    /// Schedules all outputs as a balanced tree; each marks its root.
    fn outputs(&mut self) {
        if self.outputs.is_empty() {
            return self.leaf(TreeNodeKind::Constant(0), false, 1);
        }
        for step in balanced(self.outputs.len()).into_iter().rev() {
            match step {
                BalanceStep::Operand(k) => {
                    self.tasks.extend([Task::Mark, Task::Operand(self.outputs[k], k as u32 + 1)]);
                }
                BalanceStep::Join => {
                    self.tasks.push(Task::Gate { op: GateOp::Last, complemented: false, weight: 1 })
                }
            }
        }
    }

    fn operand(&mut self, edge: Edge, weight: u32) {
        let (gates, complemented) = (self.gates, edge.is_complemented());
        match &gates[edge.node().index()] {
            Gate::Empty => self.leaf(TreeNodeKind::Constant(0), complemented, weight),
            Gate::Universe => self.leaf(TreeNodeKind::Constant(1), complemented, weight),
            Gate::Leaf(leaf) => self.leaf(TreeNodeKind::Leaf(leaf.0), complemented, weight),
            Gate::Join(rule, operands) => self.join(*rule, operands, complemented, weight),
        }
    }

    /// Schedules a gate with any number of operands as a balanced tree; k of n with 1 < k < n as a tree of
    /// sums.
    fn join(&mut self, rule: Rule, operands: &'a [Edge], complemented: bool, weight: u32) {
        let count = operands.len() as u32;
        let (top, part) = match rule {
            // constant for all operands
            _ if count == 0 || rule == Rule::AtLeast(0) => {
                return self.leaf(TreeNodeKind::Constant(u32::from(rule.holds(0))), complemented, weight);
            }
            Rule::AtLeast(least) if least > count => {
                return self.leaf(TreeNodeKind::Constant(0), complemented, weight);
            }
            Rule::Odd => (GateOp::Odd, GateOp::Odd),
            Rule::AtLeast(1) => (at_least(1), at_least(1)),
            Rule::AtLeast(least) if least == count => (at_least(2), at_least(2)),
            Rule::AtLeast(least) => (at_least(least), GateOp::Sum),
        };
        match operands {
            &[only] => {
                let edge = if complemented { only.complement() } else { only };
                self.tasks.push(Task::Operand(edge, weight));
            }
            _ => self.parts(operands, part, Task::Gate { op: top, complemented, weight }),
        }
    }

    /// Schedules two or more operands as a balanced tree below a gate; the gates between are `part`.
    fn parts(&mut self, operands: &[Edge], part: GateOp, gate: Task) {
        self.tasks.push(gate);
        // the last step is the gate itself
        for step in balanced(operands.len()).into_iter().rev().skip(1) {
            self.tasks.push(match step {
                BalanceStep::Operand(k) => Task::Operand(operands[k], 1),
                BalanceStep::Join => Task::Gate { op: part, complemented: false, weight: 1 },
            });
        }
    }

    fn leaf(&mut self, kind: TreeNodeKind, complemented: bool, weight: u32) {
        let begin = self.nodes.len() as u32;
        self.nodes.push(TreeNode { kind, begin, complemented, weight });
        self.open.push(Open { begin, height: 0, most: weight });
    }

    fn gate(&mut self, op: GateOp, complemented: bool, weight: u32) {
        let (Some(second), Some(first)) = (self.open.pop(), self.open.pop()) else {
            return;
        };
        let op = match op {
            GateOp::AtLeast { least, .. } => GateOp::AtLeast { least, most: [first.most, second.most] },
            op => op,
        };
        let most = match op {
            GateOp::AtLeast { .. } | GateOp::Odd => weight,
            GateOp::Sum => first.most + second.most,
            GateOp::Last => first.most.max(second.most),
        };
        self.nodes.push(TreeNode { kind: TreeNodeKind::Gate(op), begin: first.begin, complemented, weight });
        self.open.push(Open { begin: first.begin, height: 1 + first.height.max(second.height), most });
    }
}

fn at_least(least: u32) -> GateOp {
    GateOp::AtLeast { least, most: [0; 2] }
}
