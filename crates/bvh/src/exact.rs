//! A BVH whose boxes stay as given, in `f64`, for queries that test boxes themselves.

use crate::build::{DEPTH, Item, Split, build};
use crate::frame::Frame;
use crate::node::{Child, Node64, WIDTH};
use rayweave_math::Bounds;
use std::ops::ControlFlow;

/// A bounding volume hierarchy with one item per leaf and exact boxes, which may be empty or unbounded.
///
/// Its queries are [`ExactBvh::visit`], [`BundleTraversal`](crate::BundleTraversal) and [`RayTraversals`](crate::RayTraversals).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExactBvh {
    pub(crate) nodes: Vec<Node64>,
}

impl ExactBvh {
    /// The tree, and the order of the items in it: the number of the item at each place. Queries return places.
    pub fn sorted(boxes: &[Bounds]) -> (ExactBvh, Vec<u32>) {
        ExactBvh::build(boxes, Split::Full)
    }

    /// Like [`sorted`](ExactBvh::sorted), with more nodes, of which rays pass fewer: for lists of some hundred boxes.
    pub fn sorted_apart(boxes: &[Bounds]) -> (ExactBvh, Vec<u32>) {
        ExactBvh::build(boxes, Split::Free)
    }

    /// The tree in the order of the list: queries return the items in this order, by their numbers. Items that
    /// are neighbours in the list should be neighbours in space.
    pub fn listed(boxes: &[Bounds]) -> ExactBvh {
        ExactBvh::build(boxes, Split::Ordered).0
    }

    fn build(boxes: &[Bounds], split: Split) -> (ExactBvh, Vec<u32>) {
        let finite = boxes.iter().filter(|bounds| bounds.is_finite());
        let frame = Frame::new(&finite.fold(Bounds::EMPTY, |all, bounds| all.union(bounds)));
        let mut items: Vec<Item> =
            boxes.iter().enumerate().map(|(k, bounds)| frame.item(bounds, k as u32)).collect();
        let rounded = build::<1>(&mut items, split, 1);
        let order: Vec<u32> = items.iter().map(|item| item.number).collect();
        let mut nodes: Vec<Node64> = rounded.iter().map(|node| Node64::with_children(node.child)).collect();
        // children follow their parents
        for at in (0..nodes.len()).rev() {
            for k in nodes[at].used() {
                let child = nodes[at].child[k];
                let bounds = match child.as_node() {
                    Some(node) => nodes[node as usize].around(),
                    None => boxes[order[child.place() as usize] as usize],
                };
                nodes[at].put(k, &bounds);
            }
        }
        (ExactBvh { nodes }, order)
    }

    /// Visits the items whose boxes satisfy `is_touched`, in the order of the tree, by place. `is_touched` must
    /// hold for a box if it holds for a box inside it.
    #[inline(always)]
    pub fn visit(
        &self,
        mut is_touched: impl FnMut(&Bounds) -> bool,
        mut visit: impl FnMut(usize) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut open = [(0u32, 0usize); DEPTH];
        let (mut depth, mut at, mut k) = (0, 0, 0);
        while let Some(node) = self.nodes.get(at as usize) {
            if k == WIDTH || node.child[k % WIDTH] == Child::NONE {
                if depth == 0 {
                    break;
                }
                depth -= 1;
                (at, k) = open[depth];
                continue;
            }
            let here = k % WIDTH;
            k += 1;
            if !is_touched(&node.bounds(here)) {
                continue;
            }
            match node.child[here].as_node() {
                None => visit(node.child[here].place() as usize)?,
                Some(inner) => {
                    open[depth] = (at, k);
                    depth += 1;
                    (at, k) = (inner, 0);
                }
            }
        }
        ControlFlow::Continue(())
    }
}

impl Node64 {
    /// The slots in use.
    fn used(&self) -> impl Iterator<Item = usize> + use<> {
        0..self.child.iter().position(|&child| child == Child::NONE).unwrap_or(WIDTH)
    }

    /// The bounding box of its boxes.
    fn around(&self) -> Bounds {
        self.used().fold(Bounds::EMPTY, |all, k| all.union(&self.bounds(k)))
    }
}

/// A node of [`ExactBvh::flat`]: up to eight boxes with their children.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatNode {
    /// The boxes.
    pub bounds: [Bounds; WIDTH],
    /// The children; `None` where a box is not in use. The boxes in use come first.
    pub children: [Option<FlatChild>; WIDTH],
}

/// What a box of a [`FlatNode`] holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlatChild {
    /// The node with this number, which is greater than that of its parent.
    Node(u32),
    /// The item at this place.
    Item(u32),
}

impl ExactBvh {
    /// The nodes in preorder, for other memories: a GPU buffer, a file. Node 0 is the root; there is none without items.
    pub fn flat(&self) -> impl Iterator<Item = FlatNode> {
        self.nodes.iter().map(|node| {
            let child = |k: usize| match node.child[k] {
                Child::NONE => None,
                child => Some(child.as_node().map_or(FlatChild::Item(child.place()), FlatChild::Node)),
            };
            FlatNode { bounds: std::array::from_fn(|k| node.bounds(k)), children: std::array::from_fn(child) }
        })
    }
}
