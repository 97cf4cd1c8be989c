//! The coordinate frame of a BVH, in which boxes and rays are rounded to f32.
//!
//! Boxes are stored as `(p - centre) * scale`: all coordinates lie between -1 and 1 for any position and size
//! of the model. Corners are rounded outwards. The origin of a ray is moved to its point closest to the
//! centre and scaled likewise, so that all numbers in the slab test have the size of the model.

use super::build::Item;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{MARGIN, Window};
use rayweave_shape::Ray;

/// Map from the coordinates of a group to those of its hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    centre: Vec3,
    /// A power of two.
    scale: f64,
}

/// Growth of boxes that covers the f32 rounding of the slab test.
///
/// Times along the ray inside the frame are at most 2. The time computed for a plane through which the ray
/// enters or leaves a box there is at most 4, or has no effect. For such a plane at `p`, with u = 2^-24, `|p|
/// <= 1`, an origin `|o| < 2` and a component `|d| <= 1` of the direction, `(p - o) * (1 / d)` has an error
/// of at most `2 u / |d|` from the origin, `3 u / |d|` from the difference, `2 u * 4` from the other two
/// operations, and `4 * 2^-40 / |d|` where d is kept off zero: together less than 14 u / |d|. Growing the box
/// by 16 u moves the time by 16 u / |d|, which is more.
const ROUNDING: f64 = 16.0 / (1 << 24) as f64;

/// Least absolute value of a direction component: over a length of 4 it moves the ray by less than u.
const LEAST: f64 = 1.0 / (1u64 << 40) as f64;

/// Bound of the times at which a ray is in the frame: the corners of a box are at a distance of at most
/// sqrt(3), and 4 leaves room for grown boxes.
const END: f64 = 4.0;

impl Frame {
    /// The frame of boxes with the finite bounds `all`.
    pub fn new(all: &Bounds) -> Frame {
        let half = 0.5 * all.size().max_element();
        let exponent = if half > 0.0 { -1 - libm::ilogb(half) } else { 0 };
        Frame { centre: all.centre(), scale: libm::ldexp(1.0, exponent.clamp(-1000, 1000)) }
    }

    /// The unit of length: between one half and the whole of the largest extent of all boxes.
    pub fn size(&self) -> f64 {
        1.0 / self.scale
    }

    /// A box in this frame. Each corner is moved outwards by at least half an ulp of f32, far more than the
    /// f64 rounding errors of the map.
    pub fn item(&self, bounds: &Bounds, leaf: u32) -> Item {
        let (lo, hi) = ((bounds.lo - self.centre) * self.scale, (bounds.hi - self.centre) * self.scale);
        Item {
            lo: lo.to_array().map(|x| (x as f32).next_down()),
            hi: hi.to_array().map(|x| (x as f32).next_up()),
            leaf,
        }
    }

    /// Growth of boxes that covers the rounding errors of the map into this frame: a few u of the lengths
    /// involved.
    fn margin(&self, from: Vec3) -> f64 {
        MARGIN * (from.length() + self.centre.length())
    }

    /// Prepares a ray for tests against boxes that are to be grown by `margin`.
    pub fn probe(&self, ray: &Ray, margin: f64, window: Window) -> Probe {
        let speed = ray.direction.length();
        let (begin, rate) = (ray.closest_time(self.centre), speed * self.scale);
        let origin = (ray.at(begin) - self.centre) * self.scale;
        let grown = (margin + self.margin(ray.origin)) * self.scale + ROUNDING;
        let mut probe = Probe { begin, pace: 1.0 / rate, ..Probe::default() };
        for k in 0..3 {
            let along = ray.direction[k] / speed;
            let along = if along.abs() < LEAST { LEAST.copysign(along) } else { along };
            let ahead = along > 0.0;
            let side = if ahead { grown } else { -grown };
            (probe.near[k], probe.far[k]) = if ahead { (k, k + 3) } else { (k + 3, k) };
            probe.near_origin[k] = (origin[k] + side) as f32;
            probe.far_origin[k] = (origin[k] - side) as f32;
            probe.inverse[k] = (1.0 / along) as f32;
        }
        // the window may be infinite; its bounds have an error as small as that of the origin
        let time = |t: f64| ((t - begin) * rate).clamp(-END, END);
        probe.window = [(time(window.t_min()) - ROUNDING) as f32, (time(window.t_max()) + ROUNDING) as f32];
        probe
    }

    /// The box of a point, grown by `margin`.
    pub fn around(&self, point: Vec3, margin: f64) -> Item {
        let grown = (margin + self.margin(point)) * self.scale + ROUNDING;
        let at = ((point - self.centre) * self.scale).to_array();
        let (lo, hi) = (at.map(|x| (x - grown) as f32), at.map(|x| (x + grown) as f32));
        Item { lo: lo.map(f32::next_down), hi: hi.map(f32::next_up), leaf: 0 }
    }
}

/// A ray in the frame of a hierarchy, prepared for slab tests.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Probe {
    /// Indices of the planes through which the ray enters and leaves a box: 0, 1, 2 for lo and 3, 4, 5 for
    /// hi.
    pub near: [usize; 3],
    pub far: [usize; 3],
    /// The origin, shifted by the growth of the boxes: along the ray for entry planes, against it for exit
    /// planes.
    pub near_origin: [f32; 3],
    pub far_origin: [f32; 3],
    pub inverse: [f32; 3],
    pub window: [f32; 2],
    /// Time at the origin, in the original ray's parameter, and change of that parameter per unit of time
    /// here.
    begin: f64,
    pace: f64,
}

impl Probe {
    /// Converts a time of the frame to the original ray's parameter. The growth of boxes covers the f64
    /// rounding.
    pub fn time(&self, here: f32) -> f64 {
        self.begin + f64::from(here) * self.pace
    }

    /// A time by which the ray has left every box.
    pub fn end(&self) -> f64 {
        self.begin + END * self.pace
    }
}
