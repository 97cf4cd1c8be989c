//! Constant folding, idempotence and contradiction.

use super::formula::{Formula, Op, Renumbered, Term};
use crate::Edge;

/// Removes constants, repeated operands and operands next to their own complement; keeps the value.
///
/// `a | empty` and `a & a` become `a`, `a - a` becomes empty, `a ^ a ^ b` becomes `b`; nodes that become
/// constant are folded in turn. Operands are sorted by node number, which is the order of their first leaves
/// if nodes are numbered in the order of declaration.
pub fn fold(formula: &Formula) -> Formula {
    let uses = formula.uses();
    let mut out = Formula::like(formula);
    let mut to = Renumbered::new(formula);
    let mut operands = Vec::new();
    for (node, term, all) in formula.nodes() {
        match term {
            _ if uses[node.index()] == 0 => {}
            Term::Empty | Term::Universe => {}
            Term::Leaf(_) => to.set(node, out.tagged(term, &[], formula.tag(node))),
            Term::Join(op) => {
                operands.clear();
                operands.extend(all.iter().map(|&edge| to.edge(edge)));
                let edge = match fold_join(op, &mut operands) {
                    Folded::Edge(edge) => edge,
                    Folded::Join { op, complemented } => {
                        let edge = out.tagged(Term::Join(op), &operands, formula.tag(node));
                        if complemented { edge.complement() } else { edge }
                    }
                };
                to.set(node, edge);
            }
        }
    }
    to.copy_outputs(formula, &mut out);
    out
}

/// The result of folding a node.
pub(super) enum Folded {
    /// One of its operands, or a constant.
    Edge(Edge),
    /// A node over the remaining operands.
    Join { op: Op, complemented: bool },
}

/// Folds one node. Sorts its operands and removes those that are not needed.
pub(super) fn fold_join(op: Op, operands: &mut Vec<Edge>) -> Folded {
    match op {
        Op::Union => fold_chain(op, operands, Edge::EMPTY),
        Op::Intersection => fold_chain(op, operands, Edge::UNIVERSE),
        Op::Difference if operands.is_empty() => Folded::Edge(Edge::EMPTY),
        Op::Difference => {
            operands[1..].iter_mut().for_each(|edge| *edge = edge.complement());
            fold_chain(Op::Intersection, operands, Edge::UNIVERSE)
        }
        Op::SymmetricDifference => fold_odd(operands),
        Op::AtLeast(least) => fold_count(least, operands),
    }
}

fn fold_chain(op: Op, operands: &mut Vec<Edge>, neutral: Edge) -> Folded {
    let absorbing = neutral.complement();
    operands.sort_unstable();
    operands.dedup();
    operands.retain(|&edge| edge != neutral);
    // sorted, so an operand and its complement are neighbours
    let contradiction = operands.windows(2).any(|pair| pair[0].complement() == pair[1]);
    if contradiction || operands.contains(&absorbing) {
        return Folded::Edge(absorbing);
    }
    match operands[..] {
        [] => Folded::Edge(neutral),
        [only] => Folded::Edge(only),
        _ => Folded::Join { op, complemented: false },
    }
}

/// Moves complements to the result and cancels equal operands.
fn fold_odd(operands: &mut Vec<Edge>) -> Folded {
    let mut complemented = false;
    for edge in operands.iter_mut() {
        if edge.is_complemented() || *edge == Edge::UNIVERSE {
            complemented = !complemented;
            *edge = edge.complement();
        }
    }
    operands.retain(|&edge| edge != Edge::EMPTY);
    operands.sort_unstable();
    cancel(operands, |a, b| a == b);
    match operands[..] {
        [] if complemented => Folded::Edge(Edge::UNIVERSE),
        [] => Folded::Edge(Edge::EMPTY),
        [only] if complemented => Folded::Edge(only.complement()),
        [only] => Folded::Edge(only),
        _ => Folded::Join { op: Op::SymmetricDifference, complemented },
    }
}

/// Removes adjacent operands that cancel, also those that become adjacent, and returns the number of pairs.
fn cancel(operands: &mut Vec<Edge>, cancels: impl Fn(Edge, Edge) -> bool) -> u32 {
    let (mut kept, mut pairs) = (0, 0);
    for k in 0..operands.len() {
        if kept > 0 && cancels(operands[kept - 1], operands[k]) {
            (kept, pairs) = (kept - 1, pairs + 1);
        } else {
            operands[kept] = operands[k];
            kept += 1;
        }
    }
    operands.truncate(kept);
    pairs
}

/// Folds "at least k of n": of an operand and its complement exactly one counts, whatever its value.
fn fold_count(least: u32, operands: &mut Vec<Edge>) -> Folded {
    let full = operands.iter().filter(|&&edge| edge == Edge::UNIVERSE).count() as u32;
    operands.retain(|&edge| edge != Edge::UNIVERSE && edge != Edge::EMPTY);
    operands.sort_unstable();
    let pairs = cancel(operands, |a, b| a.complement() == b);
    let (least, count) = (least.saturating_sub(full + pairs), operands.len() as u32);
    match least {
        0 => Folded::Edge(Edge::UNIVERSE),
        _ if least > count => Folded::Edge(Edge::EMPTY),
        1 => fold_chain(Op::Union, operands, Edge::EMPTY),
        _ if least == count => fold_chain(Op::Intersection, operands, Edge::UNIVERSE),
        _ => Folded::Join { op: Op::AtLeast(least), complemented: false },
    }
}
