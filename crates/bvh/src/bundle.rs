//! Traversal by bundles of eight rays, one per SIMD lane: all boxes of a node are tested at once against the whole
//! bundle.
//!
//! Interval arithmetic bounds the bundle (Boulos et al. 2006): by the least and greatest origins and the slowest
//! and fastest speeds of its rays. Conservative: a miss is definite for every ray of the bundle. On a possible hit
//! the traversal tests each ray.

use crate::exact::ExactBvh;
use crate::node::{Node64, WIDTH};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8, mask64x8};
use rayweave_math::{Bounds, Vec3};

/// Eight rays prepared for slab tests.
#[derive(Clone, Copy, Debug)]
pub struct BundleSlabs<S: Simd> {
    pub(crate) origin: [f64x8<S>; 3],
    pub(crate) inverse: [f64x8<S>; 3],
    /// The growth of the boxes.
    pub(crate) margin: f64x8<S>,
}

/// The inverse of a component of a direction, kept finite: a component of 1e-100 moves the ray by less than
/// any margin.
#[inline(always)]
fn inverse<S: Simd>(simd: S, d: f64x8<S>) -> f64x8<S> {
    f64x8::splat(simd, 1.0) / d.abs().max(f64x8::splat(simd, 1e-100)).copysign(d)
}

impl<S: Simd> BundleSlabs<S> {
    /// The rays with these origins and directions, component by component. Boxes are grown by `margin`.
    #[inline(always)]
    pub fn new(simd: S, origin: [f64x8<S>; 3], direction: [f64x8<S>; 3], margin: f64x8<S>) -> Self {
        let [x, y, z] = direction;
        BundleSlabs { origin, inverse: [inverse(simd, x), inverse(simd, y), inverse(simd, z)], margin }
    }

    /// The rays that pass the grown box.
    #[inline(always)]
    fn touch(&self, simd: S, bounds: &Bounds, window: &BundleWindow<S>) -> mask64x8<S> {
        let (mut enter, mut leave) = (window.from.0, window.until.0);
        let Vec3 { x, y, z } = bounds.lo;
        let low = [x, y, z];
        let Vec3 { x, y, z } = bounds.hi;
        let high = [x, y, z];
        for k in 0..3 {
            let (origin, inverse) = (self.origin[k], self.inverse[k]);
            let a = (f64x8::splat(simd, low[k]) - self.margin - origin) * inverse;
            let b = (f64x8::splat(simd, high[k]) + self.margin - origin) * inverse;
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        enter.simd_le(leave) & window.rays
    }

    /// The bundle of the rays in a bit mask.
    #[inline(always)]
    pub fn bundle(&self, simd: S, rays: u64) -> Bundle {
        let (rays, zero) = (mask64x8::from_bitmask(simd, rays), f64x8::splat(simd, 0.0));
        let mut sides = [[Side::NONE; 2]; 3];
        for (k, [up, down]) in sides.iter_mut().enumerate() {
            let (origin, inverse) = (self.origin[k], self.inverse[k]);
            let ascends = inverse.simd_gt(zero);
            *up = Side::of(simd, [origin, inverse, self.margin], rays & ascends);
            *down = Side::of(simd, [-origin, -inverse, self.margin], rays & !ascends);
        }
        Bundle { sides }
    }
}

/// Bounds of the origins and directions of up to eight rays.
#[derive(Clone, Copy, Debug)]
pub struct Bundle {
    /// For each axis, the rays that ascend along it, and the mirror images of those that descend.
    sides: [[Side; 2]; 3],
}

/// Bounds of the rays that ascend along an axis.
#[derive(Clone, Copy, Debug)]
struct Side {
    /// The greatest origin plus the margin, and the least origin minus the margin.
    near: f64,
    far: f64,
    /// The least and the greatest inverse speed.
    least: f64,
    greatest: f64,
}

impl Side {
    const NONE: Side =
        Side { near: f64::NEG_INFINITY, far: f64::INFINITY, least: f64::INFINITY, greatest: 0.0 };

    /// The bounds of some of eight rays, from their origins, inverse speeds and margins.
    #[inline(always)]
    fn of<S: Simd>(simd: S, [origin, inverse, margin]: [f64x8<S>; 3], rays: mask64x8<S>) -> Side {
        if !rays.any_true() {
            return Side::NONE;
        }
        let or = |values: f64x8<S>, none: f64| rays.select(values, f64x8::splat(simd, none));
        Side {
            near: or(origin + margin, f64::NEG_INFINITY).reduce_max(),
            far: or(origin - margin, f64::INFINITY).reduce_min(),
            least: or(inverse, f64::INFINITY).reduce_min(),
            greatest: or(inverse, 0.0).reduce_max(),
        }
    }

