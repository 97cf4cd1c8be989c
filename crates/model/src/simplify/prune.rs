//! Parts that bounds show not to matter.

use super::bounds::{Beyond, bounds, needs};
use super::formula::{Formula, Op, Renumbered, Term};
use crate::{Edge, NodeId};
use rayweave_math::Bounds;

/// An operand, or an output, that bounds show to be constant wherever it matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// What was replaced by a constant.
    pub part: Edge,
    /// The node that used it; none for an output.
    pub user: Option<NodeId>,
    /// The constant.
    pub inside: bool,
}

/// Why a part does not matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// It is the same everywhere: an intersection of parts whose bounds are disjoint, of which two are named, or the
    /// complement of one.
    Constant(Option<(Edge, Edge)>),
    /// Subtracted where nothing is: `a - b` with disjoint bounds. The other operand is named.
    Apart(Edge),
    /// Added where everything is: beyond the bounds of what this operand is the complement of.
    Absorbed(Edge),
    /// Elsewhere in the formula it is decided what is where this part is.
    Decided,
}

/// Promise: the same answer along every ray, without operands that are constant wherever they matter.
///
/// That is what is provably empty, what is provably absorbed, and `b` in `a - b` with disjoint bounds: all three are one
/// rule. An operand is replaced by what it is beyond its box ([`bounds()`]) if this box misses the part of space where
/// its user is not constant and matters ([`needs()`]; the proof is there). `leaves` has a box for each leaf number beyond which
/// no ray finds the leaf inside: grown by what roots can err by, so that parts that touch are not taken for disjoint. The
/// constants are left to [`fold`](super::fold()).
pub fn prune(formula: &Formula, leaves: &[Bounds]) -> (Formula, Vec<Cut>) {
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
        cuts.push(Cut { part: edge, user, inside: beyond.inside });
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
    formula.outputs().iter().for_each(|&edge| out.ask(kept(edge, None, &Bounds::ALL, &to)));
    (out, cuts)
}

/// So many operands are looked through for one to be named in a reason: of wide nodes not all, for the sake of time.
const LOOKED_THROUGH: usize = 1000;

/// Why a cut was made; `nodes` are the [`bounds()`] of the formula that was pruned.
pub fn reason(formula: &Formula, nodes: &[Beyond], cut: Cut) -> Reason {
    let within = |edge: Edge| nodes[edge.node().index()].within;
    let part = within(cut.part);
    if part.is_empty() {
        return Reason::Constant(disjoint_pair(formula.operands(cut.part.node()), nodes));
    }
    let Some(user) = cut.user else { return Reason::Decided };
    // what decides an intersection is outside beyond its box, what decides a union inside
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

/// The first operand that is disjoint from one before it, after that one.
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
