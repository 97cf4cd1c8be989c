//! Positive form (De Morgan).

use super::formula::{Formula, Op, Term};
use crate::{Edge, NodeId};

/// Moves complements to leaves and symmetric differences and removes differences; keeps the value.
///
/// `~(a | b)` becomes `~a & ~b`, `a - b` becomes `a & ~b`, "not at least k of n" becomes "at least n - k + 1
/// of the complements" (De Morgan, 1847). A symmetric difference takes over the complements of its operands.
/// A node that is used both plain and complemented is written twice, so that the result has at most twice the
/// nodes.
pub fn positive(formula: &Formula) -> Formula {
    let needed = needed(formula);
    let mut out = Formula::like(formula);
    // indexed by node, then by complement
    let mut to = vec![[Edge::EMPTY, Edge::UNIVERSE]; formula.node_count()];
    to[1] = [Edge::UNIVERSE, Edge::EMPTY];
    let mut operands = Vec::new();
    for (node, term, _) in formula.nodes() {
        let [plain, complemented] = needed[node.index()];
        match term {
            Term::Empty | Term::Universe => {}
            _ if !(plain || complemented) => {}
            Term::Leaf(_) | Term::Join(Op::SymmetricDifference) => {
                let odd = collect_odd(formula, node, &to, &mut operands);
                let edge = out.tagged(term, &operands, formula.tag(node));
                let edge = if odd { edge.complement() } else { edge };
                to[node.index()] = [edge, edge.complement()];
            }
            Term::Join(op) => {
                for side in [false, true] {
                    if needed[node.index()][usize::from(side)] {
                        let op = collect(formula, node, op, side, &to, &mut operands);
                        let edge = out.tagged(Term::Join(op), &operands, formula.tag(node));
                        to[node.index()][usize::from(side)] = edge;
                    }
                }
            }
        }
    }
    for &output in formula.outputs() {
        out.add_output(to[output.node().index()][usize::from(output.is_complemented())]);
    }
    out
}

/// True if [`positive`] would change nothing.
pub(super) fn is_positive(formula: &Formula) -> bool {
    let uses = formula.uses();
    let keeps = |edge: &Edge| !edge.is_complemented() || keeps_complements(formula.term(edge.node()));
    let mut used = formula.nodes().filter(|(node, ..)| uses[node.index()] > 0);
    used.all(|(_, term, operands)| term != Term::Join(Op::Difference) && operands.iter().all(keeps))
        && formula.outputs().iter().all(keeps)
}

/// True if a complement of such a node is kept as it is.
pub(super) fn keeps_complements(term: Term) -> bool {
    !matches!(term, Term::Join(op) if op != Op::SymmetricDifference)
}

/// For each node whether it is needed plain, and whether complemented.
fn needed(formula: &Formula) -> Vec<[bool; 2]> {
    let mut needed = vec![[false; 2]; formula.node_count()];
    let mark = |needed: &mut Vec<[bool; 2]>, edge: Edge, complemented: bool| {
        needed[edge.node().index()][usize::from(edge.is_complemented() ^ complemented)] = true;
    };
    formula.outputs().iter().for_each(|&edge| mark(&mut needed, edge, false));
    for (node, term, operands) in formula.nodes().rev() {
        let [plain, complemented] = needed[node.index()];
        match term {
            Term::Join(Op::SymmetricDifference) if plain || complemented => {
                operands.iter().for_each(|&edge| mark(&mut needed, edge, edge.is_complemented()));
            }
            Term::Join(op) => {
                for side in [false, true] {
                    if needed[node.index()][usize::from(side)] {
                        for (k, &edge) in operands.iter().enumerate() {
                            mark(&mut needed, edge, side ^ (op == Op::Difference && k > 0));
                        }
                    }
                }
            }
            _ => {}
        }
    }
    needed
}

/// Collects the operands of a symmetric difference without complements; true if an odd number of them had
/// one.
fn collect_odd(formula: &Formula, node: NodeId, to: &[[Edge; 2]], operands: &mut Vec<Edge>) -> bool {
    operands.clear();
    let mut odd = false;
    for &edge in formula.operands(node) {
        let plain = to[edge.node().index()][0];
        let (plain, turned) =
            if plain.is_complemented() { (plain.complement(), true) } else { (plain, false) };
        odd ^= edge.is_complemented() ^ turned;
        operands.push(plain);
    }
    odd
}

/// Collects the operands of a node, or of its complement, and returns the operation that joins them.
fn collect(
    formula: &Formula,
    node: NodeId,
    op: Op,
    side: bool,
    to: &[[Edge; 2]],
    operands: &mut Vec<Edge>,
) -> Op {
    operands.clear();
    let all = formula.operands(node);
    operands.extend(all.iter().enumerate().map(|(k, edge)| {
        let complemented = edge.is_complemented() ^ side ^ (op == Op::Difference && k > 0);
        to[edge.node().index()][usize::from(complemented)]
    }));
    match (op, side) {
        (Op::Union, false) | (Op::Intersection, true) => Op::Union,
        // an empty difference is empty
        (Op::Difference, false) if all.is_empty() => Op::Union,
        (Op::Difference, true) if all.is_empty() => Op::Intersection,
        (Op::Difference, true) => Op::Union,
        (Op::AtLeast(least), true) => Op::AtLeast((all.len() as u32 + 1).saturating_sub(least)),
        (Op::AtLeast(least), false) => Op::AtLeast(least),
        _ => Op::Intersection,
    }
}
