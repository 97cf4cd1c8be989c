//! Bounding volume hierarchy (BVH) over a list of boxes, for point queries.

use rayweave_math::Bounds;
use std::ops::{ControlFlow, Range};

/// A node: a box of the list (a leaf), or the bounding box of consecutive boxes of the list.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    /// Skip pointer: the index of the next node if this one is not entered.
    next: u32,
    /// The index of the box in the list, for leaves.
    leaf: Option<u32>,
}

/// A binary BVH over a list of boxes in the order of the list, without sorting: neighbours in the
/// list are usually neighbours in space. Queries return the boxes in list order. Nodes are stored
/// in depth-first order, so that the traversal needs no stack.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
}

impl Tree {
    pub fn new(boxes: &[Bounds]) -> Tree {
        let mut tree = Tree { nodes: Vec::with_capacity(2 * boxes.len()) };
        if !boxes.is_empty() {
            tree.grow(boxes, 0..boxes.len());
        }
        tree
    }

    /// Appends the subtree of a range; the depth of the recursion is the logarithm of its length.
    fn grow(&mut self, boxes: &[Bounds], range: Range<usize>) -> Bounds {
        let (at, middle) = (self.nodes.len(), range.start + range.len() / 2);
        let leaf = (range.len() == 1).then_some(range.start as u32);
        self.nodes.push(Node { bounds: boxes[range.start], next: 0, leaf });
        if leaf.is_none() {
            let first = self.grow(boxes, range.start..middle);
            self.nodes[at].bounds = first.union(&self.grow(boxes, middle..range.end));
        }
        self.nodes[at].next = self.nodes.len() as u32;
        self.nodes[at].bounds
    }

    /// Visits the boxes that satisfy `is_touched`, in list order. `is_touched` must hold for a
    /// bounding box if it holds for a box inside it.
    #[inline(always)]
    pub fn visit(
        &self,
        mut is_touched: impl FnMut(&Bounds) -> bool,
        mut visit: impl FnMut(usize) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            if !is_touched(&node.bounds) {
                at = node.next as usize;
                continue;
            }
            if let Some(leaf) = node.leaf {
                visit(leaf as usize)?;
            }
            at += 1;
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_math::Vec3;

    #[test]
    fn all_boxes_around_a_point_are_found_in_their_order() {
        let centre = |k: usize| Vec3::new((k * 7 % 13) as f64, (k * 5 % 11) as f64, (k % 3) as f64);
        for count in [0, 1, 2, 3, 100] {
            let boxes: Vec<Bounds> = (0..count)
                .map(|k| Bounds { lo: centre(k) - Vec3::splat(1.5), hi: centre(k) + Vec3::splat(1.0) })
                .collect();
            let tree = Tree::new(&boxes);
            for point in (0..40).map(centre) {
                let mut found = Vec::new();
                let flow = tree.visit(
                    |bounds| bounds.contains(point),
                    |k| {
                        found.push(k);
                        ControlFlow::Continue(())
                    },
                );
                let expected: Vec<usize> = (0..count).filter(|&k| boxes[k].contains(point)).collect();
                assert_eq!((flow, found), (ControlFlow::Continue(()), expected));
            }
        }
    }
}
