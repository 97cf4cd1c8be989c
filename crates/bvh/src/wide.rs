//! A BVH whose nodes have sixteen boxes in `f32`, for many rays from a bounded part of space.
//!
//! A ray takes 32 bytes, and a node 512, little more than one with eight boxes in `f64`: a thousand rays and the nodes of thousands of
//! items stay in the cache.

use crate::build::{Builder, Item, Split};
use crate::frame::{Frame, LEAST, ROUNDING, above, below};
use crate::node::Child;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x16, f64x8};
use rayweave_math::{Bounds, Vec3};

/// The number of boxes of a node.
pub(crate) const WIDE: usize = 16;

/// Number of items from which on nodes are full, which takes less memory.
const MANY: usize = 1000;

/// Bound of the coordinates of the origins of rays in the frame: those in the box of the tree lie between -1 and 1, up to rounding.
const MOST: f64 = 1.25;

/// Bound of the times in the frame at which a ray is in a box: from an origin within `MOST` to a corner of the frame it is at most
/// 2.25 sqrt(3) < 3.9, and 4 leaves room for grown boxes.
const END: f64 = 4.0;

/// Largest growth of boxes in the frame: with it, times still lie below `END`.
const MOST_GROWN: f64 = 0.05;

// `ROUNDING` covers the rounding to `f32` of the test of a plane at p, |p| <= 1 + MOST_GROWN, for an origin |o| <= MOST and a component
// |d| <= 1 of the direction of length 1. With u = 2^-24, the time (p - o) * (1 / d) has these errors:
// - u / |d| from the origin, which is rounded to the nearest number below 2,
// - 2 u / |d| from the difference, which lies below 4,
// - 2 u |p - o| / |d| < 4.6 u / |d| from the inverse and the product,
// - 4 * 2^-40 / |d| within `END` from a component that is kept off zero.
// Together they are less than 9 u / |d|. Boxes grown by 16 u are entered earlier and left later by 16 u / |d|, for any time. The rest,
// 7 u, covers the errors of the map into the frame in `f64`. Planes are rounded outwards, before and after they are moved.
// The bounds of the times, within `END`, move outwards by 16 u and are then rounded by at most 4 u.

/// Sixteen numbers, one per box.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
struct Row(pub [f32; WIDE]);

/// Up to sixteen boxes and their children. The boxes in use come first; the others are empty.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WideNode {
    /// The planes lo x, y, z and hi x, y, z of each box, grown by the rounding errors of tests.
    planes: [Row; 6],
    pub child: [Child; WIDE],
    /// Bit mask of the children that are nodes.
    pub inner: u32,
}

/// A bounding volume hierarchy of items for [`RayStreams`](crate::RayStreams).
#[derive(Clone, Debug, PartialEq)]
pub struct WideBvh {
    frame: Frame,
    /// Bound of the coordinates of the origins of rays; negative if a box is infinite.
    most: f64,
    pub(crate) nodes: Vec<WideNode>,
}

/// A ray in the frame of a tree: the origin, the inverse of the direction, and the interval of times.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub struct StreamRay {
    origin: [f32; 3],
    from: f32,
    inverse: [f32; 3],
    pub(crate) until: f32,
}

/// Eight rays in the frame of a tree.
#[derive(Clone, Copy, Debug)]
pub struct StreamRays {
    rows: [[f64; 8]; 8],
    /// The time in the frame per time of the ray.
    pace: [f64; 8],
    /// Bit mask of the rays that the tree can search for.
    known: u64,
}

impl WideBvh {
    /// The tree of some boxes, for rays with their origins in the box `around`. Boxes are grown in tests by `margin` times the sum of the
    /// absolute coordinates of the origin, or more. Queries return the numbers of boxes. Without a box around all boxes that is finite,
    /// there are no rays.
    #[must_use]
    pub fn new(boxes: &[Bounds], around: &Bounds, margin: f64) -> WideBvh {
        let all =
            boxes.iter().filter(|bounds| !bounds.is_empty()).fold(*around, |all, bounds| all.union(bounds));
        let frame = Frame::new(&all);
        let farthest = frame.centre.abs() + Vec3::splat(MOST * frame.unit);
        let grown = frame.growth(farthest, margin * farthest.element_sum()) + ROUNDING;
        let most = if all.is_finite() && grown < MOST_GROWN { MOST } else { -1.0 };
        let item = |(bounds, number): (&Bounds, u32)| {
            let mut item = frame.item(bounds, number);
            for k in 0..3 {
                item.lo[k] = below(f64::from(item.lo[k]) - grown);
                item.hi[k] = above(f64::from(item.hi[k]) + grown);
            }
            item
        };
        let mut items: Vec<Item> = boxes.iter().zip(0..).map(item).collect();
        let split = if items.len() < MANY { Split::Free } else { Split::Full };
        WideBvh { frame, most, nodes: build(&mut items, split) }
    }

