//! Front-to-back traversal: items in the order in which a ray enters their boxes.

use crate::frame::Probe;
use crate::node::{Child, WIDTH};
use crate::slabs::RaySlabs;
use crate::tree::Bvh;
use fearless_simd::dispatch;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// State of a front-to-back traversal, with the memory for it.
#[derive(Clone, Debug, Default)]
pub struct FrontToBack {
    probe: Probe,
    /// Queue of boxes not yet opened, nearest first: the high 32 bits hold the entry time (order-preserving), the low
    /// 32 the child.
    waiting: BinaryHeap<Reverse<u64>>,
    /// The items of the node that was opened last.
    fresh: [u32; WIDTH],
    fresh_count: usize,
}

impl FrontToBack {
    /// Starts the traversal at the beginning of the ray's window.
    pub fn begin(&mut self, tree: &Bvh, probe: Probe) {
        self.probe = probe;
        self.waiting.clear();
        self.fresh_count = 0;
        if !tree.nodes.is_empty() {
            self.open(tree, 0);
        }
    }

    /// Lower bound, in the ray's parameter, of the entry times of all boxes not yet opened; infinite if there
    /// is none.
    pub fn time(&self) -> f64 {
        match self.waiting.peek() {
            Some(&Reverse(first)) => self.probe.time(time_of((first >> 32) as u32)),
            None => f64::INFINITY,
        }
    }

    /// A time by which the ray has left every box.
    pub fn end(&self) -> f64 {
        self.probe.end()
    }

    /// The items in the node that was opened last.
    pub fn fresh(&self) -> &[u32] {
        &self.fresh[..self.fresh_count]
    }

    /// Opens the nearest box; returns its item if it is the box of an item.
    pub fn next(&mut self, tree: &Bvh) -> Option<u32> {
        let Reverse(first) = self.waiting.pop()?;
        let child = Child::from_bits(first as u32);
        let Some(node) = child.as_node() else { return Some(child.place()) };
        self.open(tree, node);
        None
    }

    fn open(&mut self, tree: &Bvh, node: u32) {
        let node = &tree.nodes[node as usize];
        self.fresh_count = 0;
        let (mut left, enter) = dispatch!(tree.level, simd => RaySlabs::new(simd, &self.probe).entered(node));
        while left != 0 {
            let k = left.trailing_zeros() as usize % WIDTH;
            left &= left - 1;
            let child = node.child[k];
            self.waiting.push(Reverse(u64::from(bits_of(enter[k])) << 32 | u64::from(child.to_bits())));
            if child.as_node().is_none() {
                self.fresh[self.fresh_count % WIDTH] = child.place();
                self.fresh_count += 1;
            }
        }
    }
}

/// Maps a number to bits that sort in the same order.
pub(crate) fn bits_of(time: f32) -> u32 {
    let bits = time.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

/// The number with these bits: the inverse of [`bits_of`].
pub(crate) fn time_of(bits: u32) -> f32 {
    f32::from_bits(if bits >> 31 == 1 { bits ^ 1 << 31 } else { !bits })
}
