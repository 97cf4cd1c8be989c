//! Rings: parts of space between two coaxial cylinders, outside of which some leaves do not matter.
//!
//! A detailed solid of revolution is a union of thin rings. The box around a ring is mostly empty, and a ray along the axis passes
//! the boxes of all of them; an evaluator can exclude the rings themselves.

use crate::boxes::Boxes;
use crate::simplify::{Formula, Op, Term};
use crate::{LeafId, NodeId, Program, Prototype, PrototypeId};
use rayweave_math::{Bounds, Vec3};
use rayweave_shape::surface::{Cylinder, Surface};

/// A ring about an axis parallel to z, with leaves that matter nowhere else.
///
/// The leaves are operands of one intersection, below it, and only of it; one of them is the outer cylinder. Along a ray that misses
/// the ring the intersection is empty, and so it is if all leaves of the ring are taken to be outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    /// The position of the axis.
    pub centre: [f64; 2],
    /// The inner and the outer radius, grown by the margins of the leaves.
    pub radii: [f64; 2],
    /// The lowest and the highest z, grown likewise.
    pub heights: [f64; 2],
    /// The leaves, numbered within the group.
    pub leaves: Vec<u32>,
}

impl Program {
    /// The rings of a group that have an inner cylinder; none if there are fewer than `least`. `matters` are the boxes of
    /// [`Program::matters`].
    ///
    /// Computed on each call, in time linear in the size of the group.
    pub fn rings(&self, group: &Prototype, matters: &[Bounds], least: usize) -> Vec<Ring> {
        let upright = group.leaves.clone().filter(|&leaf| self.upright_cylinder(LeafId(leaf)).is_some());
        if upright.take(2 * least).count() < 2 * least {
            return Vec::new();
        }
        let formula = group.expression.formula();
        let uses = formula.uses();
        let inner = |id: PrototypeId| self.prototype(id).extent;
        let boxes = Boxes { leaves: &self.leaves, surfaces: &self.surfaces, inner };
        let grown = |leaf: u32| boxes.grown((group.leaves.start + leaf) as usize, &group.ball).1;
        let mut rings = Vec::new();
        // users before their operands: the outermost ring of a leaf is found first
        let mut is_taken = vec![false; matters.len()];
        for (node, term, operands) in formula.nodes().rev() {
            let is_intersection = term == Term::Join(Op::AtLeast(operands.len() as u32));
            if !is_intersection || uses[node.index()] == 0 {
                continue;
            }
            let Some((centre, [inner, outer])) = self.radii(group, &formula, &uses, node) else { continue };
            let mut leaves = leaves_below(&formula, &uses, node);
            leaves.retain(|&leaf| !std::mem::replace(&mut is_taken[leaf as usize], true));
            let margin = leaves.iter().map(|&leaf| grown(leaf)).fold(0.0, f64::max);
            let around = leaves.iter().fold(Bounds::EMPTY, |all, &leaf| all.union(&matters[leaf as usize]));
            if !around.is_finite() || around.is_empty() || !margin.is_finite() {
                continue;
            }
            let (radii, heights) = ([inner - margin, outer + margin], [around.lo.z, around.hi.z]);
            rings.push(Ring { centre, radii, heights, leaves });
        }
        rings
    }

    /// The cylinder parallel to z that is the only facet of a leaf; true if the leaf is inside of it.
    fn upright_cylinder(&self, leaf: LeafId) -> Option<(&Cylinder, bool)> {
        let [facet] = self.leaf(leaf).facets() else { return None };
        match &self.surface(facet.surface()).surface {
            Surface::Cylinder(cylinder) => {
                (cylinder.axis.abs() == Vec3::Z).then_some((cylinder, facet.inside()))
            }
            _ => None,
        }
    }

    /// The axis and the radii of an intersection with two coaxial cylinders that no other part uses, outside of one and inside of
    /// the other.
    fn radii(
        &self,
        group: &Prototype,
        formula: &Formula,
        uses: &[u32],
        node: NodeId,
    ) -> Option<([f64; 2], [f64; 2])> {
        let mut found: [Option<([f64; 2], f64)>; 2] = [None; 2];
        for edge in formula.operands(node) {
            let Term::Leaf(leaf) = formula.term(edge.node()) else { continue };
            let own = LeafId(group.leaves.start + leaf.0);
            let Some((cylinder, is_inside)) = self.upright_cylinder(own) else { continue };
            if uses[edge.node().index()] == 1 {
                let is_outer = is_inside != edge.is_complemented();
                // the outer cylinder has to be a leaf that is outside far away
                if !is_outer || !edge.is_complemented() {
                    let centre = [cylinder.point.x, cylinder.point.y];
                    found[usize::from(is_outer)].get_or_insert((centre, cylinder.radius));
                }
            }
        }
        match found {
            [Some((a, inner)), Some((b, outer))] if a == b && inner < outer => Some((a, [inner, outer])),
            _ => None,
        }
    }
}

/// The leaves below a node that no other part of the formula uses.
fn leaves_below(formula: &Formula, uses: &[u32], node: NodeId) -> Vec<u32> {
    let (mut leaves, mut waiting) = (Vec::new(), vec![node]);
    while let Some(node) = waiting.pop() {
        if let Term::Leaf(leaf) = formula.term(node) {
            leaves.push(leaf.0);
        }
        waiting.extend(
            formula.operands(node).iter().map(|edge| edge.node()).filter(|own| uses[own.index()] == 1),
        );
    }
    leaves.sort_unstable();
    leaves
}
