//! Nodes with eight boxes, stored plane by plane (structure of arrays), so that one SIMD operation reads the same
//! plane of all boxes.

use rayweave_math::{Bounds, Vec3};
use std::ops::Range;

/// The number of children of a node, and of rays in a bundle.
pub const WIDTH: usize = 8;

/// Eight numbers of 4 bytes, one per box.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub(crate) struct Row32(pub [f32; WIDTH]);

/// Eight numbers of 8 bytes, one per box.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(crate) struct Row64(pub [f64; WIDTH]);

/// Eight boxes and their children. The boxes in use come first; the others are empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node<R> {
    /// The planes lo x, y, z and hi x, y, z of each box.
    pub planes: [R; 6],
    pub child: [Child; WIDTH],
}

/// Boxes rounded outwards to `f32`: 28 bytes per child.
pub(crate) type Node32 = Node<Row32>;

/// Boxes as they were given.
pub(crate) type Node64 = Node<Row64>;

/// The child in a box: a node, or a leaf with a range of places in the order of the tree.
///
/// Bit 31 marks leaves. A leaf of up to `LEAF` items has its number of items, less one, in the next bits, and
/// its first place in the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Child(u32);

impl Child {
    /// Marks a box that is not in use.
    pub const NONE: Child = Child(u32::MAX);

    /// The bit of leaves.
    pub const MARK: u32 = 1 << 31;

    /// The number of bits for a place, in leaves of up to `LEAF` items.
    const fn place_bits<const LEAF: usize>() -> u32 {
        assert!(LEAF.is_power_of_two(), "the number of items in a leaf must be a power of two");
        31 - LEAF.ilog2()
    }

    /// Largest number of items in a tree with leaves of up to `LEAF` items.
    pub const fn most_items<const LEAF: usize>() -> usize {
        (1 << Child::place_bits::<LEAF>()) - LEAF
    }

    pub fn node(number: usize) -> Child {
        Child(number as u32)
    }

    pub fn leaf<const LEAF: usize>(places: Range<usize>) -> Child {
        let more = (places.len() - 1) as u64;
        Child(Child::MARK | (more << Child::place_bits::<LEAF>()) as u32 | places.start as u32)
    }

    /// The number of a node; `None` for a leaf.
    #[inline(always)]
    pub fn as_node(self) -> Option<u32> {
        (self.0 & Child::MARK == 0).then_some(self.0)
    }

    /// The places of a leaf.
    #[inline(always)]
    pub fn places<const LEAF: usize>(self) -> Range<usize> {
        let bits = const { Child::place_bits::<LEAF>() };
        let (start, more) = (self.0 & ((1 << bits) - 1), u64::from(self.0 ^ Child::MARK) >> bits);
        start as usize..start as usize + more as usize + 1
    }

    /// The only item of a leaf, by its place.
    #[inline(always)]
    pub fn place(self) -> u32 {
        self.0 & !Child::MARK
    }

    /// Adds an offset to the number of a node.
    pub fn shift(&mut self, offset: usize) {
        if self.as_node().is_some() {
            self.0 += offset as u32;
        }
    }

    #[inline(always)]
    pub fn to_bits(self) -> u32 {
        self.0
    }

    #[inline(always)]
    pub fn from_bits(bits: u32) -> Child {
        Child(bits)
    }
}

impl Node32 {
    pub const EMPTY: Node32 = {
        let (lo, hi) = (Row32([f32::INFINITY; WIDTH]), Row32([f32::NEG_INFINITY; WIDTH]));
        Node { planes: [lo, lo, lo, hi, hi, hi], child: [Child::NONE; WIDTH] }
    };

    /// Bit mask of the boxes that satisfy a condition on their planes lo x, y, z and hi x, y, z.
    #[inline(always)]
    pub fn mask(&self, is_set: impl Fn([f32; 6]) -> bool) -> u32 {
        let planes = |k: usize| std::array::from_fn(|plane| self.planes[plane].0[k]);
        (0..WIDTH).fold(0, |bits, k| bits | u32::from(is_set(planes(k))) << k)
    }
}

impl Node64 {
    /// A node with these children and empty boxes.
    pub fn with_children(child: [Child; WIDTH]) -> Node64 {
        let (lo, hi) = (Row64([f64::INFINITY; WIDTH]), Row64([f64::NEG_INFINITY; WIDTH]));
        Node { planes: [lo, lo, lo, hi, hi, hi], child }
    }

    pub fn put(&mut self, k: usize, bounds: &Bounds) {
        for axis in 0..3 {
            self.planes[axis].0[k] = bounds.lo[axis];
            self.planes[axis + 3].0[k] = bounds.hi[axis];
        }
    }

    #[inline(always)]
    pub fn bounds(&self, k: usize) -> Bounds {
        let [a, b, c, d, e, f] = &self.planes;
        Bounds { lo: Vec3::new(a.0[k], b.0[k], c.0[k]), hi: Vec3::new(d.0[k], e.0[k], f.0[k]) }
    }
}
