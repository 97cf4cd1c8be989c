//! The coordinate frame of a tree, in which boxes and rays are rounded to `f32`.
//!
//! Boxes are stored as `(p - centre) / unit`: all coordinates lie between -1 and 1 for any position and size of
//! the model. Corners are rounded outwards. The origin of a ray is moved to its point closest to the centre and
//! scaled likewise, so that all numbers in the slab test have the size of the model.

use crate::build::Item;
use rayweave_math::{Bounds, UNIT_ROUNDOFF, Vec3};

/// Map from the coordinates of the boxes to those of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub centre: Vec3,
    /// Half of the largest extent of all boxes together.
    pub unit: f64,
    /// The inverse of the unit.
    scale: f64,
}

/// Growth of boxes, in units of the frame, that covers the `f32` rounding of the slab test.
///
/// Times along the ray inside the frame are at most 2. The time computed for a plane through which the ray
/// enters or leaves a box there is at most 4, or has no effect. For such a plane at `p`, with u = 2^-24, `|p|
/// <= 1`, an origin `|o| < 2` and a component `|d| <= 1` of the direction, `(p - o) * (1 / d)` has an error
/// of at most `2 u / |d|` from the origin, `3 u / |d|` from the difference, `2 u * 4` from the other two
/// operations, and `4 * 2^-40 / |d|` where d is kept off zero: together less than 14 u / |d|. Growing the box
/// by 16 u moves the time by 16 u / |d|, which is more; the difference also covers the errors of the map into the
/// frame, a few units of 2^-53.
pub(crate) const ROUNDING: f64 = 16.0 / (1 << 24) as f64;

/// Least absolute value of a direction component: over a length of 4 it moves the ray by less than u.
pub(crate) const LEAST: f64 = 1.0 / (1u64 << 40) as f64;

/// Bound of the times at which a ray is in the frame: the corners of a box are at a distance of at most
/// sqrt(3), and 4 leaves room for grown boxes. The bound grows with a growth of more than one unit.
const END: f64 = 4.0;

/// Error of a point in the coordinates of the boxes and of the map into the frame, relative to the lengths
/// involved.
const MAP_ERROR: f64 = 256.0 * UNIT_ROUNDOFF;

/// Limit of the coordinates of rays in the frame. Their products with `f32` planes and inverse directions do not
/// overflow to a difference of infinities.
const MAX_COORDINATE: f64 = 1e20;

impl Frame {
    /// The frame of boxes with the bounds `all`, which are finite or empty.
    pub fn new(all: &Bounds) -> Frame {
        if !all.is_finite() {
            return Frame { centre: Vec3::ZERO, unit: 1.0, scale: 1.0 };
        }
        let half = (0.5 * all.hi - 0.5 * all.lo).max_element();
        let unit = if half > 0.0 { half.max(1e-290) } else { 1.0 };
        Frame { centre: all.centre(), unit, scale: 1.0 / unit }
    }

    /// The inverse of the unit.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// A box in this frame, rounded outwards.
    pub fn item(&self, bounds: &Bounds, number: u32) -> Item {
        let [lo, hi] = [bounds.lo, bounds.hi].map(|p| ((p - self.centre) / self.unit).to_array());
        Item { lo: lo.map(below), hi: hi.map(above), number }
    }

    /// Growth of boxes, in units of the frame: the caller's margin and the error of the map into the frame.
    pub fn growth(&self, from: Vec3, margin: f64) -> f64 {
        (margin + MAP_ERROR * (from.length() + self.centre.length())) * self.scale
    }

    /// A point in this frame, with the growth of boxes for it.
    pub fn point(&self, point: Vec3, margin: f64) -> ([f64; 3], f64) {
        (((point - self.centre) * self.scale).to_array(), self.growth(point, margin))
    }

    /// Prepares a ray for tests against boxes that are to be grown by `margin`.
    pub fn probe(&self, origin: Vec3, direction: Vec3, margin: f64, [t_min, t_max]: [f64; 2]) -> Probe {
        let begin = (self.centre - origin).dot(direction) / direction.length_squared();
        let speed = direction.length();
        let rate = speed * self.scale;
        let foot = (origin + begin * direction - self.centre) * self.scale;
        let grown = self.growth(origin, margin) + ROUNDING;
        let end = END * grown.max(1.0);
        let mut probe = Probe { begin, pace: 1.0 / rate, end, ..Probe::default() };
        for k in 0..3 {
            let along = direction[k] / speed;
            let along = if along.abs() < LEAST { LEAST.copysign(along) } else { along };
            let is_ahead = along > 0.0;
            let side = if is_ahead { grown } else { -grown };
            (probe.near[k], probe.far[k]) = if is_ahead { (k, k + 3) } else { (k + 3, k) };
            probe.near_origin[k] = (foot[k] + side).clamp(-MAX_COORDINATE, MAX_COORDINATE) as f32;
            probe.far_origin[k] = (foot[k] - side).clamp(-MAX_COORDINATE, MAX_COORDINATE) as f32;
            probe.inverse[k] = (1.0 / along) as f32;
        }
        // the window may be infinite; its bounds have an error as small as that of the origin
        let time = |t: f64| ((t - begin) * rate).clamp(-end, end);
        probe.window = [(time(t_min) - ROUNDING) as f32, (time(t_max) + ROUNDING) as f32];
        if !(begin.is_finite() && foot.is_finite() && (1.0 / rate).is_finite()) {
            probe.window = [1.0, -1.0];
        }
        probe
    }

    /// A box in this frame for tests of overlap, grown by `margin`.
    pub fn around(&self, bounds: &Bounds, margin: f64) -> Item {
        let grown = self.growth(bounds.lo.abs().max(bounds.hi.abs()), margin) + ROUNDING;
        let [lo, hi] = [bounds.lo, bounds.hi].map(|p| ((p - self.centre) * self.scale).to_array());
        let (lo, hi) = (lo.map(|x| below(x - grown)), hi.map(|x| above(x + grown)));
        Item { lo, hi, number: 0 }
    }
}

pub(crate) fn below(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

pub(crate) fn above(x: f64) -> f32 {
    -below(-x)
}

/// A ray in the frame of a tree, prepared for slab tests.
#[derive(Clone, Copy, Debug, Default)]
pub struct Probe {
    /// Indices of the planes through which the ray enters and leaves a box: 0, 1, 2 for lo and 3, 4, 5 for
    /// hi.
    pub(crate) near: [usize; 3],
    pub(crate) far: [usize; 3],
    /// The origin, shifted by the growth of the boxes: along the ray for entry planes, against it for exit
    /// planes.
    pub(crate) near_origin: [f32; 3],
    pub(crate) far_origin: [f32; 3],
    pub(crate) inverse: [f32; 3],
    pub(crate) window: [f32; 2],
    /// Time at the origin, in the original ray's parameter, and change of that parameter per unit of time
    /// here.
    begin: f64,
    pace: f64,
    end: f64,
}

impl Probe {
    /// Converts a time of the frame to the original ray's parameter. The growth of boxes covers the f64
    /// rounding.
    pub(crate) fn time(&self, here: f32) -> f64 {
        self.begin + f64::from(here) * self.pace
    }

    /// A time of the original ray's parameter in the frame, rounded up like the end of the window.
    pub(crate) fn here(&self, time: f64) -> f32 {
        (((time - self.begin) / self.pace).clamp(-self.end, self.end) + ROUNDING) as f32
    }

    /// A time by which the ray has left every box.
    pub(crate) fn end(&self) -> f64 {
        self.begin + self.end * self.pace
    }
}
