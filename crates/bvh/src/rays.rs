//! Traversal by eight rays, each on its own way through the tree: for rays that have few boxes in common. All boxes of
//! a node are tested at once against one ray.

use crate::bundle::{BundleSlabs, BundleWindow, Place};
use crate::exact::ExactBvh;
use crate::node::{Node64, WIDTH};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};

/// Number of rays.
const RAYS: usize = 8;

/// State of the traversals by eight rays: for each one a stack of boxes that it has yet to enter, the nearest one of
/// each node on top.
#[derive(Clone, Debug, Default)]
pub struct RayTraversals {
    rays: [SlabRay; RAYS],
    open: [Vec<Place>; RAYS],
}

/// A ray prepared for slab tests.
#[derive(Clone, Copy, Debug, Default)]
pub struct SlabRay {
    /// For each axis, the numbers of the planes that the ray enters and leaves the boxes by.
    planes: [[u8; 2]; 3],
    /// The other side of the comparison with these planes: the origin with the margin.
    origin: [[f64; 2]; 3],
    inverse: [f64; 3],
    from: f64,
}

/// Eight rays in memory, each to be prepared for slab tests.
#[derive(Clone, Copy, Debug)]
pub struct SlabRays {
    origin: [[f64; RAYS]; 3],
    inverse: [[f64; RAYS]; 3],
    margin: [f64; RAYS],
}

impl SlabRays {
    /// The rays of a bundle.
    #[inline(always)]
    pub fn new<S: Simd>(slabs: &BundleSlabs<S>) -> SlabRays {
        let [x, y, z] = &slabs.origin;
        let [a, b, c] = &slabs.inverse;
        SlabRays {
            origin: [x.to_array(), y.to_array(), z.to_array()],
            inverse: [a.to_array(), b.to_array(), c.to_array()],
            margin: slabs.margin.to_array(),
        }
    }

    /// One of the rays, from a time on.
    #[inline(always)]
    #[must_use]
    pub fn ray(&self, lane: usize, from: f64) -> SlabRay {
        let (mut ray, margin) = (SlabRay { from, ..SlabRay::default() }, self.margin[lane % RAYS]);
        for k in 0..3 {
            let (origin, inverse) = (self.origin[k][lane % RAYS], self.inverse[k][lane % RAYS]);
            let (low, high) = ((k as u8, origin + margin), (k as u8 + 3, origin - margin));
            // in this order, so that the ray misses empty boxes, from +inf to -inf
            let [near, far] = if inverse > 0.0 { [low, high] } else { [high, low] };
            ray.planes[k] = [near.0, far.0];
            (ray.origin[k], ray.inverse[k]) = ([near.1, far.1], inverse);
        }
        ray
    }
}

impl RayTraversals {
    /// Starts the traversals of the rays of a window.
    #[inline(always)]
    pub fn begin<S: Simd>(
        &mut self,
        simd: S,
        tree: &ExactBvh,
        slabs: &BundleSlabs<S>,
        window: &BundleWindow<S>,
    ) {
        let (rays, slabs) = (window.rays.to_bitmask(), SlabRays::new(slabs));
        for lane in 0..RAYS {
            let at = |values: &f64x8<S>| values.as_slice()[lane];
            let until = if rays >> lane & 1 == 1 { at(&window.until.0) } else { f64::NEG_INFINITY };
            self.begin_one(simd, tree, lane, slabs.ray(lane, at(&window.from.0)), until);
        }
    }

    /// Starts the traversal of one ray, up to a time.
    #[inline(always)]
    pub fn begin_one<S: Simd>(&mut self, simd: S, tree: &ExactBvh, lane: usize, ray: SlabRay, until: f64) {
        self.rays[lane % RAYS] = ray;
        self.open[lane % RAYS].clear();
        if until >= ray.from && !tree.nodes.is_empty() {
            self.open(simd, tree, 0, lane % RAYS, until);
        }
    }

    /// The place of the next item whose box a ray passes before a time. The order is approximately front to back.
    #[inline(always)]
    pub fn next<S: Simd>(&mut self, simd: S, tree: &ExactBvh, lane: usize, until: f64) -> Option<u32> {
        while let Some(Place { enter, node, lane: child }) = self.open[lane % RAYS].pop() {
            if enter > until {
                continue;
            }
            let child = tree.nodes[node as usize].child[child as usize % WIDTH];
            match child.as_node() {
                None => return Some(child.place()),
                Some(node) => self.open(simd, tree, node, lane % RAYS, until),
            }
        }
        None
    }

    #[inline(always)]
    fn open<S: Simd>(&mut self, simd: S, tree: &ExactBvh, node: u32, lane: usize, until: f64) {
        let (enter, mut touched) = self.rays[lane].enter(simd, &tree.nodes[node as usize], until);
        let open = &mut self.open[lane];
        let first = open.len();
        while touched != 0 {
            let child = touched.trailing_zeros();
            touched &= touched - 1;
            let here = Place { enter: enter.as_slice()[child as usize % WIDTH], node, lane: child };
            open.push(here);
            // insertion sort: there are rarely more than three
            let mut at = open.len() - 1;
            while at > first && open[at - 1].enter < here.enter {
                open[at] = open[at - 1];
                at -= 1;
            }
            open[at] = here;
        }
    }
}

impl SlabRay {
    /// The entry times into the boxes of a node, grown by the margin, and a bit mask of the boxes that the ray passes.
    #[inline(always)]
    pub(crate) fn enter<S: Simd>(&self, simd: S, node: &Node64, until: f64) -> (f64x8<S>, u64) {
        let (mut enter, mut leave) = (f64x8::splat(simd, self.from), f64x8::splat(simd, until));
        for k in 0..3 {
            // no `map`, whose closure would not be compiled for the instruction set
            let [near, far] = self.planes[k];
            let near = f64x8::load_array_ref(simd, &node.planes[usize::from(near)].0);
            let far = f64x8::load_array_ref(simd, &node.planes[usize::from(far)].0);
            enter = enter.max((near - self.origin[k][0]) * self.inverse[k]);
            leave = leave.min((far - self.origin[k][1]) * self.inverse[k]);
        }
        (enter, enter.simd_le(leave).to_bitmask())
    }
}
