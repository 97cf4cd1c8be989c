//! Flattening of chains of one associative operator.

use super::formula::{Formula, Op, Renumbered, Term};
use crate::{Edge, NodeId};

/// Merges chains of one operator into one node with many operands; keeps the value and the order of leaves.
///
/// `a | (b | c)` becomes `a | b | c`, `a - b - (c | d)` becomes `a` minus all others, and a node with one
/// operand becomes that operand. Nodes that are used more than once are kept: merged into each of their
/// users, their operands would be repeated once per use, which is quadratic for a chain in which every member
/// is used, and exponential for nested uses.
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
    to.copy_outputs(formula, &mut out);
    out
}

/// True if [`flatten`] would change nothing.
pub(super) fn is_flat(formula: &Formula) -> bool {
    places(formula, &formula.uses()).iter().all(Option::is_none)
}

/// True if the operation on one operand is that operand.
fn is_identity(op: Op) -> bool {
    !matches!(op, Op::AtLeast(least) if least != 1)
}

/// The node that takes over the operands of a merged node, and how.
#[derive(Clone, Copy)]
struct Place {
    /// The operation of that node.
    op: Op,
    /// True if it takes their complements.
    complemented: bool,
    /// True if the first of them is its first operand.
    first: bool,
}

/// For each node that is merged into its only user, the place of its operands; `None` for nodes that are
/// kept.
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

/// True if a node at a place may be replaced by its operands.
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

/// Collects the operands of a node and of all nodes merged into it, in order; true if the result is
/// complemented.
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
        // a symmetric difference pulls complements out; elsewhere only nodes with one operand can be
        // complemented
        let complemented = edge.is_complemented() && op != Op::SymmetricDifference;
        odd ^= edge.is_complemented() && op == Op::SymmetricDifference;
        let below = formula.operands(edge.node()).iter().rev();
        waiting.extend(below.map(|&edge| if complemented { edge.complement() } else { edge }));
    }
    odd
}
