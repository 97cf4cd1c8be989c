//! The number of leaves of a model, counted before compilation creates them.
//!
//! A solid may be used many times, and each use under a different map creates leaves of its own: forty steps of
//! `s = s | s.translate(v)` describe 2^40 of them. The size of a solid under a map or name is computed once and
//! reused, so that the count needs far fewer visits than there are leaves.

use crate::number_map::{NumberMap, NumberSet};
use crate::{CompileError, CompileProblem, Node, Solid};
use rayweave_math::Affine;
use rayweave_shape::primitive::Primitive;

/// The limit on the number of leaves: `minimum`, or `per_node` times the size of the description, whichever is greater.
pub(crate) struct LeafLimit {
    /// The limit for small descriptions.
    minimum: u64,
    /// The number of leaves for each solid and copy in the description. It limits leaves that are copies of a solid used
    /// repeatedly; leaves described one by one stay below it.
    per_node: u64,
}

/// The number of polyhedron faces that take as much memory as a leaf of any other kind.
const FACES_PER_LEAF: u64 = 8;

/// The limit for solids built by a program.
pub(crate) const FOR_PROGRAMS: LeafLimit = LeafLimit { minimum: 1 << 24, per_node: 64 };

/// The limit for model files. It is lower, because a small file from an untrusted source must not exhaust memory: compiling
/// takes up to 2 kB of memory per leaf.
pub(crate) const FOR_FILES: LeafLimit = LeafLimit { minimum: 500_000, per_node: 8 };

/// The number of node visits during lowering (to maps, names, operators and shapes) that are accepted per leaf of the limit.
const VISITS_PER_LEAF: u64 = 16;

/// Rejects solids that expand to more leaves than a model file may describe: 500,000, or 8 for each solid and copy in the
/// file, whichever is greater. Faster than compiling the solids.
///
/// A copy of a placed solid counts as a leaf, and every 8 faces of a polyhedron count as one more.
///
/// # Errors
///
/// [`CompileProblem::Repeated`] if there are more leaves, or if compiling the solids visits more than 16 nodes per leaf of
/// the limit.
pub fn check_repetition(solids: &[&Solid]) -> Result<(), CompileError> {
    FOR_FILES.check(solids)
}

/// The number of leaves and copies that a solid expands to, or `most` if there are more. Faster than compiling it.
pub fn expanded_size(solid: &Solid, most: u64) -> u64 {
    leaf_count(&[solid], most).unwrap_or(most)
}

impl LeafLimit {
    /// Rejects solids that expand to more leaves.
    pub(crate) fn check(&self, solids: &[&Solid]) -> Result<(), CompileError> {
        let nodes = description_size(solids);
        let limit = self.minimum.max(self.per_node.saturating_mul(nodes));
        match leaf_count(solids, limit) {
            Some(_) => Ok(()),
            None => Err(CompileError {
                path: "model".to_owned(),
                problem: CompileProblem::Repeated { nodes, limit },
            }),
        }
    }
}

impl Solid {
    /// True if the compiled solid has more than `most` leaves, counted as in [`check_repetition`], or if compiling it visits
    /// more than `16 * most` nodes. The count stops when the size of a solid exceeds either limit.
    pub fn has_more_leaves_than(&self, most: u64) -> bool {
        leaf_count(&[self], most).is_none()
    }
}

/// The work of lowering a solid in one context.
#[derive(Clone, Copy, Default)]
struct Size {
    leaves: u64,
    visits: u64,
}

impl Size {
    fn add(&mut self, other: Size) {
        self.leaves = self.leaves.saturating_add(other.leaves);
        self.visits = self.visits.saturating_add(other.visits);
    }

    fn is_within(self, most_leaves: u64) -> bool {
        self.leaves <= most_leaves && self.visits <= most_leaves.saturating_mul(VISITS_PER_LEAF)
    }
}

