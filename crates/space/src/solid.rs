//! Solids in R^d: shapes joined by boolean operators.

use crate::affine::Affine;
use crate::error::SpaceError;
use crate::program::Program;
use crate::shape::Shape;
use std::collections::{HashMap, HashSet};
use std::ops::{BitAnd, BitOr, BitXor, Not, Sub};
use std::sync::{Arc, OnceLock};

/// A solid in R^d: a boolean combination of shapes under affine maps.
///
/// A `Solid` is a shared handle: cloning it costs a reference count, whatever its size. Operators build new
/// solids and change none: `|` union, `&` intersection, `-` difference, `^` symmetric difference, `!`
/// complement. Constructors check their numbers. What tracing needs is computed once, at the first question.
///
/// Trees may be as deep as memory allows: no operation on them uses the call stack for depth.
#[derive(Clone)]
pub struct Solid<const D: usize>(Arc<Inner<D>>);

struct Inner<const D: usize> {
    node: Node<D>,
    program: OnceLock<Result<Arc<Program<D>>, SpaceError>>,
}

/// How a solid is made from others.
pub(crate) enum Node<const D: usize> {
    Vacuum,
    Plenum,
    Shape(Box<Shape<D>>),
    Complement(Solid<D>),
    /// Inside any, all, or an odd number.
    Join(Join, Vec<Solid<D>>),
    /// Inside the first and not inside the second.
    Difference([Solid<D>; 2]),
    Transformed(Box<Affine<D>>, Solid<D>),
    Named(Arc<str>, Solid<D>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Join {
    Union,
    Intersection,
    SymmetricDifference,
}

impl<const D: usize> Node<D> {
    /// The solids that this node is made from, in order.
    pub fn operands(&self) -> &[Solid<D>] {
        match self {
            Node::Vacuum | Node::Plenum | Node::Shape(_) => &[],
            Node::Complement(a) | Node::Transformed(_, a) | Node::Named(_, a) => std::slice::from_ref(a),
            Node::Join(_, all) => all,
            Node::Difference(both) => both,
        }
    }
}

impl<const D: usize> Solid<D> {
    fn new(node: Node<D>) -> Self {
        const { assert!(D > 0, "a space has at least one dimension") };
        Solid(Arc::new(Inner { node, program: OnceLock::new() }))
    }

    pub(crate) fn node(&self) -> &Node<D> {
        &self.0.node
    }

    /// The address of the node, by which shared sub-trees are recognised.
    pub(crate) fn address(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }

    /// True if more than one handle points at the node.
    pub(crate) fn is_shared(&self) -> bool {
        Arc::strong_count(&self.0) > 1
    }

    /// What tracing needs, compiled once.
    ///
    /// # Errors
    /// `Map` or `Overflow` where maps that are each well behaved are not so together.
    pub fn compile(&self) -> Result<Arc<Program<D>>, SpaceError> {
        self.0.program.get_or_init(|| Program::new(self).map(Arc::new)).clone()
    }

    /// Nothing: the neutral element of union.
    pub fn vacuum() -> Self {
        Solid::new(Node::Vacuum)
    }

    /// All of space: the neutral element of intersection.
    pub fn plenum() -> Self {
        Solid::new(Node::Plenum)
    }

    /// Inside any of the solids; the union of none is [`Solid::vacuum`].
    pub fn union(solids: impl IntoIterator<Item = Self>) -> Self {
        Solid::new(Node::Join(Join::Union, solids.into_iter().collect()))
    }

    /// Inside all of the solids; the intersection of none is [`Solid::plenum`].
    pub fn intersection(solids: impl IntoIterator<Item = Self>) -> Self {
        Solid::new(Node::Join(Join::Intersection, solids.into_iter().collect()))
    }

    /// Inside an odd number of the solids.
    pub fn symmetric_difference(solids: impl IntoIterator<Item = Self>) -> Self {
        Solid::new(Node::Join(Join::SymmetricDifference, solids.into_iter().collect()))
    }

    /// The same solid under a name, by which its leaves are called in answers where they have none of their own.
    pub fn named(&self, name: &str) -> Self {
        Solid::new(Node::Named(name.into(), self.clone()))
    }

    /// The image under a map.
    pub fn apply(&self, map: Affine<D>) -> Self {
        Solid::new(Node::Transformed(Box::new(map), self.clone()))
    }

    /// The same solid in a space of N >= D dimensions, unbounded along the axes that are new.
    ///
    /// # Errors
    /// `Dimension` if N < D.
    pub fn extrude<const N: usize>(&self) -> Result<Solid<N>, SpaceError> {
        if N < D {
            return Err(SpaceError::Dimension { from: D, to: N });
        }
        let mut made: HashMap<usize, Solid<N>> = HashMap::new();
        for solid in self.operands_first() {
            let of = |part: &Solid<D>| made[&part.address()].clone();
            let node = match solid.node() {
                Node::Vacuum => Node::Vacuum,
                Node::Plenum => Node::Plenum,
                Node::Shape(shape) => Node::Shape(Box::new(shape.extruded())),
                Node::Complement(part) => Node::Complement(of(part)),
                Node::Join(join, parts) => Node::Join(*join, parts.iter().map(of).collect()),
                Node::Difference(parts) => Node::Difference(parts.each_ref().map(of)),
                Node::Transformed(map, part) => Node::Transformed(Box::new(map.extruded()), of(part)),
                Node::Named(name, part) => Node::Named(name.clone(), of(part)),
            };
            made.insert(solid.address(), Solid::new(node));
        }
        Ok(made.remove(&self.address()).unwrap_or_else(Solid::vacuum))
    }

    /// All nodes of the tree, each once, operands before what is made of them.
    fn operands_first(&self) -> Vec<&Self> {
        let (mut order, mut seen, mut waiting) = (Vec::new(), HashSet::new(), vec![(self, false)]);
        while let Some((solid, operands_done)) = waiting.pop() {
            if operands_done {
                order.push(solid);
            } else if seen.insert(solid.address()) {
                waiting.push((solid, true));
                waiting.extend(solid.node().operands().iter().map(|part| (part, false)));
            }
        }
        order
    }
}

impl<const D: usize> From<Shape<D>> for Solid<D> {
    fn from(shape: Shape<D>) -> Self {
        Solid::new(Node::Shape(Box::new(shape)))
    }
}

impl<const D: usize> std::fmt::Debug for Solid<D> {
    /// What is on top, without what is below it.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = match self.node() {
            Node::Vacuum => "vacuum",
            Node::Plenum => "plenum",
            Node::Shape(shape) => shape.kind,
            Node::Complement(_) => "complement",
            Node::Join(Join::Union, _) => "union",
            Node::Join(Join::Intersection, _) => "intersection",
            Node::Join(Join::SymmetricDifference, _) => "symmetric_difference",
            Node::Difference(_) => "difference",
            Node::Transformed(..) => "transformed",
            Node::Named(name, _) => name,
        };
        write!(f, "Solid<{D}>({name}, {} operand(s))", self.node().operands().len())
    }
}

