//! The number of leaves of a model, counted before they are made.
//!
//! A solid may be used many times, and each use under a different map makes its own leaves: forty steps of
//! `s = s | s.translate(v)` describe 2^40 of them. The count visits each shared solid once.

use crate::number_map::{NumberMap, NumberSet};
use crate::{CompileError, CompileProblem, Node, Solid};
use rayweave_math::Affine;
use rayweave_shape::primitive::Primitive;

/// The number of leaves that a description of this size may make.
struct Allowance {
    /// The number that any description may make.
    always: u64,
    /// The number for each solid and copy of the description. It limits leaves that come from repetition, not those that were
    /// described one by one.
    per_node: u64,
}

/// The number of faces of a polyhedron that take as much memory as a leaf of another kind.
const FACES_PER_LEAF: u64 = 8;

/// For solids built by a program.
const BUILT: Allowance = Allowance { always: 1 << 24, per_node: 64 };

/// For model files, where a small file must not cost much: compiling takes up to 2 kB for each leaf.
const READ: Allowance = Allowance { always: 500_000, per_node: 8 };

/// The number of nodes that lowering may visit for each leaf: maps, names and operators.
const VISITS_PER_LEAF: u64 = 16;

/// Rejects solids whose repeated parts make too many leaves to compile.
pub(crate) fn check(solids: &[&Solid]) -> Result<(), CompileError> {
    BUILT.check(solids)
}

/// Rejects solids whose repeated parts make more leaves than a file may: 500,000, or 8 for each solid and copy that the file
/// describes. Takes less time than compiling the solids.
///
/// # Errors
///
/// [`CompileProblem::Repeated`].
pub fn check_repetition(solids: &[&Solid]) -> Result<(), CompileError> {
    READ.check(solids)
}

impl Allowance {
    fn check(&self, solids: &[&Solid]) -> Result<(), CompileError> {
        if expanded(solids, self.always).is_some() {
            return Ok(());
        }
        let nodes = distinct(solids);
        let limit = self.always.max(self.per_node.saturating_mul(nodes));
        match limit > self.always && expanded(solids, limit).is_some() {
            true => Ok(()),
            false => Err(CompileError {
                path: "model".to_owned(),
                problem: CompileProblem::Repeated { nodes, limit },
            }),
        }
    }
}

impl Solid {
    /// True if compiling the solid makes more leaves than this; takes time in proportion to `most` at worst.
    pub fn has_more_leaves_than(&self, most: u64) -> bool {
        expanded(&[self], most).is_none()
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

/// A solid in a context of its own, under a map or name: there each of its parts is lowered once, as in `lower`.
struct Frame<'a> {
    /// The address of the solid; 0 for the whole group.
    address: usize,
    size: Size,
    waiting: Vec<&'a Solid>,
    seen: NumberSet<usize>,
}

impl<'a> Frame<'a> {
    fn new(address: usize, waiting: Vec<&'a Solid>) -> Frame<'a> {
        Frame { address, size: Size::default(), waiting, seen: NumberSet::default() }
    }
}

/// The number of leaves and copies of all groups; `None` if it exceeds `most`, or if there are too many visits.
fn expanded(solids: &[&Solid], most: u64) -> Option<u64> {
    let mut total = Size::default();
    let mut known: NumberMap<usize, Size> = NumberMap::default();
    let mut prototypes: Vec<&Solid> = Vec::new();
    let mut is_prototype: NumberSet<usize> = NumberSet::default();
    let mut next = 0;
    let mut roots: Vec<&Solid> = solids.to_vec();
    loop {
        total.add(group(roots, &mut known, most, |inner| {
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

/// The size of one group. `place` receives the solids that are placed several times.
fn group<'a>(
    roots: Vec<&'a Solid>,
    known: &mut NumberMap<usize, Size>,
    most: u64,
    mut place: impl FnMut(&'a Solid),
) -> Option<Size> {
    let mut frames = vec![Frame::new(0, roots)];
    while let Some(frame) = frames.last_mut() {
        // each finished or open frame is a part of the whole, so that the first one above the limit decides
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
        if solid.is_shared() && !frame.seen.insert(solid.address()) {
            continue;
        }
        frame.size.visits += 1;
        match solid.node() {
            Node::Empty | Node::Universe => {}
            Node::Primitive(shape) => frame.size.leaves += weight(shape),
            Node::Placed(inner, copies) if copies.len() != 1 => {
                frame.size.leaves = frame.size.leaves.saturating_add(copies.len() as u64);
                if !copies.is_empty() {
                    place(inner);
                }
            }
            // the identity makes no context
            Node::Transformed(map, inner) if *map == Affine::IDENTITY => frame.waiting.push(inner),
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

/// The number of leaves that a shape counts for: a polyhedron is one leaf and may have any number of faces.
fn weight(shape: &Primitive) -> u64 {
    match shape {
        Primitive::Convex(polyhedron) => 1 + polyhedron.planes().len() as u64 / FACES_PER_LEAF,
        _ => 1,
    }
}

/// A shape under a few maps and names, and the number of visits to it; `None` for other solids.
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

/// The number of different nodes and copies of the description.
fn distinct(solids: &[&Solid]) -> u64 {
    let (mut waiting, mut seen, mut copies) = (solids.to_vec(), NumberSet::default(), 0u64);
    while let Some(solid) = waiting.pop() {
        if seen.insert(solid.address()) {
            copies = copies.saturating_add(match solid.node() {
                Node::Placed(_, maps) => maps.len() as u64,
                // what it counts for beyond its node
                Node::Primitive(shape) => weight(shape) - 1,
                _ => 0,
            });
            waiting.extend(solid.node().operand_refs());
        }
    }
    copies.saturating_add(seen.len() as u64)
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
        assert!(rows.has_more_leaves_than(READ.always));
        let placed = ball.place(vec![Affine::translate([1.0, 0.0, 0.0].into()); 1 << 20]);
        // compiling them would take seconds
        check_repetition(&[&rows, &placed]).unwrap();
        check(&[&rows, &placed]).unwrap();
    }

    /// A polyhedron counts for its faces, both where it is described and where it is repeated.
    #[test]
    fn faces_count() {
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

    #[test]
    fn files_may_repeat_less_than_programs() {
        let ball = Solid::from(build("sphere", &[("radius", 1.0.into())]).unwrap());
        let doubled = (0..20).fold(ball, |s, k| &s | s.translate([f64::from(k), 0.0, 0.0]));
        check(&[&doubled]).unwrap();
        let error = check_repetition(&[&doubled]).unwrap_err();
        assert_eq!(error.problem, CompileProblem::Repeated { nodes: 41, limit: 500_000 });
    }
}
