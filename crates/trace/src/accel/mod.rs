//! Which leaves a ray can touch. May change speed, never an answer.
//!
//! A leaf counts where it can matter ([`rayweave_model::Leaf::matters`]): a ray that passes outside of that box
//! would see no flip of it that changes anything. Boxes are grown by more than any kernel can err.

mod hierarchy;

use hierarchy::Hierarchy;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{GroupPoint, GroupRay, MARGIN, Program, Prototype, Window};
use rayweave_shape::Ray;

/// The leaves of a group by where they are.
#[derive(Clone, Debug)]
pub(crate) struct Accel {
    /// Leaves that can matter without bound: every ray can touch them.
    unbounded: Vec<u32>,
    hierarchy: Hierarchy,
    condition: f64,
}

/// What the position of a ray's origin adds to the growth of every box, and the way into the frame of the group.
fn ray_margin(origin: Vec3, reach: f64) -> f64 {
    MARGIN * (origin.length() + reach)
}

impl Accel {
    pub fn new(program: &Program, group: &Prototype) -> Accel {
        let leaves = &program.leaves()[group.leaves.start as usize..group.leaves.end as usize];
        let (mut unbounded, mut boxes) = (Vec::new(), Vec::new());
        for (k, leaf) in leaves.iter().enumerate() {
            if leaf.matters.is_finite() {
                boxes.push((leaf.matters, k as u32));
            } else if !leaf.matters.is_empty() {
                unbounded.push(k as u32);
            }
        }
        Accel { unbounded, hierarchy: Hierarchy::new(boxes), condition: group.condition }
    }

    /// The leaves that the ray can touch within the window.
    pub fn touched(&self, ray: &GroupRay<'_>, window: Window, out: &mut Vec<u32>) {
        out.extend_from_slice(&self.unbounded);
        let margin = self.condition * ray_margin(ray.ray.origin, ray.reach);
        self.hierarchy.touched(&Probe::new(&ray.ray, margin, window), out);
    }

    /// The leaves whose bounds hold a point.
    pub fn around(&self, point: &GroupPoint, out: &mut Vec<u32>) {
        out.extend_from_slice(&self.unbounded);
        self.hierarchy.around(point.point, self.condition * ray_margin(point.point, point.reach), out);
    }
}

/// A ray ready for tests against boxes.
pub(crate) struct Probe {
    origin: Vec3,
    inverse: Vec3,
    /// What the position of the origin adds to the growth of every box.
    margin: f64,
    window: Window,
}

impl Probe {
    fn new(ray: &Ray, margin: f64, window: Window) -> Probe {
        let inverse = Vec3::ONE / ray.direction;
        Probe { origin: ray.origin, inverse, margin, window }
    }

    /// True if the ray passes the grown box within the window (the slab test of Kay & Kajiya, 1986). A time
    /// of 0/0 stands for a ray in the plane of a face; `max` and `min` drop it, which errs towards true.
    pub fn hits(&self, bounds: &Bounds) -> bool {
        let a = (bounds.lo - self.margin - self.origin) * self.inverse;
        let b = (bounds.hi + self.margin - self.origin) * self.inverse;
        let (mut enter, mut leave) = (self.window.t_min(), self.window.t_max());
        for k in 0..3 {
            enter = enter.max(a[k].min(b[k]));
            leave = leave.min(a[k].max(b[k]));
        }
        enter <= leave
    }
}
