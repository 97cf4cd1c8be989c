//! The frame of a hierarchy, in which boxes and rays are rounded to f32.
//!
//! Boxes are stored as `(p - centre) * scale`, so that all of them lie between -1 and 1 wherever the model is and
//! however large; corners are rounded outwards. A ray is asked about from its point closest to the centre, in
//! units of length of this frame, so that what the slab test computes is of the size of the model, too.

use super::build::Item;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{MARGIN, Window};
use rayweave_shape::Ray;

/// From the frame of a group to that of its hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    centre: Vec3,
    /// A power of two.
    scale: f64,
}

/// What f32 adds to the growth of boxes. A time along the ray within the frame is at most 2, one that is computed for a
/// plane of a box that the ray enters or leaves there at most 4 or of no account. For such a plane at `p`, with
/// u = 2^-24 and `|p| <= 1`, an origin `|o| < 2` and a component `|d| <= 1` of the direction, `(p - o) * (1 / d)` has an
/// error of at most `2 u / |d|` from the origin, `3 u / |d|` from the difference, `2 u * 4` from the two other operations,
/// and `4 * 2^-40 / |d|` where d is kept off zero: together less than 14 u / |d|. Growing the box by 16 u moves the time
/// by more, 16 u / |d|.
const ROUNDING: f64 = 16.0 / (1 << 24) as f64;

/// No component of a direction is nearer to zero than this: over a way of 4 it moves the ray by less than u.
const LEAST: f64 = 1.0 / (1u64 << 40) as f64;

/// No ray is in the frame at a time beyond this: the corner of a box is at a distance of at most sqrt(3), and grown boxes
/// that are larger are met there, too.
const END: f64 = 4.0;

impl Frame {
    /// A frame for boxes within a box that is finite.
    pub fn new(all: &Bounds) -> Frame {
        let half = 0.5 * all.size().max_element();
        let exponent = if half > 0.0 { -1 - libm::ilogb(half) } else { 0 };
        Frame { centre: all.centre(), scale: libm::ldexp(1.0, exponent.clamp(-1000, 1000)) }
    }

    /// The unit of length: between half of the largest extent of all boxes and all of it.
    pub fn size(&self) -> f64 {
        1.0 / self.scale
    }

    /// A box in this frame, each corner at least half an ulp of f32 farther out than it is, which is far more than f64
    /// rounds on the way.
    pub fn item(&self, bounds: &Bounds, leaf: u32) -> Item {
        let (lo, hi) = ((bounds.lo - self.centre) * self.scale, (bounds.hi - self.centre) * self.scale);
        Item {
            lo: lo.to_array().map(|x| (x as f32).next_down()),
            hi: hi.to_array().map(|x| (x as f32).next_up()),
            leaf,
        }
    }

    /// What the roundings on the way into this frame add to the growth of boxes: a few u of the lengths involved.
    fn margin(&self, from: Vec3) -> f64 {
        MARGIN * (from.length() + self.centre.length())
    }

    /// A ray ready for tests against boxes that are to be grown by `margin`.
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
        // a window may end at infinity; a bound errs by as little as the origin does
        let time = |t: f64| ((t - begin) * rate).clamp(-END, END);
        probe.window = [(time(window.t_min()) - ROUNDING) as f32, (time(window.t_max()) + ROUNDING) as f32];
        probe
    }

    /// A point as the box that holds it, grown by `margin`.
    pub fn around(&self, point: Vec3, margin: f64) -> Item {
        let grown = (margin + self.margin(point)) * self.scale + ROUNDING;
        let at = ((point - self.centre) * self.scale).to_array();
        let (lo, hi) = (at.map(|x| (x - grown) as f32), at.map(|x| (x + grown) as f32));
        Item { lo: lo.map(f32::next_down), hi: hi.map(f32::next_up), leaf: 0 }
    }
}

/// A ray in the frame of a hierarchy, ready for tests against its boxes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Probe {
    /// The numbers of the planes by which the ray enters a box, and leaves it: lo 0, 1, 2 and hi 3, 4, 5.
    pub near: [usize; 3],
    pub far: [usize; 3],
    /// The origin, moved by the growth of boxes to the other side of each plane.
    pub near_origin: [f32; 3],
    pub far_origin: [f32; 3],
    pub inverse: [f32; 3],
    pub window: [f32; 2],
    /// The ray's own time at the origin, and for a unit of time here.
    begin: f64,
    pace: f64,
}

impl Probe {
    /// The ray's own time of a time of the frame. What f64 rounds here is part of the growth of boxes.
    pub fn time(&self, here: f32) -> f64 {
        self.begin + f64::from(here) * self.pace
    }

    /// A time by which the ray has left every box.
    pub fn end(&self) -> f64 {
        self.begin + END * self.pace
    }
}
