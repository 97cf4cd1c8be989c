//! Pruning of parts that bounding boxes prove irrelevant.

use super::bounds::{Beyond, bounds, needs};
use super::formula::{Formula, Op, Renumbered, Term};
use crate::{Edge, NodeId};
use rayweave_math::Bounds;

/// An operand or output that is constant wherever it matters, by its bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrunedPart {
    /// The part that is replaced by a constant.
    pub part: Edge,
    /// The node that used it; `None` for an output.
    pub user: Option<NodeId>,
    /// The constant.
    pub inside: bool,
}

/// The reason why a part does not matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// It is constant everywhere: an intersection of parts with disjoint bounds, or the complement of one.
    /// Two disjoint parts are given if found.
    Constant(Option<(Edge, Edge)>),
    /// Disjoint from the rest of an intersection or difference, like `b` in `a - b` with disjoint bounds. The other
    /// operand is given.
    Apart(Edge),
    /// Absorbed in a union: the given operand, a complement, is inside wherever the part is.
    Absorbed(Edge),
    /// The rest of the formula decides the value wherever this part is.
    Decided,
}

/// Removes operands that are constant wherever they matter; keeps the value along every ray.
///
/// One rule covers parts that are provably empty, parts that are absorbed, and `b` in `a - b` with disjoint
/// bounds: an operand is replaced by its constant beyond its box ([`bounds()`]) if this box is disjoint from
/// the part of space where its user matters and is not constant ([`needs()`]; the proof is there). `leaves`
/// has, for each leaf number, a box beyond which no ray finds the leaf inside: grown by the error of computed
/// roots, so that parts in contact do not count as disjoint. The constants are left to
/// [`fold`](super::fold()).
pub fn prune(formula: &Formula, leaves: &[Bounds]) -> (Formula, Vec<PrunedPart>) {
    let nodes = bounds(formula, leaves);
    let needs = needs(formula, &nodes);
    let mut out = Formula::like(formula);
    let mut to = Renumbered::new(formula);
    let (mut operands, mut cuts) = (Vec::new(), Vec::new());
    let mut kept = |edge: Edge, user: Option<NodeId>, here: &Bounds, to: &Renumbered| {
        let beyond = Beyond::of(edge, &nodes);
        if edge.node().0 < 2 || !beyond.within.intersection(here).is_empty() {
            return to.edge(edge);
        }
        cuts.push(PrunedPart { part: edge, user, inside: beyond.inside });
        if beyond.inside { Edge::UNIVERSE } else { Edge::EMPTY }
    };
    for (node, term, all) in formula.nodes().skip(2) {
        let here = needs[node.index()].intersection(&nodes[node.index()].within);
        if !here.is_empty() {
            operands.clear();
            operands.extend(all.iter().map(|&edge| kept(edge, Some(node), &here, &to)));
            to.set(node, out.tagged(term, &operands, formula.tag(node)));
        }
    }
    formula.outputs().iter().for_each(|&edge| out.add_output(kept(edge, None, &Bounds::ALL, &to)));
    (out, cuts)
}

/// Maximum number of operands searched for one that explains a cut; limits the time for wide nodes.
const LOOKED_THROUGH: usize = 1000;

/// The reason for a cut; `nodes` are the [`bounds()`] of the formula before pruning.
pub fn reason(formula: &Formula, nodes: &[Beyond], cut: PrunedPart) -> Reason {
    let within = |edge: Edge| nodes[edge.node().index()].within;
    let part = within(cut.part);
    if part.is_empty() {
        return Reason::Constant(disjoint_pair(formula.operands(cut.part.node()), nodes));
    }
    let Some(user) = cut.user else { return Reason::Decided };
    // beyond its box the deciding operand is outside for an intersection, inside for a union
    let (decides, why): (bool, fn(Edge) -> Reason) = match formula.term(user) {
        Term::Join(Op::Intersection | Op::Difference) => (false, Reason::Apart),
        Term::Join(Op::Union) => (true, Reason::Absorbed),
        _ => return Reason::Decided,
    };
    let mut others = formula.operands(user).iter().take(LOOKED_THROUGH);
    let other = others.find(|&&edge| {
        Beyond::of(edge, nodes).inside == decides && within(edge).intersection(&part).is_empty()
    });
    other.map_or(Reason::Decided, |&edge| why(edge))
}

/// The first operand that is disjoint from an earlier one, as (earlier, later).
fn disjoint_pair(operands: &[Edge], nodes: &[Beyond]) -> Option<(Edge, Edge)> {
    let within = |edge: Edge| nodes[edge.node().index()].within;
    let mut common = Bounds::ALL;
    let looked_through = &operands[..operands.len().min(LOOKED_THROUGH)];
    for (k, &edge) in looked_through.iter().enumerate() {
        let before = common;
        common = common.intersection(&within(edge));
        if common.is_empty() && !before.is_empty() {
            let apart = |other: &&Edge| within(**other).intersection(&within(edge)).is_empty();
            return looked_through[..k].iter().find(apart).map(|&other| (other, edge));
        }
    }
    None
}
