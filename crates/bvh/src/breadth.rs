//! All items whose boxes one ray passes, level by level.
//!
//! In depth-first order the test of a node has to end before the next node can be chosen, and how many of its boxes the ray
//! passes is a branch that the processor cannot predict. Here the next nodes wait in a queue, and the boxes that a ray passes
//! are appended without branches: the processor begins the tests of several nodes at once.

use crate::frame::Probe;
use crate::node::{Child, Node32, WIDTH};
use crate::slabs::RaySlabs;
use crate::tree::Bvh;
use fearless_simd::{Simd, SimdBase, SimdFrom, SimdMask, dispatch, u32x8};

/// Largest number of nodes that wait at the same time. A ray for which more would wait visits the others depth first.
const QUEUE: usize = 128;

impl Bvh<1> {
    /// Appends the items whose boxes the ray passes, in no particular order.
    pub fn intersected_items(&self, probe: &Probe, out: &mut Vec<u32>) {
        if !self.nodes.is_empty() {
            dispatch!(self.level, simd => self.search(simd, probe, out));
        }
    }

    #[inline(always)]
    fn search<S: Simd>(&self, simd: S, probe: &Probe, out: &mut Vec<u32>) {
        let slabs = RaySlabs::new(simd, probe);
        // a ring, which begins with the root
        let mut queue = [0; QUEUE];
        let (mut first, mut end) = (0, 1);
        while first != end {
            let node = &self.nodes[queue[first % QUEUE] as usize];
            first += 1;
            let (passed, inner) = (slabs.passed(node).0, inner_children(simd, node));
            if passed & !inner != 0 || inner == 0 {
                append(node, passed & !inner, out);
            }
            if inner == 0 {
                continue;
            }
            // one more than there may be boxes: see `each_box`
            if end - first >= QUEUE - WIDTH {
                self.visit_below(node, passed & inner, &slabs, out);
                continue;
            }
            let boxes = passed & inner;
            each_box(boxes, |k, count| queue[(end + count) % QUEUE] = node.child[k].to_bits());
            end += boxes.count_ones() as usize;
        }
    }

    /// Visits the nodes in some boxes of a node depth first.
    #[cold]
    fn visit_below<S: Simd>(&self, node: &Node32, boxes: u32, slabs: &RaySlabs<S>, out: &mut Vec<u32>) {
        for (k, child) in node.child.iter().enumerate() {
            if let Some(inner) = child.as_node().filter(|_| boxes >> k & 1 == 1) {
                self.walk(inner, |node| slabs.passed(node).0, &mut |item| out.push(item.start as u32));
            }
        }
    }
}

/// Bit mask of the children that are nodes.
#[inline(always)]
fn inner_children<S: Simd>(simd: S, node: &Node32) -> u32 {
    let children = u32x8::simd_from(simd, node.child.map(|child| child.to_bits()));
    children.simd_lt(u32x8::splat(simd, Child::MARK)).to_bitmask() as u32
}

/// Appends the items in some boxes of a node.
#[inline(always)]
fn append(node: &Node32, boxes: u32, out: &mut Vec<u32>) {
    let known = out.len();
    out.extend_from_slice(&[0; 2 * WIDTH]);
    if let Some(slots) = out.last_chunk_mut::<{ 2 * WIDTH }>() {
        each_box(boxes, |k, count| slots[count % (2 * WIDTH)] = node.child[k].place());
    }
    out.truncate(known + boxes.count_ones() as usize);
}

/// Calls `put` with the number of each box and the number of boxes before it. Most rays pass at most three boxes of a node: `put`
/// is called for multiples of three without a branch, in vain (with any box) where there are fewer.
#[inline(always)]
fn each_box(boxes: u32, mut put: impl FnMut(usize, usize)) {
    let (mut left, mut count) = (boxes, 0);
    while {
        for _ in 0..3 {
            put(left.trailing_zeros() as usize % WIDTH, count);
            left &= left.wrapping_sub(1);
            count += 1;
        }
        left != 0
    } {}
}
