//! Solids in R^d: boolean expressions (CSG trees) over shapes and affine maps.

use crate::affine::Affine;
use crate::error::SpaceError;
use crate::program::Program;
use crate::shape::Shape;
use std::collections::{HashMap, HashSet};
use std::ops::{BitAnd, BitOr, BitXor, Not, Sub};
use std::sync::{Arc, OnceLock};

/// A solid in R^d: a boolean combination of shapes under affine maps.
///
/// A `Solid` is a shared handle: cloning increments a reference count. Operators build new solids: `|` union, `&` intersection,
/// `-` difference, `^` symmetric difference, `!` complement. Constructors validate their arguments. A solid is compiled once,
/// at the first query.
///
/// Trees may be as deep as memory allows: no operation recurses on the call stack.
#[derive(Clone)]
pub struct Solid<const D: usize>(Arc<Inner<D>>);

struct Inner<const D: usize> {
    node: Node<D>,
    program: OnceLock<Result<Arc<Program<D>>, SpaceError>>,
}

/// A node of the expression.
pub(crate) enum Node<const D: usize> {
    Empty,
    Universe,
    Shape(Box<Shape<D>>),
    Complement(Solid<D>),
    /// Inside any, all, or an odd number of the operands.
    Join(Join, Vec<Solid<D>>),
    /// Inside the first, outside the second.
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
    /// The operands of the node, in order.
    pub fn operands(&self) -> &[Solid<D>] {
        match self {
            Node::Empty | Node::Universe | Node::Shape(_) => &[],
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

    /// The address of the node, which identifies shared subtrees.
    pub(crate) fn address(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }

    /// True if several handles refer to the node.
    pub(crate) fn is_shared(&self) -> bool {
        Arc::strong_count(&self.0) > 1
    }

    /// The compiled solid, computed once.
    ///
    /// # Errors
    /// `Map` or `Overflow` if the composition of maps is singular or overflows.
    pub fn compile(&self) -> Result<Arc<Program<D>>, SpaceError> {
        self.0.program.get_or_init(|| Program::new(self).map(Arc::new)).clone()
    }

    /// The empty solid: the neutral element of union.
    pub fn empty() -> Self {
        Solid::new(Node::Empty)
    }

    /// The whole space: the neutral element of intersection.
    pub fn universe() -> Self {
        Solid::new(Node::Universe)
    }

    /// Inside any of the solids; the union of none is [`Solid::empty`].
    pub fn union(solids: impl IntoIterator<Item = Self>) -> Self {
        Solid::new(Node::Join(Join::Union, solids.into_iter().collect()))
    }

    /// Inside all of the solids; the intersection of none is [`Solid::universe`].
    pub fn intersection(solids: impl IntoIterator<Item = Self>) -> Self {
        Solid::new(Node::Join(Join::Intersection, solids.into_iter().collect()))
    }

    /// Inside an odd number of the solids.
    pub fn symmetric_difference(solids: impl IntoIterator<Item = Self>) -> Self {
        Solid::new(Node::Join(Join::SymmetricDifference, solids.into_iter().collect()))
    }

    /// The solid with a name, which results use for leaves without a name of their own.
    pub fn named(&self, name: &str) -> Self {
        Solid::new(Node::Named(name.into(), self.clone()))
    }

    /// The image under a map.
    pub fn apply(&self, map: Affine<D>) -> Self {
        Solid::new(Node::Transformed(Box::new(map), self.clone()))
    }

    /// The solid extruded to a space of N >= D dimensions, unbounded along the additional axes.
    ///
    /// # Errors
    /// `Dimension` if N < D.
    pub fn extrude<const N: usize>(&self) -> Result<Solid<N>, SpaceError> {
        if N < D {
            return Err(SpaceError::Dimension { from: D, to: N });
        }
        let mut made: HashMap<usize, Solid<N>> = HashMap::new();
        for solid in self.operands_first() {
            let extruded = |part: &Solid<D>| made[&part.address()].clone();
            let node = match solid.node() {
                Node::Empty => Node::Empty,
                Node::Universe => Node::Universe,
                Node::Shape(shape) => Node::Shape(Box::new(shape.extruded())),
                Node::Complement(part) => Node::Complement(extruded(part)),
                Node::Join(join, parts) => Node::Join(*join, parts.iter().map(extruded).collect()),
                Node::Difference(parts) => Node::Difference(parts.each_ref().map(extruded)),
                Node::Transformed(map, part) => Node::Transformed(Box::new(map.extruded()), extruded(part)),
                Node::Named(name, part) => Node::Named(name.clone(), extruded(part)),
            };
            made.insert(solid.address(), Solid::new(node));
        }
        Ok(made.remove(&self.address()).unwrap_or_else(Solid::empty))
    }

    /// All nodes of the tree, each once, in postorder.
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
    /// Prints the root node without its operands.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = match self.node() {
            Node::Empty => "empty",
            Node::Universe => "universe",
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

/// Moves the operands out of a node before it is dropped.
fn take_operands<const D: usize>(node: &mut Node<D>, waiting: &mut Vec<Solid<D>>) {
    match std::mem::replace(node, Node::Empty) {
        Node::Empty | Node::Universe | Node::Shape(_) => {}
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
