//! The expression of a group as one binary tree in post-order: the evaluator's own layout.

use super::Op;
use rayweave_error::{Classified, ErrorKind};
use rayweave_model::simplify::{Step, balanced};
use rayweave_model::{Edge, Gate, Rule};
use std::fmt;

/// More nodes than this (2^22) are refused, over all groups of a model: 128 MiB of tree, and stacks of at
/// most as much again for each thread where the tree is nothing but depth.
pub const MOST_NODES: u64 = 1 << 22;

/// A model whose tree would have too many nodes.
///
/// The tree has no sharing: a part that is used in many places is written out in each of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLarge {
    /// The number of nodes of the tree; `u64::MAX` if it is that or more.
    pub nodes: u64,
    /// The number that is allowed.
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
            "the tree of the single-hit evaluator has {} nodes, more than {}: shared parts are written out \
             wherever they are used. Use another evaluator.",
            match self.nodes {
                u64::MAX => "at least 2^64".to_owned(),
                nodes => nodes.to_string(),
            },
            self.most
        )
    }
}

impl std::error::Error for TooLarge {}

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The same value for ever.
    Constant(u32),
    /// A leaf, by its number in its group.
    Leaf(u32),
    /// A function of two sub-trees.
    Gate(Op),
}

/// A node; its sub-tree is the slice of the post-order that ends with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node {
    /// What it is.
    pub kind: Kind,
    /// Where its sub-tree begins.
    pub begin: u32,
    /// True if the complement is meant.
    pub complemented: bool,
    /// What a value of 1 counts: 1, or the number of the region whose solid this is.
    pub weight: u32,
}

impl Node {
    /// The value of the node for a value of its kind.
    pub fn value(&self, value: u32) -> u32 {
        (value ^ u32::from(self.complemented)) * self.weight
    }
}

/// A binary tree over the leaves of a group; its value is the number of the last output that is inside, from
/// 1, or 0.
#[derive(Clone, Debug)]
pub struct Tree {
    nodes: Vec<Node>,
    /// The node of each output.
    outputs: Vec<u32>,
    height: u32,
}

impl Tree {
    /// The tree of a list of gates, operands before users, as in [`rayweave_model::Expression::nodes`].
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
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The node of an output, by the number of the output from 0.
    ///
    /// # Panics
    /// If there are not that many outputs.
    pub fn output(&self, k: u32) -> usize {
        self.outputs[k as usize] as usize
    }

    /// The number of gates on the longest way from the root to a leaf.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The operands of the gate at a place.
    ///
    /// # Panics
    /// May panic where there is no gate.
    pub fn operands(&self, gate: usize) -> [usize; 2] {
        let second = gate - 1;
        [self.nodes[second].begin as usize - 1, second]
    }

    /// The value of a node for given leaf values; `values` is a stack, left as it was, that the function of
    /// the leaves may use, too.
    pub fn evaluate(
        &self,
        node: usize,
        mut inside: impl FnMut(u32, &mut Vec<u32>) -> bool,
        values: &mut Vec<u32>,
    ) -> u32 {
        for node in &self.nodes[self.nodes[node].begin as usize..=node] {
            let value = match node.kind {
                Kind::Constant(value) => value,
                Kind::Leaf(leaf) => u32::from(inside(leaf, values)),
                Kind::Gate(op) => {
                    let second = values.pop().unwrap_or(0);
                    op.of(values.pop().unwrap_or(0), second)
                }
            };
            values.push(node.value(value));
        }
        values.pop().unwrap_or(0)
    }
}

/// The number of nodes of the tree; `u64::MAX` if it is that or more.
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

/// What is still to be written, last first.
enum Task {
    /// The last node so far is the root of the next output.
    Mark,
    /// An operand; a value of 1 counts as `weight`.
    Operand(Edge, u32),
    /// A gate over the two sub-trees before it.
    Gate { op: Op, complemented: bool, weight: u32 },
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
    nodes: Vec<Node>,
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

