//! Solids as users build them: trees of shapes and boolean operators.

use crate::{Boundary, Copies};
use rayweave_math::{Affine, CompactAffine, Vec3};
use rayweave_shape::primitive::Primitive;
use std::ops::{BitAnd, BitOr, BitXor, Not, Sub};
use std::sync::Arc;

/// A solid: a boolean combination of primitives under affine maps.
///
/// A `Solid` is a shared handle: cloning it copies a reference, whatever its size. Operators build new solids
/// and modify none: `|` union, `&` intersection, `-` difference, `^` symmetric difference, `!` complement.
/// Nothing is checked or computed until [`crate::Program`] compiles it.
///
/// Trees may be as deep as memory allows: no operation on them is recursive.
#[derive(Clone)]
pub struct Solid(Arc<Inner>);

/// Owns the node so that dropping a deep tree is a loop and not a recursion.
struct Inner {
    node: Node,
    boundary: Option<Arc<dyn Boundary>>,
}

/// A node of the tree: a shape, or a way to make a solid from others.
#[derive(Clone)]
pub enum Node {
    /// The empty solid.
    Empty,
    /// The universe: all of space.
    Universe,
    /// A shape.
    Primitive(Primitive),
    /// Everything outside a solid.
    Complement(Solid),
    /// Points inside any of the operands; empty if there are none.
    Union(Vec<Solid>),
    /// Points inside all of the operands; the universe if there are none.
    Intersection(Vec<Solid>),
    /// Points inside the first and not inside the second.
    Difference(Solid, Solid),
    /// Points inside an odd number of the operands.
    SymmetricDifference(Vec<Solid>),
    /// The image under a map, `world_from_local`.
    Transformed(CompactAffine, Solid),
    /// The same solid with a name, which leaves without a name of their own inherit.
    Named(Arc<str>, Solid),
    /// The union of the images under several maps: one prototype with many instances.
    Placed(Solid, Copies),
}

/// A solid made of one medium, as part of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The name of the region.
    pub name: String,
    /// The space that it occupies, except where a later region has priority.
    pub solid: Solid,
    /// The number of its medium; 0 is the medium of the world.
    pub medium: u32,
}

impl Node {
    /// The operands of this node as a slice; empty for a difference, see [`Node::operand_refs`].
    pub fn operands(&self) -> &[Solid] {
        match self {
            Node::Empty | Node::Universe | Node::Primitive(_) => &[],
            Node::Complement(a) | Node::Transformed(_, a) | Node::Named(_, a) | Node::Placed(a, _) => {
                std::slice::from_ref(a)
            }
            Node::Union(all) | Node::Intersection(all) | Node::SymmetricDifference(all) => all,
            Node::Difference(..) => &[],
        }
    }
}

impl Solid {
    fn new(node: Node) -> Solid {
        Solid(Arc::new(Inner { node, boundary: None }))
    }

    /// The same solid, with a description of its boundary for programs that need facets. It must describe the set of points of
    /// this solid; only these programs and checks of operators use it, and equality of
    /// solids ignores it. A name of the solid precedes the names of its parts in those of faces: `plate.contour0.edge3.plane`.
    pub fn with_boundary(&self, boundary: Arc<dyn Boundary>) -> Solid {
        Solid(Arc::new(Inner { node: self.node().clone(), boundary: Some(boundary) }))
    }

    /// The description of the boundary, if the solid was made with one.
    pub fn boundary(&self) -> Option<&dyn Boundary> {
        self.0.boundary.as_deref()
    }

    /// The root node of this solid.
    pub fn node(&self) -> &Node {
        &self.0.node
    }

    /// The empty solid: the neutral element of union.
    pub fn empty() -> Solid {
        Solid::new(Node::Empty)
    }

    /// The universe: the neutral element of intersection.
    pub fn universe() -> Solid {
        Solid::new(Node::Universe)
    }

    /// Points inside any of the solids; the union of none is [`Solid::empty`].
    pub fn union(solids: impl IntoIterator<Item = Solid>) -> Solid {
        Solid::new(Node::Union(solids.into_iter().collect()))
    }

