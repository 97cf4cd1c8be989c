//! Bounding boxes of boolean formulas: of each node, and of where each node matters.

use super::formula::{Formula, Op, Term};
use crate::Edge;
use rayweave_math::Bounds;

/// A box outside of which a node is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond {
    /// The box; infinite if the node has no bounds.
    pub within: Bounds,
    /// The value outside the box.
    pub inside: bool,
}

impl Beyond {
    const EMPTY: Beyond = Beyond { within: Bounds::EMPTY, inside: false };
    const UNIVERSE: Beyond = Beyond { within: Bounds::EMPTY, inside: true };

    /// The bounds of the complement.
    fn complement(self) -> Beyond {
        Beyond { inside: !self.inside, ..self }
    }

    /// A box that holds the solid.
    pub fn bounds(self) -> Bounds {
        if self.inside { Bounds::ALL } else { self.within }
    }

    /// The bounds of an operand.
    pub fn of(edge: Edge, nodes: &[Beyond]) -> Beyond {
        let plain = nodes[edge.node().index()];
        if edge.is_complemented() { plain.complement() } else { plain }
    }
}

/// For each node a box outside of which it is constant, given that each leaf is outside beyond its own box.
///
/// Computed from the leaves upwards. An intersection is outside wherever one operand is, so its box is the
/// intersection of the boxes of the bounded operands (for `a - b` that of `a`); an intersection of
/// complements is inside beyond all their boxes. The union is the dual. A parity or a count is constant
/// beyond all boxes. `leaves` has a box for each leaf number.
pub fn bounds(formula: &Formula, leaves: &[Bounds]) -> Vec<Beyond> {
    let mut nodes: Vec<Beyond> = Vec::with_capacity(formula.node_count());
    for (_, term, operands) in formula.nodes() {
        nodes.push(match term {
            Term::Empty => Beyond::EMPTY,
            Term::Universe => Beyond::UNIVERSE,
            Term::Leaf(leaf) => Beyond { within: leaves[leaf.index()], inside: false },
            Term::Join(op) => joined(op, operands, &nodes),
        });
    }
    nodes
}

/// A box around all outputs of the formula.
pub fn output_bounds(formula: &Formula, nodes: &[Beyond]) -> Bounds {
    let boxes = formula.outputs().iter().map(|&edge| Beyond::of(edge, nodes).bounds());
    boxes.fold(Bounds::EMPTY, |all, bounds| all.union(&bounds))
}

/// For each node a box outside of which its value affects no output.
///
/// Computed from the outputs downwards: an operand matters only where its user matters and is not constant.
/// Proof that operands may be replaced by their constants beyond their boxes: by induction from the leaves,
/// every user then still has its own constant beyond its own box; and inside, where it matters, it has the
/// right operands.
pub fn needs(formula: &Formula, nodes: &[Beyond]) -> Vec<Bounds> {
    let mut needs = vec![Bounds::EMPTY; formula.node_count()];
    formula.outputs().iter().for_each(|edge| needs[edge.node().index()] = Bounds::ALL);
    for (node, _, operands) in formula.nodes().rev() {
        let here = needs[node.index()].intersection(&nodes[node.index()].within);
        for edge in operands {
            let below = edge.node().index();
            // elsewhere it is constant
            if !here.intersection(&nodes[below].within).is_empty() {
                needs[below] = needs[below].union(&here);
            }
        }
    }
    needs
}

/// For each leaf the part of its box where it matters; empty for leaves that the formula does not contain.
pub fn leaf_needs(formula: &Formula, nodes: &[Beyond], leaf_count: usize) -> Vec<Bounds> {
    let needs = needs(formula, nodes);
    let mut leaves = vec![Bounds::EMPTY; leaf_count];
    for (node, term, _) in formula.nodes() {
        if let Term::Leaf(leaf) = term {
            let here = needs[node.index()].intersection(&nodes[node.index()].within);
            // a leaf may have several nodes
            leaves[leaf.index()] = leaves[leaf.index()].union(&here);
        }
    }
    leaves
}

fn joined(op: Op, operands: &[Edge], nodes: &[Beyond]) -> Beyond {
    let below = operands.iter().map(|&edge| Beyond::of(edge, nodes));
    let count = operands.len() as u32;
    match op {
        Op::Intersection => all(below),
        Op::Union => all(below.map(Beyond::complement)).complement(),
        Op::Difference if count == 0 => Beyond::EMPTY,
        Op::Difference => all(below.enumerate().map(|(k, b)| if k == 0 { b } else { b.complement() })),
        Op::AtLeast(0) => Beyond::UNIVERSE,
        Op::AtLeast(least) if least > count => Beyond::EMPTY,
        Op::AtLeast(1) => all(below.map(Beyond::complement)).complement(),
        Op::AtLeast(least) if least == count => all(below),
        Op::SymmetricDifference | Op::AtLeast(_) => {
            let within = below.clone().fold(Bounds::EMPTY, |all, b| all.union(&b.within));
            Beyond { within, inside: op.of(below.map(|b| b.inside)) }
        }
    }
}

/// The intersection: outside beyond the box of any operand that is outside there; if there is none, inside
/// beyond all boxes.
fn all(operands: impl Iterator<Item = Beyond>) -> Beyond {
    let (mut bounded, mut holes) = (None::<Bounds>, Bounds::EMPTY);
    for Beyond { within, inside } in operands {
        match inside {
            true => holes = holes.union(&within),
            false => bounded = Some(bounded.map_or(within, |all| all.intersection(&within))),
        }
    }
    match bounded {
        Some(within) => Beyond { within, inside: false },
        None => Beyond { within: holes, inside: true },
    }
}
