//! Candidate leaves of a ray: a BVH for each group. It affects speed, never an answer.
//!
//! The box of a leaf is the region where the leaf can matter ([`Program::matters`]): outside of it no
//! boundary event of the leaf changes a result. Boxes are grown by more than the largest error of any kernel.

use crate::rings::RingTree;
use fearless_simd::Simd;
use rayweave_bvh::{Bvh, ForwardSearch, FrontToBack, Probe};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::thread_count;
use rayweave_model::{GroupPoint, GroupRay, MARGIN, Program, Prototype, Window};
use rayweave_shape::Ray;

/// A BVH of the leaves of a group, with those that have no finite box.
#[derive(Clone, Debug)]
pub(crate) struct Accel {
    tree: Bvh,
    condition: f64,
    /// For solids of revolution with many rings: the rings, and a BVH of the other leaves.
    rings: Option<Box<(RingTree, Bvh)>>,
}

/// Growth of every box due to the position of the ray's origin and to the transform into the frame of the
/// group.
fn ray_margin(origin: Vec3, magnitude: f64) -> f64 {
    MARGIN * (origin.length() + magnitude)
}

impl Accel {
    pub fn new(program: &Program, group: &Prototype) -> Accel {
        let (mut boxes, threads) = (program.matters(group), thread_count(None).get());
        let tree = Bvh::of_items(&boxes, threads);
        let rings = RingTree::new(program.rings(group, &boxes, RingTree::MANY)).map(|rings| {
            rings.leaves().iter().for_each(|&leaf| boxes[leaf as usize] = Bounds::EMPTY);
            Box::new((rings, Bvh::of_items(&boxes, threads)))
        });
        Accel { tree, condition: group.condition, rings }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + self.rings.as_ref().map_or(0, |rings| rings.0.bytes() + rings.1.bytes())
    }

    /// Largest extent of all boxes together.
    pub fn size(&self) -> f64 {
        self.tree.size()
    }

    /// Prepares a ray for the tree. `magnitude` is that of [`GroupRay::magnitude`].
    fn probe(&self, ray: &Ray, magnitude: f64, window: Window) -> Probe {
        let margin = self.condition * ray_margin(ray.origin, magnitude);
        self.tree.probe(ray.origin, ray.direction, margin, [window.t_min(), window.t_max()])
    }

    /// Appends the leaves that the ray can touch within the window.
    pub fn intersected_leaves(&self, ray: &Ray, magnitude: f64, window: Window, out: &mut Vec<u32>) {
        out.extend_from_slice(self.unbounded());
        match self.rings.as_deref() {
            Some((rings, others)) => {
                let margin = self.condition * ray_margin(ray.origin, magnitude);
                rings.intersected(ray, window, margin, out);
                others.intersected_items(
                    &others.probe(ray.origin, ray.direction, margin, [window.t_min(), window.t_max()]),
                    out,
                );
            }
            None => self.tree.intersected_items(&self.probe(ray, magnitude, window), out),
        }
    }

    /// Starts an approximately front-to-back search of the leaves with finite boxes, in the frame of the model.
    #[inline(always)]
    pub fn begin_forward<S: Simd>(&self, simd: S, ray: &Ray, window: Window, search: &mut ForwardSearch) {
        search.begin(simd, &self.tree, self.probe(ray, 0.0, window));
    }

    /// The next leaf of the search whose box the ray enters before a time.
    #[inline(always)]
    pub fn next_forward<S: Simd>(&self, simd: S, search: &mut ForwardSearch, until: f64) -> Option<u32> {
        search.next(simd, &self.tree, until)
    }

    /// The leaves whose box is unbounded: candidates for every ray.
    pub fn unbounded(&self) -> &[u32] {
        self.tree.unbounded()
    }

    /// Starts a front-to-back traversal of the leaves with finite boxes.
    pub fn begin(&self, ray: &GroupRay<'_>, window: Window, front: &mut FrontToBack) {
        front.begin(&self.tree, self.probe(&ray.ray, ray.magnitude, window));
    }

    /// One step of the traversal; returns a leaf if the step reaches one.
    pub fn next(&self, front: &mut FrontToBack) -> Option<u32> {
        front.next(&self.tree)
    }

    /// Appends the leaves whose boxes contain a point.
    pub fn around(&self, point: &GroupPoint, out: &mut Vec<u32>) {
        out.extend_from_slice(self.unbounded());
        // no model extends that far; computations with boxes would overflow
        if !point.point.to_array().iter().all(|x| x.abs() <= Ray::MAX_COMPONENT) {
            return;
        }
        let margin = self.condition * ray_margin(point.point, point.magnitude);
        let place = Bounds { lo: point.point, hi: point.point };
        self.tree.overlapping(&place, margin, |leaf| out.push(leaf.start as u32));
    }
}
