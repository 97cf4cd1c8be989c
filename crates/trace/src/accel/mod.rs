//! Candidate leaves of a ray: a BVH for each group. It affects speed, never an answer.
//!
//! The box of a leaf is the region where the leaf can matter ([`Program::matters`]): outside of it no
//! boundary event of the leaf changes a result. Boxes are grown by more than the largest error of any kernel.

mod build;
mod frame;
mod hierarchy;

pub(crate) use hierarchy::Front;

use hierarchy::Hierarchy;
use rayweave_math::Vec3;
use rayweave_model::drive::thread_count;
use rayweave_model::{GroupPoint, GroupRay, MARGIN, Program, Prototype, Window};

/// A BVH of the leaves of a group, with those that have no finite box.
#[derive(Clone, Debug)]
pub(crate) struct Accel {
    /// Leaves whose box is unbounded: candidates for every ray.
    unbounded: Vec<u32>,
    hierarchy: Hierarchy,
    condition: f64,
}

/// Growth of every box due to the position of the ray's origin and to the transform into the frame of the
/// group.
fn ray_margin(origin: Vec3, magnitude: f64) -> f64 {
    MARGIN * (origin.length() + magnitude)
}

impl Accel {
    pub fn new(program: &Program, group: &Prototype) -> Accel {
        let (mut unbounded, mut boxes) = (Vec::new(), Vec::new());
        for (k, matters) in program.matters(group).into_iter().enumerate() {
            if matters.is_finite() {
                boxes.push((matters, k as u32));
            } else if !matters.is_empty() {
                unbounded.push(k as u32);
            }
        }
        let hierarchy = Hierarchy::new(&boxes, thread_count(None).get());
        Accel { unbounded, hierarchy, condition: group.condition }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.hierarchy.bytes() + self.unbounded.len() * size_of::<u32>()
    }

    /// Largest extent of all boxes together, up to a factor of two.
    pub fn size(&self) -> f64 {
        self.hierarchy.size()
    }

    /// The growth of boxes for a ray.
    fn margin(&self, ray: &GroupRay<'_>) -> f64 {
        self.condition * ray_margin(ray.ray.origin, ray.magnitude)
    }

    /// Appends the leaves that the ray can touch within the window.
    pub fn touched(&self, ray: &GroupRay<'_>, window: Window, out: &mut Vec<u32>) {
        out.extend_from_slice(&self.unbounded);
        self.hierarchy.touched(&self.hierarchy.probe(&ray.ray, self.margin(ray), window), out);
    }

    /// The leaves without a finite box.
    pub fn unbounded(&self) -> &[u32] {
        &self.unbounded
    }

    /// Starts a front-to-back traversal of the leaves with finite boxes.
    pub fn begin(&self, ray: &GroupRay<'_>, window: Window, front: &mut Front) {
        front.begin(&self.hierarchy, self.hierarchy.probe(&ray.ray, self.margin(ray), window));
    }

    /// One step of the traversal; returns a leaf if the step reaches one.
    pub fn next(&self, front: &mut Front) -> Option<u32> {
        front.next(&self.hierarchy)
    }

    /// Appends the leaves whose boxes contain a point.
    pub fn around(&self, point: &GroupPoint, out: &mut Vec<u32>) {
        out.extend_from_slice(&self.unbounded);
        self.hierarchy.around(point.point, self.condition * ray_margin(point.point, point.magnitude), out);
    }
}
