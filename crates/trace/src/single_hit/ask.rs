//! Asking a tree what is next: the rule, over a post-order, with two stacks and no recursion.
//!
//! A *slice* of the post-order with a time t_min is work to be done: its leaves are asked, its gates take the
//! answers of their operands from the stack of values. Where a gate has to ask again (rule 4), the slice is
//! cut: its rest, from this gate on, waits on the stack of slices, and the sub-trees of the operands in
//! question become a slice of their own with a later t_min. (If both have to be asked they are neighbours in
//! the post-order: one slice.) The answer of an operand that is not asked again stays on the stack of values;
//! it is still true, as its next change lies after the new t_min.
//!
//! Slices that wait belong to gates on one way from the root to a leaf, so a tree of height h needs room for
//! h + 1 slices, the one at work included, and likewise h + 1 values. (A. Kensler's recursion, made iterative
//! as in S. Blyth's Opticks, with stacks that are as deep as the tree needs.)

use super::{Kind, Next, Step, Tree, Verdict, decide};

/// The leaves of a tree along one ray.
pub trait LeafAnswers {
    /// What is next of a leaf after `t_min`, which may be -inf.
    fn next(&self, leaf: u32, t_min: f64) -> Next;
}

/// Watches how an answer comes about.
pub trait Watch {
    /// A leaf was asked.
    fn leaf(&mut self, _node: usize, _t_min: f64, _answer: Next) {}
    /// A gate was given two answers.
    fn gate(&mut self, _node: usize, _operands: [Step; 2], _verdict: Verdict) {}
    /// So many slices and values are on the stacks, the slice at work included.
    fn depth(&mut self, _slices: usize, _values: usize) {}
}

/// Watches nothing.
#[derive(Clone, Copy, Debug)]
pub struct NoWatch;

impl Watch for NoWatch {}

/// A range of the post-order, to be worked off from a time on.
#[derive(Clone, Copy, Debug)]
struct Slice {
    next: u32,
    end: u32,
    t_min: f64,
}

/// The answer of a node whose gate has not come yet.
#[derive(Clone, Copy, Debug)]
struct Value {
    node: u32,
    step: Step,
}

/// The two stacks.
#[derive(Clone, Debug, Default)]
pub struct Stacks {
    slices: Vec<Slice>,
    values: Vec<Value>,
}

impl Stacks {
    /// Stacks for trees of a height: `height + 1` entries each.
    pub fn new(height: u32) -> Stacks {
        let most = height as usize + 1;
        Stacks { slices: Vec::with_capacity(most), values: Vec::with_capacity(most) }
    }

    /// What is next of a tree after `t_min`, which may be -inf.
    pub fn ask(
        &mut self,
        tree: &Tree,
        leaves: &impl LeafAnswers,
        t_min: f64,
        watch: &mut impl Watch,
    ) -> Step {
        self.slices.clear();
        self.values.clear();
        self.slices.push(Slice { next: 0, end: tree.nodes().len() as u32, t_min });
        while let Some(slice) = self.slices.pop() {
            self.work(tree, leaves, slice, watch);
        }
        self.values.pop().map_or(Step::constant(0), |value| value.step)
    }

    /// Works a slice off, up to its end or to where it is cut.
    fn work(&mut self, tree: &Tree, leaves: &impl LeafAnswers, slice: Slice, watch: &mut impl Watch) {
        for node in slice.next..slice.end {
            let at = node as usize;
            let step = match tree.nodes()[at].kind {
                Kind::Constant(value) => Step::constant(value),
                Kind::Leaf(leaf) => {
                    let answer = leaves.next(leaf, slice.t_min);
                    watch.leaf(at, slice.t_min, answer);
                    answer.into()
                }
                Kind::Gate(op) => {
                    let [a, b] = self.pop_two();
                    let verdict = decide(op, a.step, b.step);
                    watch.gate(at, [a.step, b.step], verdict);
                    match verdict {
                        Verdict::Fixed(value) => Step::constant(value),
                        Verdict::Changes(step) => step,
                        Verdict::AskAgain { t, first, second } => {
                            self.values
                                .extend([(a, first), (b, second)].iter().filter(|x| !x.1).map(|x| x.0));
                            self.slices.push(Slice { next: node, ..slice });
                            self.slices.push(again(tree, at, t, [first, second]));
                            watch.depth(self.slices.len(), self.values.len());
                            return;
                        }
                    }
                }
            };
            self.values.push(Value { node, step: step.map(|value| tree.nodes()[at].value(value)) });
            watch.depth(self.slices.len() + 1, self.values.len());
        }
    }

    /// The answers of the two operands of a gate, in their order: one that was asked again lies on top.
    fn pop_two(&mut self) -> [Value; 2] {
        let nothing = Value { node: 0, step: Step::constant(0) };
        let (top, below) = (self.values.pop().unwrap_or(nothing), self.values.pop().unwrap_or(nothing));
        if below.node < top.node { [below, top] } else { [top, below] }
    }
}

/// The sub-trees of the operands that are to be asked again.
fn again(tree: &Tree, gate: usize, t_min: f64, asked: [bool; 2]) -> Slice {
    let [first, _] = tree.operands(gate);
    let next = if asked[0] { tree.nodes()[gate].begin } else { first as u32 + 1 };
    let end = if asked[1] { gate as u32 } else { first as u32 + 1 };
    Slice { next, end, t_min }
}
