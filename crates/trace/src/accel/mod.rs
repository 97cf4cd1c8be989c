//! Which leaves a ray can touch. May change speed, never an answer.
//!
//! A leaf counts where it can matter ([`Program::matters`]): a ray that passes outside of that box
//! would see no flip of it that changes anything. Boxes are grown by more than any kernel can err.

mod build;
mod frame;
mod hierarchy;

pub(crate) use hierarchy::Front;

use hierarchy::Hierarchy;
use rayweave_math::Vec3;
use rayweave_model::drive::thread_count;
use rayweave_model::{GroupPoint, GroupRay, MARGIN, Program, Prototype, Window};

/// The leaves of a group by where they are.
#[derive(Clone, Debug)]
pub(crate) struct Accel {
    /// Leaves that can matter without bound: every ray can touch them.
    unbounded: Vec<u32>,
    hierarchy: Hierarchy,
    condition: f64,
}

/// What the position of a ray's origin adds to the growth of every box, and the way into the frame of the group.
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

    /// What it takes in memory.
    pub fn bytes(&self) -> usize {
        self.hierarchy.bytes() + self.unbounded.len() * size_of::<u32>()
    }

    /// A length of the size of all boxes together.
    pub fn size(&self) -> f64 {
        self.hierarchy.size()
    }

    /// How much boxes are to be grown for a ray.
    fn margin(&self, ray: &GroupRay<'_>) -> f64 {
        self.condition * ray_margin(ray.ray.origin, ray.magnitude)
    }

    /// The leaves that the ray can touch within the window.
    pub fn touched(&self, ray: &GroupRay<'_>, window: Window, out: &mut Vec<u32>) {
        out.extend_from_slice(&self.unbounded);
        self.hierarchy.touched(&self.hierarchy.probe(&ray.ray, self.margin(ray), window), out);
    }

    /// The leaves that any ray can touch anywhere.
    pub fn unbounded(&self) -> &[u32] {
        &self.unbounded
    }

    /// Makes ready for the other leaves, one by one in the order in which the ray enters their boxes.
    pub fn begin(&self, ray: &GroupRay<'_>, window: Window, front: &mut Front) {
        front.begin(&self.hierarchy, self.hierarchy.probe(&ray.ray, self.margin(ray), window));
    }

    /// Goes a step along a ray: a leaf if there is one there.
    pub fn next(&self, front: &mut Front) -> Option<u32> {
        front.next(&self.hierarchy)
    }

    /// The leaves whose bounds hold a point.
    pub fn around(&self, point: &GroupPoint, out: &mut Vec<u32>) {
        out.extend_from_slice(&self.unbounded);
        self.hierarchy.around(point.point, self.condition * ray_margin(point.point, point.magnitude), out);
    }
}