    /// Prepares rays, each from a time until another one.
    #[inline(always)]
    pub fn rays<S: Simd>(
        &self,
        simd: S,
        origin: [f64x8<S>; 3],
        direction: [f64x8<S>; 3],
        [from, until]: [f64x8<S>; 2],
    ) -> StreamRays {
        let splat = |value: f64| f64x8::splat(simd, value);
        let [x, y, z] = direction;
        let length = (x * x + y * y + z * z).sqrt();
        let pace = length * self.frame.scale();
        let most = splat(1.0 / LEAST);
        let mut known =
            pace.simd_gt(f64::MIN_POSITIVE) & pace.simd_lt(f64::INFINITY) & length.simd_gt(1e-100);
        let mut rows = [[0.0; 8]; 8];
        for k in 0..3 {
            let place = (origin[k] - self.frame.centre[k]) * self.frame.scale();
            known &= place.abs().simd_lt(splat(self.most));
            place.store_array(&mut rows[k]);
            // kept off infinity
            let inverse = length / direction[k];
            inverse.max(-most).min(most).store_array(&mut rows[4 + k]);
        }
        ((from * pace).max(splat(-END)) - ROUNDING).store_array(&mut rows[3]);
        ((until * pace).min(splat(END)) + ROUNDING).store_array(&mut rows[7]);
        StreamRays { rows, pace: pace.to_array(), known: known.to_bitmask() }
    }
}

impl StreamRays {
    /// One of the rays, and its time in the frame per time; `None` if it starts far outside of the box of the tree.
    #[inline(always)]
    #[must_use]
    pub fn ray(&self, lane: usize) -> Option<(StreamRay, f64)> {
        let lane = lane % 8;
        let at = |k: usize| self.rows[k][lane] as f32;
        let ray = StreamRay {
            origin: [at(0), at(1), at(2)],
            from: at(3),
            inverse: [at(4), at(5), at(6)],
            until: at(7),
        };
        (self.known >> lane & 1 == 1).then_some((ray, self.pace[lane]))
    }
}

impl StreamRay {
    /// The entry times into the boxes of a node, and a bit mask of the boxes that the ray passes.
    #[inline(always)]
    pub(crate) fn enter<S: Simd>(&self, simd: S, node: &WideNode) -> (f32x16<S>, u32) {
        let (mut enter, mut leave) = (f32x16::splat(simd, self.from), f32x16::splat(simd, self.until));
        for k in 0..3 {
            let (origin, inverse) = (self.origin[k], self.inverse[k]);
            // in this order, so that the ray misses empty boxes, from +inf to -inf
            let near = k + 3 * usize::from(inverse < 0.0);
            let near_plane = f32x16::load_array_ref(simd, &node.planes[near % 6].0);
            let far_plane = f32x16::load_array_ref(simd, &node.planes[(2 * k + 3 - near) % 6].0);
            enter = enter.max((near_plane - origin) * inverse);
            leave = leave.min((far_plane - origin) * inverse);
        }
        (enter, enter.simd_le(leave).to_bitmask() as u32)
    }
}

/// The nodes of a tree, each behind its parent; the places of its items are their numbers.
fn build(items: &mut [Item], split: Split) -> Vec<WideNode> {
    let builder = Builder::<1> { split, width: WIDE };
    let (mut nodes, mut waiting) = (Vec::new(), vec![(None, 0, 0..items.len())]);
    while let Some((above, depth, range)) = waiting.pop().filter(|(_, _, range)| !range.is_empty()) {
        let here = nodes.len();
        if let Some((node, k)) = above {
            let node: &mut WideNode = &mut nodes[node];
            node.child[k] = Child::node(here);
        }
        let parts = builder.parts(&mut items[range.clone()], depth);
        let mut node = WideNode::EMPTY;
        for (k, part) in parts.iter().enumerate() {
            let (first, is_inner) = (range.start + part.range.start, part.range.len() > 1);
            let number = items[first].number as usize;
            node.child[k] = Child::leaf::<1>(number..number + 1);
            node.inner |= u32::from(is_inner) << k;
            for axis in 0..3 {
                node.planes[axis].0[k] = part.bounds.lo[axis];
                node.planes[axis + 3].0[k] = part.bounds.hi[axis];
            }
            if is_inner {
                waiting.push((Some((here, k)), depth + 1, first..range.start + part.range.end));
            }
        }
        nodes.push(node);
    }
    nodes
}