    /// All outputs as a balanced tree; each marks its root.
    fn outputs(&mut self) {
        if self.outputs.is_empty() {
            return self.leaf(Kind::Constant(0), false, 1);
        }
        for step in balanced(self.outputs.len()).into_iter().rev() {
            match step {
                Step::Operand(k) => {
                    self.tasks.extend([Task::Mark, Task::Operand(self.outputs[k], k as u32 + 1)]);
                }
                Step::Join => self.tasks.push(Task::Gate { op: Op::Last, complemented: false, weight: 1 }),
            }
        }
    }

    fn operand(&mut self, edge: Edge, weight: u32) {
        let (gates, complemented) = (self.gates, edge.is_complemented());
        match &gates[edge.node().index()] {
            Gate::Empty => self.leaf(Kind::Constant(0), complemented, weight),
            Gate::Universe => self.leaf(Kind::Constant(1), complemented, weight),
            Gate::Leaf(leaf) => self.leaf(Kind::Leaf(leaf.0), complemented, weight),
            Gate::Join(rule, operands) => self.join(*rule, operands, complemented, weight),
        }
    }

    /// A gate with any number of operands: as a balanced tree, of sums where neither one nor all of them are
    /// needed.
    fn join(&mut self, rule: Rule, operands: &'a [Edge], complemented: bool, weight: u32) {
        let count = operands.len() as u32;
        let (top, part) = match rule {
            // the same whatever the operands are
            _ if count == 0 || rule == Rule::AtLeast(0) => {
                return self.leaf(Kind::Constant(u32::from(rule.holds(0))), complemented, weight);
            }
            Rule::AtLeast(least) if least > count => {
                return self.leaf(Kind::Constant(0), complemented, weight);
            }
            Rule::Odd => (Op::Odd, Op::Odd),
            Rule::AtLeast(1) => (at_least(1), at_least(1)),
            Rule::AtLeast(least) if least == count => (at_least(2), at_least(2)),
            Rule::AtLeast(least) => (at_least(least), Op::Sum),
        };
        match operands {
            &[only] => {
                let edge = if complemented { only.complement() } else { only };
                self.tasks.push(Task::Operand(edge, weight));
            }
            _ => self.parts(operands, part, Task::Gate { op: top, complemented, weight }),
        }
    }

    /// Two or more operands as a balanced tree below a gate; the gates between are `part`.
    fn parts(&mut self, operands: &[Edge], part: Op, gate: Task) {
        self.tasks.push(gate);
        // the last step is the gate itself
        for step in balanced(operands.len()).into_iter().rev().skip(1) {
            self.tasks.push(match step {
                Step::Operand(k) => Task::Operand(operands[k], 1),
                Step::Join => Task::Gate { op: part, complemented: false, weight: 1 },
            });
        }
    }

    fn leaf(&mut self, kind: Kind, complemented: bool, weight: u32) {
        let begin = self.nodes.len() as u32;
        self.nodes.push(Node { kind, begin, complemented, weight });
        self.open.push(Open { begin, height: 0, most: weight });
    }

    fn gate(&mut self, op: Op, complemented: bool, weight: u32) {
        let (Some(second), Some(first)) = (self.open.pop(), self.open.pop()) else {
            return;
        };
        let op = match op {
            Op::AtLeast { least, .. } => Op::AtLeast { least, most: [first.most, second.most] },
            op => op,
        };
        let most = match op {
            Op::AtLeast { .. } | Op::Odd => weight,
            Op::Sum => first.most + second.most,
            Op::Last => first.most.max(second.most),
        };
        self.nodes.push(Node { kind: Kind::Gate(op), begin: first.begin, complemented, weight });
        self.open.push(Open { begin: first.begin, height: 1 + first.height.max(second.height), most });
    }
}

fn at_least(least: u32) -> Op {
    Op::AtLeast { least, most: [0; 2] }
}