    /// Bounds per box: the earliest entry time and the latest exit time of any of the rays.
    #[inline(always)]
    fn times<S: Simd>(&self, low: f64x8<S>, high: f64x8<S>) -> (f64x8<S>, f64x8<S>) {
        let (near, far) = (low - self.near, high - self.far);
        ((near * self.least).min(near * self.greatest), (far * self.least).max(far * self.greatest))
    }
}

impl Bundle {
    /// Lower bounds of the entry times into the boxes of a node, and a bit mask of the boxes that the bundle
    /// may touch.
    #[inline(always)]
    fn enter<S: Simd>(&self, simd: S, node: &Node64, window: &BundleWindow<S>) -> (f64x8<S>, u64) {
        let mut enter = f64x8::splat(simd, window.from.1);
        let mut leave = f64x8::splat(simd, window.until.1);
        for (k, [up, down]) in self.sides.iter().enumerate() {
            let low = f64x8::load_array_ref(simd, &node.planes[k].0);
            let high = f64x8::load_array_ref(simd, &node.planes[k + 3].0);
            let (a, b) = match () {
                () if down.greatest == 0.0 => up.times(low, high),
                () if up.greatest == 0.0 => down.times(-high, -low),
                () => {
                    let (a, b) = up.times(low, high);
                    let (c, d) = down.times(-high, -low);
                    (a.min(c), b.max(d))
                }
            };
            enter = enter.max(a);
            leave = leave.min(b);
        }
        (enter, enter.simd_le(leave).to_bitmask())
    }
}

/// The rays of a bundle to be tested, and their intervals of t: the bound per lane, and the bound for all lanes.
#[derive(Clone, Copy, Debug)]
pub struct BundleWindow<S: Simd> {
    /// The lanes to be tested.
    pub rays: mask64x8<S>,
    /// Lower bounds of t.
    pub from: (f64x8<S>, f64),
    /// Upper bounds of t.
    pub until: (f64x8<S>, f64),
}

/// State of a traversal by a bundle: a stack of boxes that it has yet to enter, the nearest one of each node on
/// top.
#[derive(Clone, Debug, Default)]
pub struct BundleTraversal(Vec<Place>);

/// One box of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub enter: f64,
    pub node: u32,
    pub lane: u32,
}

impl BundleTraversal {
    /// Starts the traversal for a bundle.
    #[inline(always)]
    pub fn begin<S: Simd>(&mut self, simd: S, tree: &ExactBvh, bundle: &Bundle, window: &BundleWindow<S>) {
        self.0.clear();
        if !tree.nodes.is_empty() {
            self.open(simd, tree, 0, bundle, window);
        }
    }

    /// The place of the next item whose box some ray passes. The order is approximately front to back.
    #[inline(always)]
    pub fn next<S: Simd>(
        &mut self,
        simd: S,
        tree: &ExactBvh,
        (slabs, bundle): (&BundleSlabs<S>, &Bundle),
        window: &BundleWindow<S>,
    ) -> Option<u32> {
        while let Some(Place { enter, node, lane }) = self.0.pop() {
            let (node, lane) = (&tree.nodes[node as usize], lane as usize % WIDTH);
            if enter > window.until.1 || !slabs.touch(simd, &node.bounds(lane), window).any_true() {
                continue;
            }
            match node.child[lane].as_node() {
                None => return Some(node.child[lane].place()),
                Some(node) => self.open(simd, tree, node, bundle, window),
            }
        }
        None
    }

    #[inline(always)]
    fn open<S: Simd>(
        &mut self,
        simd: S,
        tree: &ExactBvh,
        node: u32,
        bundle: &Bundle,
        window: &BundleWindow<S>,
    ) {
        let (enter, mut touched) = bundle.enter(simd, &tree.nodes[node as usize], window);
        let first = self.0.len();
        while touched != 0 {
            let lane = touched.trailing_zeros();
            touched &= touched - 1;
            let here = Place { enter: enter.as_slice()[lane as usize % WIDTH], node, lane };
            self.0.push(here);
            // insertion sort: there are rarely more than three
            let mut at = self.0.len() - 1;
            while at > first && self.0[at - 1].enter < here.enter {
                self.0[at] = self.0[at - 1];
                at -= 1;
            }
            self.0[at] = here;
        }
    }
}
