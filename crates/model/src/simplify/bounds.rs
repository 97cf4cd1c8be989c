//! CSG-tight bounds.

use super::formula::{Formula, Op, Term};
use crate::Edge;
use rayweave_math::Bounds;

/// A box beyond which a node has one and the same value everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond {
    /// The box; infinite where the node has no bounds.
    pub within: Bounds,
    /// The value outside the box.
    pub inside: bool,
}

impl Beyond {
    const EMPTY: Beyond = Beyond { within: Bounds::EMPTY, inside: false };
    const UNIVERSE: Beyond = Beyond { within: Bounds::EMPTY, inside: true };

    /// The same for the complement.
    fn complement(self) -> Beyond {
        Beyond { inside: !self.inside, ..self }
    }

    /// A box that holds the solid.
    pub fn bounds(self) -> Bounds {
        if self.inside { Bounds::ALL } else { self.within }
    }

    /// The box and value of an operand.
    pub fn of(edge: Edge, nodes: &[Beyond]) -> Beyond {
        let plain = nodes[edge.node().index()];
        if edge.is_complemented() { plain.complement() } else { plain }
    }
}

/// Promise: for each node a box beyond which it is constant, if each leaf is outside beyond its own box.
///
/// From the leaves upwards. An intersection is outside wherever one operand is, so that its box is the intersection
/// of the boxes of the operands that are bounded (for `a - b` that of `a`); the intersection of complements is inside
/// beyond all of their boxes. The union is its dual. The parity and count of operands are fixed beyond all boxes.
/// `leaves` has a box for each leaf number.
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

/// Promise: a box around everything that is asked of the formula.
pub fn output_bounds(formula: &Formula, nodes: &[Beyond]) -> Bounds {
    let boxes = formula.outputs().iter().map(|&edge| Beyond::of(edge, nodes).bounds());
    boxes.fold(Bounds::EMPTY, |all, bounds| all.union(&bounds))
}

/// Promise: for each node a box outside of which its value does not matter to any output.
///
/// From the outputs downwards: an operand matters only where its user is not constant whatever its operands are, and
/// matters itself. Where operands are taken for what they are beyond their own boxes, their users still are what they are
/// beyond theirs, by induction from the leaves; and within, where they matter, they get the right operands.
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

/// Promise: for each leaf the part of its box where it matters; nothing of leaves that the formula does not have.
pub fn leaf_needs(formula: &Formula, nodes: &[Beyond], leaf_count: usize) -> Vec<Bounds> {
    let needs = needs(formula, nodes);
    let mut leaves = vec![Bounds::EMPTY; leaf_count];
    for (node, term, _) in formula.nodes() {
        if let Term::Leaf(leaf) = term {
            let here = needs[node.index()].intersection(&nodes[node.index()].within);
            // a leaf may be more than one node
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

/// The intersection: outside beyond the box of any operand that is outside beyond it, else inside beyond all boxes.
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
