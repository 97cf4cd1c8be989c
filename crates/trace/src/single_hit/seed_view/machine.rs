//! Evaluation of a complete tree by decision tables, with stacks of a given size.

use super::{Action, CompleteTree, Operator, Slot, State, Tables};
use crate::single_hit::{LeafAnswers, Next};

/// Sizes of the stacks and of node numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Entries of the stack of slices.
    pub slices: usize,
    /// Entries of the stack of values.
    pub values: usize,
    /// Bits of the number of a node in a slice; higher ones are lost.
    pub index_bits: u32,
}

impl Limits {
    /// The limits of the original.
    pub const SEED: Limits = Limits { slices: 4, values: 15, index_bits: 8 };

    /// The limits that a tree of some height needs: height + 1 slices and values, and numbers
    /// below 2^(height + 1).
    pub fn for_height(height: u32) -> Limits {
        Limits { slices: height as usize + 1, values: height as usize + 1, index_bits: height + 1 }
    }
}

/// Failure of an evaluation. The original reports a miss instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The stack of slices is full.
    SlicesFull,
    /// The stack of values is full.
    ValuesFull,
    /// An operator finds fewer than two values on the stack, or the stack does not hold exactly one value at the end.
    ValuesMissing,
    /// The two values of an operator come from the same side.
    SameSide,
}

/// Converts a fault to a miss, as the original does silently.
pub fn silent(answer: Result<Next, Fault>) -> Next {
    answer.unwrap_or(Next::Outside)
}

/// A part of the post-order, to be evaluated from a time on.
#[derive(Clone, Copy)]
struct Slice {
    begin: u32,
    end: u32,
    t_min: f64,
}

/// The next change of an operand, and its side: the parity of its node.
#[derive(Clone, Copy)]
struct Value {
    answer: Next,
    is_first: bool,
}

struct Machine<'a> {
    tree: &'a CompleteTree,
    tables: &'a Tables,
    limits: Limits,
    slices: Vec<Slice>,
    values: Vec<Value>,
}

/// The next change of the tree after `t_min`.
///
/// # Errors
/// A [`Fault`] if the limits are too narrow.
pub fn next(
    tree: &CompleteTree,
    tables: &Tables,
    limits: Limits,
    leaves: &impl LeafAnswers,
    t_min: f64,
) -> Result<Next, Fault> {
    let mut machine = Machine { tree, tables, limits, slices: Vec::new(), values: Vec::new() };
    machine.push_slice(tree.first(), 0, t_min)?;
    while let Some(slice) = machine.slices.pop() {
        machine.run(slice, leaves)?;
    }
    match machine.values[..] {
        [Value { answer, .. }] => Ok(answer),
        _ => Err(Fault::ValuesMissing),
    }
}

impl Machine<'_> {
    fn push_slice(&mut self, begin: u32, end: u32, t_min: f64) -> Result<(), Fault> {
        if self.slices.len() >= self.limits.slices {
            return Err(Fault::SlicesFull);
        }
        let kept = 1u32.checked_shl(self.limits.index_bits).map_or(u32::MAX, |bit| bit - 1);
        self.slices.push(Slice { begin: begin & kept, end: end & kept, t_min });
        Ok(())
    }

    fn push(&mut self, node: u32, answer: Next) -> Result<(), Fault> {
        if self.values.len() >= self.limits.values {
            return Err(Fault::ValuesFull);
        }
        self.values.push(Value { answer, is_first: node & 1 == 0 });
        Ok(())
    }

    fn run(&mut self, slice: Slice, leaves: &impl LeafAnswers) -> Result<(), Fault> {
        let mut i = slice.begin;
        while i != slice.end {
            match self.tree.get(i) {
                Slot::Empty => {}
                Slot::Leaf { leaf, complemented } => {
                    let answer = leaves.next(leaf, slice.t_min);
                    self.push(i, if complemented { answer.complement() } else { answer })?;
                }
                Slot::Operator(operator) => {
                    if self.operate(i, operator, slice)? {
                        return Ok(());
                    }
                }
            }
            i = self.tree.next(i);
        }
        Ok(())
    }

    /// Decides an operator. Returns true if the slice was split because an operand must be queried again.
    fn operate(&mut self, i: u32, operator: Operator, slice: Slice) -> Result<bool, Fault> {
        let (Some(x), Some(y)) = (self.values.pop(), self.values.pop()) else {
            return Err(Fault::ValuesMissing);
        };
        if x.is_first == y.is_first {
            return Err(Fault::SameSide);
        }
        let (a, b) = if x.is_first { (x, y) } else { (y, x) };
        match self.action(operator, a.answer, b.answer) {
            Err(constant) => self.push(i, constant)?,
            Ok(Action::Miss) => self.push(i, Next::Outside)?,
            Ok(Action::First) => self.push(i, a.answer)?,
            Ok(Action::Second) => self.push(i, b.answer)?,
            Ok(Action::FlippedSecond) => self.push(i, b.answer.complement())?,
            Ok(Action::LoopFirst) => {
                self.values.push(b);
                let again = self.tree.left_slice(i);
                self.push_slice(i, slice.end, slice.t_min)?;
                self.push_slice(again.start, again.end, a.answer.time())?;
                return Ok(true);
            }
            Ok(Action::LoopSecond) => {
                self.values.push(a);
                let again = self.tree.right_slice(i);
                self.push_slice(i, slice.end, slice.t_min)?;
                self.push_slice(again.start, again.end, b.answer.time())?;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Looks up the action. Two operands that never change again give a constant without the table (the
    /// original encodes these by signs of zero).
    fn action(&self, operator: Operator, a: Next, b: Next) -> Result<Action, Next> {
        let first_closer = a.time() <= b.time();
        if a.time().min(b.time()) == f64::INFINITY {
            return Err(Next::new(operator.of(a.is_inside(), b.is_inside()), None));
        }
        Ok(self.tables.look_up(operator, first_closer, State::of(a), State::of(b)))
    }
}
