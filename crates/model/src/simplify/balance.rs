//! Balanced binary trees for nodes with many operands.

use super::formula::{Formula, Op, Renumbered, Term};

/// A step in the construction of a binary tree with a stack (postfix order).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BalanceStep {
    /// Push the operand with this number.
    Operand(usize),
    /// Pop the second operand, then the first, and push their join.
    Join,
}

/// The steps that join `count` operands, in order, into a binary tree of minimal height.
///
/// Each node halves the range below it, so that the height is log2 of the count, rounded up.
pub fn balanced(count: usize) -> Vec<BalanceStep> {
    let mut steps = Vec::with_capacity((2 * count).saturating_sub(1));
    let mut waiting = vec![Ok(0..count)];
    while let Some(next) = waiting.pop() {
        match next {
            Ok(range) if range.is_empty() => {}
            Ok(range) if range.len() == 1 => steps.push(BalanceStep::Operand(range.start)),
            Ok(range) => {
                let middle = range.start + range.len() / 2;
                waiting.extend([Err(BalanceStep::Join), Ok(middle..range.end), Ok(range.start..middle)]);
            }
            Err(join) => steps.push(join),
        }
    }
    steps
}

/// Replaces nodes with many operands by balanced binary trees; keeps the value and the order of leaves.
///
/// "At least k of n" with 1 < k < n is not a chain of a binary operation: such nodes are kept. The first
/// operand of a difference stays separate: `a - (b | c)`.
pub fn balance(formula: &Formula) -> Formula {
    let uses = formula.uses();
    let mut out = Formula::like(formula);
    let mut to = Renumbered::new(formula);
    let (mut operands, mut stack) = (Vec::new(), Vec::new());
    for (node, term, all) in formula.nodes() {
        let tag = formula.tag(node);
        operands.clear();
        operands.extend(all.iter().map(|&edge| to.edge(edge)));
        let edge = match term {
            _ if uses[node.index()] == 0 => continue,
            Term::Empty | Term::Universe => continue,
            Term::Leaf(_) => out.tagged(term, &[], tag),
            Term::Join(_) if operands.len() < 3 => out.tagged(term, &operands, tag),
            Term::Join(Op::Difference) => {
                let rest = binary(&mut out, Op::Union, &operands[1..], tag, &mut stack);
                out.tagged(term, &[operands[0], rest], tag)
            }
            Term::Join(op) => match pairwise(op, operands.len()) {
                Some(op) => binary(&mut out, op, &operands, tag, &mut stack),
                None => out.tagged(term, &operands, tag),
            },
        };
        to.set(node, edge);
    }
    to.copy_outputs(formula, &mut out);
    out
}

/// The binary operation whose chain equals an operation on `count` operands; `None` if there is none.
fn pairwise(op: Op, count: usize) -> Option<Op> {
    match op {
        Op::AtLeast(1) => Some(Op::Union),
        Op::AtLeast(least) if least as usize == count => Some(Op::Intersection),
        Op::AtLeast(_) => None,
        op => Some(op),
    }
}

/// The root of a balanced tree over at least one operand.
fn binary(
    out: &mut Formula,
    op: Op,
    operands: &[crate::Edge],
    tag: u32,
    stack: &mut Vec<crate::Edge>,
) -> crate::Edge {
    for step in balanced(operands.len()) {
        match step {
            BalanceStep::Operand(k) => stack.push(operands[k]),
            BalanceStep::Join => {
                let pair = stack.split_off(stack.len() - 2);
                stack.push(out.tagged(Term::Join(op), &pair, tag));
            }
        }
    }
    stack.pop().unwrap_or(crate::Edge::EMPTY)
}