/// The count of a solid in one context: under one map or name. As in `lower`, a shared part is visited once per context.
struct Frame<'a> {
    /// The address of the solid; 0 for the whole group.
    address: usize,
    /// The size of the parts visited so far.
    size: Size,
    /// The parts still to be visited.
    waiting: Vec<&'a Solid>,
    /// The addresses of the shared parts visited so far.
    seen: NumberSet<usize>,
}

impl<'a> Frame<'a> {
    fn new(address: usize, waiting: Vec<&'a Solid>) -> Frame<'a> {
        Frame { address, size: Size::default(), waiting, seen: NumberSet::default() }
    }
}

/// The number of leaves and copies of all groups; `None` if it exceeds `most`, or if the visits exceed
/// `most * VISITS_PER_LEAF`.
fn leaf_count(solids: &[&Solid], most: u64) -> Option<u64> {
    let mut total = Size::default();
    let mut known: NumberMap<usize, Size> = NumberMap::default();
    let mut prototypes: Vec<&Solid> = Vec::new();
    let mut is_prototype: NumberSet<usize> = NumberSet::default();
    let mut next = 0;
    let mut roots: Vec<&Solid> = solids.to_vec();
    loop {
        total.add(group_size(roots, &mut known, most, |inner| {
            if is_prototype.insert(inner.address()) {
                prototypes.push(inner);
            }
        })?);
        if !total.is_within(most) {
            return None;
        }
        let Some(&prototype) = prototypes.get(next) else { return Some(total.leaves) };
        next += 1;
        roots = vec![prototype];
    }
}

/// The size of one group; `None` if it exceeds the limits. Calls `place` for each solid that is placed more than once.
fn group_size<'a>(
    roots: Vec<&'a Solid>,
    known: &mut NumberMap<usize, Size>,
    most: u64,
    mut place: impl FnMut(&'a Solid),
) -> Option<Size> {
    let mut frames = vec![Frame::new(0, roots)];
    while let Some(frame) = frames.last_mut() {
        // a frame is part of the group, so if one exceeds the limit, so does the group
        if !frame.size.is_within(most) {
            return None;
        }
        let Some(solid) = frame.waiting.pop() else {
            let (address, size) = (frame.address, frame.size);
            frames.pop();
            let Some(outer) = frames.last_mut() else { return Some(size) };
            outer.size.add(size);
            known.insert(address, size);
            continue;
        };
        // a repeated solid counts, too: a union of many references to one solid takes that many steps in each context
        frame.size.visits += 1;
        if solid.is_shared() && !frame.seen.insert(solid.address()) {
            continue;
        }
        match solid.node() {
            Node::Empty | Node::Universe => {}
            Node::Primitive(shape) => frame.size.leaves += weight(shape),
            Node::Placed(inner, copies) if copies.len() != 1 => {
                frame.size.leaves = frame.size.leaves.saturating_add(copies.len() as u64);
                if !copies.is_empty() {
                    place(inner);
                }
            }
            // an identity map opens no context
            Node::Transformed(map, inner) if map.get() == Affine::IDENTITY => frame.waiting.push(inner),
            Node::Placed(inner, copies) if copies.label().is_none() && copies[0] == Affine::IDENTITY => {
                frame.waiting.push(inner);
            }
            Node::Transformed(_, inner) | Node::Named(_, inner) | Node::Placed(inner, _) => {
                if let Some((shape, visits)) = shape_within(inner) {
                    frame.size.add(Size { leaves: weight(shape), visits });
                    continue;
                }
                match known.get(&inner.address()) {
                    Some(&size) => frame.size.add(size),
                    None => frames.push(Frame::new(inner.address(), vec![inner])),
                }
            }
            other => frame.waiting.extend(other.operand_refs()),
        }
    }
    None
}

/// The number of leaves that a shape counts as: 1, and for a polyhedron 1 more for every [`FACES_PER_LEAF`] faces.
fn weight(shape: &Primitive) -> u64 {
    match shape {
        Primitive::Convex(polyhedron) => 1 + polyhedron.planes().len() as u64 / FACES_PER_LEAF,
        _ => 1,
    }
}

/// The shape below at most 3 maps and names, and the number of nodes visited to reach it; `None` for other solids.
fn shape_within(mut solid: &Solid) -> Option<(&Primitive, u64)> {
    for visits in 1..=4 {
        solid = match solid.node() {
            Node::Primitive(shape) => return Some((shape, visits)),
            Node::Transformed(_, inner) | Node::Named(_, inner) => inner,
            _ => return None,
        };
    }
    None
}

/// The size of the description: the number of distinct nodes and of copies; polyhedra count as in [`weight`].
fn description_size(solids: &[&Solid]) -> u64 {
    let (mut waiting, mut seen, mut size) = (solids.to_vec(), NumberSet::default(), 0u64);
    while let Some(solid) = waiting.pop() {
        // a node with one handle is met once
        if !solid.is_shared() || seen.insert(solid.address()) {
            size = size.saturating_add(match solid.node() {
                Node::Placed(_, maps) => 1 + maps.len() as u64,
                Node::Primitive(shape) => weight(shape),
                _ => 1,
            });
            waiting.extend(solid.node().operand_refs());
        }
    }
    size
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_shape::primitive::{Convex, build};

    #[test]
    fn many_different_parts_are_not_repetitions() {
        let ball = Solid::from(build("sphere", &[("radius", 1.0.into())]).unwrap());
        let pair = &ball | ball.translate([3.0, 0.0, 0.0]);
        let rows = Solid::union((0..300_000).map(|k| pair.translate([f64::from(k), 0.0, 0.0])));
        assert!(rows.has_more_leaves_than(FOR_FILES.minimum));
        let placed = ball.place(vec![Affine::translate([1.0, 0.0, 0.0].into()); 1 << 20]);
        // only counted: compiling the solids would take seconds
        check_repetition(&[&rows, &placed]).unwrap();
        FOR_PROGRAMS.check(&[&rows, &placed]).unwrap();
    }

    /// The faces of a polyhedron count, both in the size of the description and at each repetition.
    #[test]
    fn faces_of_polyhedra_count() {
        let wheel = |offset: f64| {
            let plane = |k: u32| [1.0, f64::from(k), 0.0, offset];
            Solid::from(Primitive::from(Convex::new((0..600_000).map(plane).collect()).unwrap()))
        };
        let one = wheel(1.0);
        let described: Vec<Solid> = (1..=7).map(|k| wheel(f64::from(k))).collect();
        assert!(one.has_more_leaves_than(75_000) && !one.has_more_leaves_than(75_001));
        check_repetition(&described.iter().collect::<Vec<_>>()).unwrap();
        let many = Solid::union((0..20).map(|k| one.translate([f64::from(k), 0.0, 0.0])));
        assert!(check_repetition(&[&many]).is_err());
    }

    /// The references to a shared solid count in each context.
    #[test]
    fn references_in_many_contexts_count() {
        let ball = Solid::from(build("sphere", &[("radius", 1.0.into())]).unwrap());
        let many = Solid::union((0..1000).map(|_| ball.clone()));
        let rows = Solid::union((0..1000).map(|k| (&ball | &many).translate([f64::from(k), 0.0, 0.0])));
        assert!(rows.has_more_leaves_than(50_000) && !rows.has_more_leaves_than(100_000));
    }

    #[test]
    fn files_may_repeat_less_than_programs() {
        let ball = Solid::from(build("sphere", &[("radius", 1.0.into())]).unwrap());
        let doubled = (0..20).fold(ball, |s, k| &s | s.translate([f64::from(k), 0.0, 0.0]));
        FOR_PROGRAMS.check(&[&doubled]).unwrap();
        let error = check_repetition(&[&doubled]).unwrap_err();
        assert_eq!(error.problem, CompileProblem::Repeated { nodes: 41, limit: 500_000 });
    }
}