    /// Points inside all of the solids; the intersection of none is [`Solid::universe`].
    pub fn intersection(solids: impl IntoIterator<Item = Solid>) -> Solid {
        Solid::new(Node::Intersection(solids.into_iter().collect()))
    }

    /// Points inside an odd number of the solids.
    pub fn symmetric_difference(solids: impl IntoIterator<Item = Solid>) -> Solid {
        Solid::new(Node::SymmetricDifference(solids.into_iter().collect()))
    }

    /// The same solid with a name, which is part of the names of its faces in answers.
    pub fn named(&self, name: &str) -> Solid {
        Solid::new(Node::Named(name.into(), self.clone()))
    }

    /// The image under an affine map. A singular map is an error when the solid is compiled.
    pub fn apply(&self, world_from_local: Affine) -> Solid {
        Solid::new(Node::Transformed(world_from_local.into(), self.clone()))
    }

    /// The solid moved by a vector.
    pub fn translate(&self, by: impl Into<Vec3>) -> Solid {
        self.apply(Affine::translate(by.into()))
    }

    /// The solid rotated about an axis through the origin, right-handed, by an angle in degrees.
    pub fn rotate(&self, axis: impl Into<Vec3>, degrees: f64) -> Solid {
        self.apply(Affine::rotation(axis.into(), degrees))
    }

    /// The solid rotated about the x axis, +y towards +z, by an angle in degrees.
    pub fn rotate_x(&self, degrees: f64) -> Solid {
        self.rotate(Vec3::X, degrees)
    }

    /// The solid rotated about the y axis, +z towards +x, by an angle in degrees.
    pub fn rotate_y(&self, degrees: f64) -> Solid {
        self.rotate(Vec3::Y, degrees)
    }

    /// The solid rotated about the z axis, +x towards +y, by an angle in degrees.
    pub fn rotate_z(&self, degrees: f64) -> Solid {
        self.rotate(Vec3::Z, degrees)
    }

    /// The solid scaled about the origin by one factor per axis (`Vec3::splat(s)` for all three).
    pub fn scale(&self, factors: impl Into<Vec3>) -> Solid {
        self.apply(Affine::scale(factors.into()))
    }

    /// The solid mirrored in the plane through the origin with the given normal.
    pub fn mirror(&self, normal: impl Into<Vec3>) -> Solid {
        self.apply(Affine::mirror(normal.into()))
    }

    /// The union of the images under several maps. The solid is compiled once, however many maps there are.
    pub fn place(&self, transforms: impl Into<Arc<[Affine]>>) -> Solid {
        self.place_copies(Copies::new(transforms))
    }

    /// Like [`Solid::place`], for copies that may have a name and numbers of their own.
    pub fn place_copies(&self, copies: Copies) -> Solid {
        Solid::new(Node::Placed(self.clone(), copies))
    }

    /// True if both handles refer to the same node.
    pub fn is_same(&self, other: &Solid) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// The address of the node: the same for all handles of a node, and different for different nodes that exist at the same
    /// time.
    pub fn address(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }

    /// True if more than one handle refers to the node.
    pub(crate) fn is_shared(&self) -> bool {
        Arc::strong_count(&self.0) > 1
    }
}

impl From<Primitive> for Solid {
    fn from(primitive: Primitive) -> Solid {
        Solid::new(Node::Primitive(primitive))
    }
}