impl<const D: usize> Drop for Inner<D> {
    fn drop(&mut self) {
        let mut waiting = Vec::new();
        take_operands(&mut self.node, &mut waiting);
        while let Some(solid) = waiting.pop() {
            if let Some(mut last) = Arc::into_inner(solid.0) {
                take_operands(&mut last.node, &mut waiting);
            }
        }
    }
}

/// Moves the operands out of a node that is about to be dropped.
fn take_operands<const D: usize>(node: &mut Node<D>, waiting: &mut Vec<Solid<D>>) {
    match std::mem::replace(node, Node::Vacuum) {
        Node::Vacuum | Node::Plenum | Node::Shape(_) => {}
        Node::Complement(part) | Node::Transformed(_, part) | Node::Named(_, part) => waiting.push(part),
        Node::Join(_, parts) => waiting.extend(parts),
        Node::Difference(parts) => waiting.extend(parts),
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $make:path) => {
        impl<const D: usize> $trait for Solid<D> {
            type Output = Solid<D>;

            fn $method(self, other: Solid<D>) -> Solid<D> {
                $make([self, other])
            }
        }

        impl<const D: usize> $trait<&Solid<D>> for &Solid<D> {
            type Output = Solid<D>;

            fn $method(self, other: &Solid<D>) -> Solid<D> {
                $make([self.clone(), other.clone()])
            }
        }
    };
}

operator!(BitOr, bitor, Solid::union);
operator!(BitAnd, bitand, Solid::intersection);
operator!(BitXor, bitxor, Solid::symmetric_difference);
operator!(Sub, sub, difference);

fn difference<const D: usize>(both: [Solid<D>; 2]) -> Solid<D> {
    Solid::new(Node::Difference(both))
}

impl<const D: usize> Not for Solid<D> {
    type Output = Solid<D>;

    fn not(self) -> Solid<D> {
        Solid::new(Node::Complement(self))
    }
}

impl<const D: usize> Not for &Solid<D> {
    type Output = Solid<D>;

    fn not(self) -> Solid<D> {
        !self.clone()
    }
}
