//! Which leaves a ray can touch. May change speed, never an answer.
//!
//! A leaf counts where it can matter ([`rayweave_model::Leaf::matters`]): a ray that passes outside of that box
//! would see no flip of it that changes anything. Boxes are grown by more than any kernel can err.

mod hierarchy;

use hierarchy::Hierarchy;
use rayweave_math::{Bounds, UNIT_ROUNDOFF, Vec3};
use rayweave_model::{Program, Prototype, Window};
use rayweave_shape::Ray;

/// The leaves of a group by where they are.
#[derive(Clone, Debug)]
pub(crate) struct Accel {
    /// Leaves that can matter without bound: every ray can touch them.
    unbounded: Vec<u32>,
    hierarchy: Hierarchy,
}

/// What the position of a ray's origin adds to the growth of every box; see [`rayweave_model::Leaf::margin`] for the
/// share of the leaf itself.
const MARGIN: f64 = 256.0 * UNIT_ROUNDOFF;

impl Accel {
    pub fn new(program: &Program, group: &Prototype) -> Accel {
        let leaves = &program.leaves()[group.leaves.start as usize..group.leaves.end as usize];
        let (mut unbounded, mut boxes) = (Vec::new(), Vec::new());
        for (k, leaf) in leaves.iter().enumerate() {
            if leaf.bounds.is_finite() {
                let size = leaf.bounds.lo.abs().max(leaf.bounds.hi.abs()).length() + leaf.transform.path;
                boxes.push((leaf.bounds.grown(MARGIN * size), k as u32));
            } else if !leaf.bounds.is_empty() {
                unbounded.push(k as u32);
            }
        }
        Accel { unbounded, hierarchy: Hierarchy::new(boxes) }
    }

    /// The leaves that the ray can touch within the window.
    pub fn touched(&self, ray: &Ray, window: Window, out: &mut Vec<u32>) {
        out.extend_from_slice(&self.unbounded);
        self.hierarchy.touched(&Probe::new(ray, window), out);
    }

    /// The leaves whose bounds hold a point.
    pub fn around(&self, point: Vec3, out: &mut Vec<u32>) {
        out.extend_from_slice(&self.unbounded);
        self.hierarchy.around(point, MARGIN * point.length(), out);
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
    fn new(ray: &Ray, window: Window) -> Probe {
        let inverse = Vec3::ONE / ray.direction;
        Probe { origin: ray.origin, inverse, margin: MARGIN * ray.origin.length(), window }
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
