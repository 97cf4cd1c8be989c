//! Search along one ray, approximately from front to back, for the first of the items that it hits.
//!
//! [`FrontToBack`](crate::FrontToBack) opens boxes in the exact order of their entry times, which takes a priority queue. Here the
//! boxes of a node are pushed on a stack, the nearest one on top: the order is exact within a node. The caller bounds the time up to
//! which items still matter, and may have several searches under way, one for each SIMD lane.

use crate::frame::Probe;
use crate::front::{bits_of, time_of};
use crate::node::{Child, WIDTH};
use crate::slabs::RaySlabs;
use crate::tree::Bvh;
use fearless_simd::Simd;

/// State of a search, with the memory for it.
#[derive(Clone, Debug, Default)]
pub struct ForwardSearch {
    probe: Probe,
    /// Stack of the boxes that the ray has yet to enter. The high 32 bits hold the entry time (order-preserving), the low 32 the
    /// child.
    open: Vec<u64>,
}

impl ForwardSearch {
    /// Starts the search at the beginning of the ray's window.
    #[inline(always)]
    pub fn begin<S: Simd>(&mut self, simd: S, tree: &Bvh, probe: Probe) {
        self.probe = probe;
        self.open.clear();
        if !tree.nodes.is_empty() {
            self.push_children(simd, tree, 0);
        }
    }

    /// The next item whose box the ray passes before a time, which must not increase from call to call.
    #[inline(always)]
    pub fn next<S: Simd>(&mut self, simd: S, tree: &Bvh, until: f64) -> Option<u32> {
        let end = self.probe.here(until);
        self.probe.window[1] = self.probe.window[1].min(end);
        while let Some(next) = self.open.pop() {
            let child = Child::from_bits(next as u32);
            if time_of((next >> 32) as u32) > self.probe.window[1] {
                continue;
            }
            match child.as_node() {
                None => return Some(child.place()),
                Some(node) => self.push_children(simd, tree, node),
            }
        }
        None
    }

    /// Pushes the children of a node whose boxes the ray passes, the nearest one last.
    #[inline(always)]
    fn push_children<S: Simd>(&mut self, simd: S, tree: &Bvh, node: u32) {
        let node = &tree.nodes[node as usize];
        let (mut left, enter) = RaySlabs::new(simd, &self.probe).entered(node);
        let first = self.open.len();
        while left != 0 {
            let k = left.trailing_zeros() as usize % WIDTH;
            left &= left - 1;
            let here = u64::from(bits_of(enter[k])) << 32 | u64::from(node.child[k].to_bits());
            self.open.push(here);
            // insertion sort: there are rarely more than three
            let mut at = self.open.len() - 1;
            while at > first && self.open[at - 1] < here {
                self.open[at] = self.open[at - 1];
                at -= 1;
            }
            self.open[at] = here;
        }
    }
}
