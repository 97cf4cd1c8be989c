//! Chains of one operator.

use super::formula::{Formula, Op, Renumbered, Term};
use crate::{Edge, NodeId};

/// Promise: the same answer and the same order of leaves, with chains of one operator as one node with many operands.
///
/// `a | (b | c)` turns into `a | b | c`, `a - b - (c | d)` into `a` less all others, a node of one operand into that
/// operand. Nodes that are used more than once stay: merged into each of their users, their operands would be counted
/// once per use, which is quadratic in a chain whose every member is used, and exponential where uses are nested.
pub fn flatten(formula: &Formula) -> Formula {
    let uses = formula.uses();
    let places = places(formula, &uses);
    let mut out = Formula::like(formula);
    let mut to = Renumbered::new(formula);
    let (mut operands, mut waiting) = (Vec::new(), Vec::new());
    for (node, term, _) in formula.nodes() {
        match term {
            _ if uses[node.index()] == 0 || places[node.index()].is_some() => {}
            Term::Empty | Term::Universe => {}
            Term::Leaf(_) => to.set(node, out.tagged(term, &[], formula.tag(node))),
            Term::Join(op) => {
                let odd = collect(formula, node, op, &places, &to, &mut waiting, &mut operands);
                let edge = match operands[..] {
                    [only] if is_identity(op) => only,
                    _ => out.tagged(term, &operands, formula.tag(node)),
                };
                to.set(node, if odd { edge.complement() } else { edge });
            }
        }
    }
    to.ask_all(formula, &mut out);
    out
}

/// True if there is nothing to do for [`flatten`].
pub(super) fn is_flat(formula: &Formula) -> bool {
    places(formula, &formula.uses()).iter().all(Option::is_none)
}

/// True if the operation of one operand is that operand.
fn is_identity(op: Op) -> bool {
    !matches!(op, Op::AtLeast(least) if least != 1)
}

/// Where the operands of a node go.
#[derive(Clone, Copy)]
struct Place {
    /// The operation of the node that takes them.
    op: Op,
    /// True if it takes complements of them.
    complemented: bool,
    /// True if the first of them is the first operand there.
    first: bool,
}

/// For nodes whose operands go to their only user, or to where its own go: the place there.
fn places(formula: &Formula, uses: &[u32]) -> Vec<Option<Place>> {
    let mut places = vec![None; formula.node_count()];
    for (node, term, operands) in formula.nodes().rev() {
        let Term::Join(op) = term else { continue };
        if uses[node.index()] == 0 {
            continue;
        }
        let here = places[node.index()].unwrap_or(Place { op, complemented: false, first: true });
        for (k, &edge) in operands.iter().enumerate() {
            let complemented = here.complemented ^ edge.is_complemented();
            let place = Place { op: here.op, complemented, first: here.first && k == 0 };
            if uses[edge.node().index()] == 1 && goes_into(formula, edge.node(), place) {
                places[edge.node().index()] = Some(place);
            }
        }
    }
    places
}

/// True if a node may be replaced at a place by its operands.
fn goes_into(formula: &Formula, node: NodeId, place: Place) -> bool {
    let Term::Join(below) = formula.term(node) else { return false };
    let Place { op, complemented, first } = place;
    match formula.operands(node).len() {
        1 if is_identity(below) => true,
        _ if op == Op::SymmetricDifference => below == op,
        _ if complemented => false,
        // a constant, which is left to `fold`
        0 => false,
        _ if op == Op::Difference && !first => below == Op::Union,
        _ => below == op && !matches!(op, Op::AtLeast(_)),
    }
}

/// The operands of a node and of all that goes into it, in order; true if the complement is meant.
fn collect(
    formula: &Formula,
    node: NodeId,
    op: Op,
    places: &[Option<Place>],
    to: &Renumbered,
    waiting: &mut Vec<Edge>,
    operands: &mut Vec<Edge>,
) -> bool {
    operands.clear();
    waiting.extend(formula.operands(node).iter().rev());
    let mut odd = false;
    while let Some(edge) = waiting.pop() {
        if places[edge.node().index()].is_none() {
            operands.push(to.edge(edge));
            continue;
        }
        // a symmetric difference takes complements out; elsewhere only nodes of one operand have one
        let complemented = edge.is_complemented() && op != Op::SymmetricDifference;
        odd ^= edge.is_complemented() && op == Op::SymmetricDifference;
        let below = formula.operands(edge.node()).iter().rev();
        waiting.extend(below.map(|&edge| if complemented { edge.complement() } else { edge }));
    }
    odd
}