impl WideNode {
    const EMPTY: WideNode = {
        let (lo, hi) = (Row([f32::INFINITY; WIDE]), Row([f32::NEG_INFINITY; WIDE]));
        WideNode { planes: [lo, lo, lo, hi, hi, hi], child: [Child::NONE; WIDE], inner: 0 }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    /// Boxes of many sizes away from the origin.
    fn boxes() -> Vec<Bounds> {
        let part = |k: u32, step: f64| (f64::from(k) * step).fract();
        let corner = |k: u32| Vec3::new(7.0 + part(k, 0.618), part(k, 0.414) - 3.0, 1e3 * part(k, 0.732));
        (0..400)
            .map(|k| Bounds { lo: corner(k), hi: corner(k) + Vec3::splat(0.01 + part(k, 0.303)) })
            .collect()
    }

    /// Every plane in the tree is at least as far outside as the growth requires, in `f64`; none is much farther.
    #[test]
    fn planes_are_rounded_outwards() {
        for (count, margin) in [(400, 0.0), (400, 1e-9), (17, 1e-7), (3, 0.0)] {
            let boxes = &boxes()[..count];
            let around = boxes.iter().fold(Bounds::EMPTY, |all, bounds| all.union(bounds));
            let tree = WideBvh::new(boxes, &around, margin);
            let (centre, unit) = (tree.frame.centre, tree.frame.unit);
            let farthest = centre.abs() + Vec3::splat(MOST * unit);
            let grown = ROUNDING + margin * farthest.element_sum() / unit;
            let mut seen = 0;
            for node in &tree.nodes {
                for (k, child) in node.child.iter().enumerate().filter(|(_, child)| **child != Child::NONE) {
                    for axis in 0..3 {
                        let [lo, hi] = [axis, axis + 3].map(|plane| node.planes[plane].0[k]);
                        if let Some(inner) = child.as_node() {
                            let inner = &tree.nodes[inner as usize];
                            assert!(inner.planes[axis].0.iter().all(|&own| lo <= own));
                            assert!(inner.planes[axis + 3].0.iter().all(|&own| hi >= own));
                            continue;
                        }
                        let own = &boxes[child.place() as usize];
                        let exact = [own.lo, own.hi].map(|p| (p[axis] - centre[axis]) / unit);
                        let by = [exact[0] - f64::from(lo), f64::from(hi) - exact[1]];
                        assert!(
                            by.iter().all(|&by| by >= grown && by < grown + 3.0 * ROUNDING / 16.0),
                            "{by:?}"
                        );
                        seen += 1;
                    }
                }
            }
            assert_eq!(seen, 3 * count);
        }
    }

    /// The bounds of the times move outwards; rays from far outside and trees with infinite boxes have no rays.
    #[test]
    fn windows_are_rounded_outwards() {
        let boxes = boxes();
        let around = boxes.iter().fold(Bounds::EMPTY, |all, bounds| all.union(bounds));
        let mut infinite = boxes.clone();
        infinite.push(Bounds { lo: Vec3::ZERO, hi: Vec3::INFINITY });
        let trees = [&boxes, &infinite].map(|boxes| WideBvh::new(boxes, &around, 0.0));
        let coarse = WideBvh::new(&boxes, &around, 1.0);
        dispatch!(Level::new(), simd => {
            let load = |values: [f64; 8]| f64x8::load_array(simd, values);
            let start = around.centre();
            let origin = [0, 1, 2].map(|k| f64x8::splat(simd, start[k]));
            let direction = [0.3, -0.4, 1.2].map(|d| f64x8::splat(simd, d));
            for step in 1..200 {
                let from: [f64; 8] = std::array::from_fn(|k| -0.137 * f64::from(step) * (k as f64 + 1.0));
                let until = from.map(|from| 0.77 - from);
                let rays = trees[0].rays(simd, origin, direction, [load(from), load(until)]);
                for k in 0..8 {
                    let (ray, pace) = rays.ray(k).unwrap();
                    assert!((pace * trees[0].frame.unit - 1.3).abs() < 1e-12);
                    assert!(f64::from(ray.from) < (from[k] * pace).max(-END));
                    assert!(f64::from(ray.until) > (until[k] * pace).min(END));
                }
                for tree in [&trees[1], &coarse] {
                    assert!(tree.rays(simd, origin, direction, [load(from), load(until)]).ray(0).is_none());
                }
            }
            let ends = [f64x8::splat(simd, 0.0), f64x8::splat(simd, f64::INFINITY)];
            let far = |part: f64| [0, 1, 2].map(|k| f64x8::splat(simd, start[k] + part * trees[0].frame.unit));
            assert!(trees[0].rays(simd, far(1.24), direction, ends).ray(3).is_some());
            assert!(trees[0].rays(simd, far(1.26), direction, ends).ray(3).is_none());
            // the longest way through the frame, to the farthest corner
            let towards = [f64x8::splat(simd, -1.0); 3];
            let (ray, _) = trees[0].rays(simd, far(1.24), towards, ends).ray(0).unwrap();
            assert!(f64::from(ray.until) > 2.24 * 3f64.sqrt());
        });
    }
}