impl Drop for Inner {
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
fn take_operands(node: &mut Node, waiting: &mut Vec<Solid>) {
    match std::mem::replace(node, Node::Empty) {
        Node::Empty | Node::Universe | Node::Primitive(_) => {}
        Node::Complement(a) | Node::Transformed(_, a) | Node::Named(_, a) | Node::Placed(a, _) => {
            waiting.push(a)
        }
        Node::Union(all) | Node::Intersection(all) | Node::SymmetricDifference(all) => waiting.extend(all),
        Node::Difference(a, b) => waiting.extend([a, b]),
    }
}

impl PartialEq for Solid {
    /// Structural equality: built in the same way from equal parts. Two solids that fill the same space may
    /// differ.
    fn eq(&self, other: &Solid) -> bool {
        let mut waiting = vec![(self, other)];
        let mut seen = std::collections::HashSet::new();
        while let Some((a, b)) = waiting.pop() {
            // sub-trees may be shared many times: each pair of nodes is compared once
            if a.is_same(b) || !seen.insert((a.address(), b.address())) {
                continue;
            }
            if !same_head(a.node(), b.node()) {
                return false;
            }
            let pairs = a.node().operand_refs().zip(b.node().operand_refs());
            waiting.extend(pairs);
        }
        true
    }
}

impl Node {
    /// The map and the solid under it, for a transformed solid or a single copy.
    pub fn single_map(&self) -> Option<(Affine, &Solid)> {
        match self {
            Node::Transformed(map, inner) => Some((map.get(), inner)),
            Node::Placed(inner, copies) if copies.len() == 1 => Some((copies[0], inner)),
            _ => None,
        }
    }

    /// The operands in order, for every kind of node.
    pub fn operand_refs(&self) -> impl DoubleEndedIterator<Item = &Solid> {
        let (first, second): (&[Solid], Option<&Solid>) = match self {
            Node::Difference(a, b) => (std::slice::from_ref(a), Some(b)),
            other => (other.operands(), None),
        };
        first.iter().chain(second)
    }
}

/// True if two nodes are equal apart from their operands.
fn same_head(a: &Node, b: &Node) -> bool {
    match (a, b) {
        (Node::Primitive(p), Node::Primitive(q)) => p == q,
        (Node::Transformed(p, _), Node::Transformed(q, _)) => p == q,
        (Node::Named(p, _), Node::Named(q, _)) => p == q,
        (Node::Placed(_, p), Node::Placed(_, q)) => p == q,
        (Node::Union(p), Node::Union(q))
        | (Node::Intersection(p), Node::Intersection(q))
        | (Node::SymmetricDifference(p), Node::SymmetricDifference(q)) => p.len() == q.len(),
        _ => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $doc:literal, $make:path) => {
        impl $trait for Solid {
            type Output = Solid;
            #[doc = $doc]
            fn $method(self, other: Solid) -> Solid {
                Solid::new($make(self, other))
            }
        }
        impl $trait<&Solid> for &Solid {
            type Output = Solid;
            #[doc = $doc]
            fn $method(self, other: &Solid) -> Solid {
                Solid::new($make(self.clone(), other.clone()))
            }
        }
        impl $trait<Solid> for &Solid {
            type Output = Solid;
            #[doc = $doc]
            fn $method(self, other: Solid) -> Solid {
                Solid::new($make(self.clone(), other))
            }
        }
        impl $trait<&Solid> for Solid {
            type Output = Solid;
            #[doc = $doc]
            fn $method(self, other: &Solid) -> Solid {
                Solid::new($make(self, other.clone()))
            }
        }
    };
}

operator!(BitOr, bitor, "The union.", union_of);
operator!(BitAnd, bitand, "The intersection.", intersection_of);
operator!(BitXor, bitxor, "The symmetric difference.", symmetric_difference_of);
operator!(Sub, sub, "The difference.", Node::Difference);

fn union_of(a: Solid, b: Solid) -> Node {
    Node::Union(vec![a, b])
}

fn intersection_of(a: Solid, b: Solid) -> Node {
    Node::Intersection(vec![a, b])
}

fn symmetric_difference_of(a: Solid, b: Solid) -> Node {
    Node::SymmetricDifference(vec![a, b])
}

impl Not for Solid {
    type Output = Solid;
    /// The complement.
    fn not(self) -> Solid {
        Solid::new(Node::Complement(self))
    }
}

impl Not for &Solid {
    type Output = Solid;
    /// The complement.
    fn not(self) -> Solid {
        !self.clone()
    }
}
