//! Iterative evaluation of a tree: the next change of its root after a time, over the post-order, with two
//! stacks.
//!
//! A *slice* of the post-order with a time t_min is pending work: its leaves are queried, and its gates take
//! the results of their operands from the stack of values. Where a gate must query operands again (rule 4),
//! the slice is split: the rest of it, from this gate on, waits on the stack of slices, and the sub-trees of
//! these operands become a slice of their own with a later t_min. (If both must be queried they are adjacent
//! in the post-order: one slice.) The result of an operand that is not queried again stays on the stack of
//! values; it is still valid, as its next change lies after the new t_min.
//!
//! Waiting slices belong to gates on one path from the root to a leaf, so a tree of height h needs room for
//! h + 1 slices, the current one included, and likewise for h + 1 values. (The recursion of A. Kensler, made
//! iterative as in S. Blyth's Opticks, with stacks as deep as the tree needs.)

use super::{Next, Tree, TreeNodeKind, ValueStep, Verdict, decide};

/// The leaves of a tree along one ray.
pub trait LeafAnswers {
    /// The next change of a leaf after `t_min`, which may be -inf.
    fn next(&self, leaf: u32, t_min: f64) -> Next;
}

/// Observer of an evaluation.
pub trait Observer {
    /// A leaf was queried.
    fn leaf(&mut self, _node: usize, _t_min: f64, _answer: Next) {}
    /// A gate was decided.
    fn gate(&mut self, _node: usize, _operands: [ValueStep; 2], _verdict: Verdict) {}
    /// Numbers of entries on the two stacks, the current slice included.
    fn depth(&mut self, _slices: usize, _values: usize) {}
}

/// An observer that does nothing.
#[derive(Clone, Copy, Debug)]
pub struct NoObserver;

impl Observer for NoObserver {}

/// A range of the post-order, to be evaluated from a time on.
#[derive(Clone, Copy, Debug)]
struct Slice {
    next: u32,
    end: u32,
    t_min: f64,
}

/// The result of a node whose parent has not been decided yet.
#[derive(Clone, Copy, Debug)]
struct Value {
    node: u32,
    step: ValueStep,
}

/// The stacks of slices and values.
#[derive(Clone, Debug, Default)]
pub struct Stacks {
    slices: Vec<Slice>,
    values: Vec<Value>,
}

impl Stacks {
    /// Stacks for trees of this height: `height + 1` entries each.
    pub fn new(height: u32) -> Stacks {
        let most = height as usize + 1;
        Stacks { slices: Vec::with_capacity(most), values: Vec::with_capacity(most) }
    }

    /// The next change of a tree after `t_min`, which may be -inf.
    pub fn next_change(
        &mut self,
        tree: &Tree,
        leaves: &impl LeafAnswers,
        t_min: f64,
        observer: &mut impl Observer,
    ) -> ValueStep {
        self.slices.clear();
        self.values.clear();
        self.slices.push(Slice { next: 0, end: tree.nodes().len() as u32, t_min });
        while let Some(slice) = self.slices.pop() {
            self.work(tree, leaves, slice, observer);
        }
        self.values.pop().map_or(ValueStep::constant(0), |value| value.step)
    }

    /// Evaluates a slice up to its end or to the gate where it is split.
    fn work(&mut self, tree: &Tree, leaves: &impl LeafAnswers, slice: Slice, observer: &mut impl Observer) {
        for node in slice.next..slice.end {
            let at = node as usize;
            let step = match tree.nodes()[at].kind {
                TreeNodeKind::Constant(value) => ValueStep::constant(value),
                TreeNodeKind::Leaf(leaf) => {
                    let answer = leaves.next(leaf, slice.t_min);
                    observer.leaf(at, slice.t_min, answer);
                    answer.into()
                }
                TreeNodeKind::Gate(op) => {
                    let [a, b] = self.pop_two();
                    let verdict = decide(op, a.step, b.step);
                    observer.gate(at, [a.step, b.step], verdict);
                    match verdict {
                        Verdict::Fixed(value) => ValueStep::constant(value),
                        Verdict::Changes(step) => step,
                        Verdict::QueryAgain { t, first, second } => {
                            self.values
                                .extend([(a, first), (b, second)].iter().filter(|x| !x.1).map(|x| x.0));
                            self.slices.push(Slice { next: node, ..slice });
                            self.slices.push(again(tree, at, t, [first, second]));
                            observer.depth(self.slices.len(), self.values.len());
                            return;
                        }
                    }
                }
            };
            self.values.push(Value { node, step: step.map(|value| tree.nodes()[at].value(value)) });
            observer.depth(self.slices.len() + 1, self.values.len());
        }
    }

    /// Pops the results of the two operands of a gate, in their order; one that was queried again is on top.
    fn pop_two(&mut self) -> [Value; 2] {
        let nothing = Value { node: 0, step: ValueStep::constant(0) };
        let (top, below) = (self.values.pop().unwrap_or(nothing), self.values.pop().unwrap_or(nothing));
        if below.node < top.node { [below, top] } else { [top, below] }
    }
}

/// The sub-trees of the operands that must be queried again.
fn again(tree: &Tree, gate: usize, t_min: f64, queried: [bool; 2]) -> Slice {
    let [first, _] = tree.operands(gate);
    let next = if queried[0] { tree.nodes()[gate].begin } else { first as u32 + 1 };
    let end = if queried[1] { gate as u32 } else { first as u32 + 1 };
    Slice { next, end, t_min }
}
