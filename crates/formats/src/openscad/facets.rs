//! How finely OpenSCAD divides round shapes, and where it puts their vertices.

use super::arguments::{Arguments, Refusal};
use std::f64::consts::TAU;

/// What OpenSCAD takes as no radius at all: 2^-20.
const GRID_FINE: f64 = 1.0 / 1_048_576.0;

/// More fragments than these would ask for all memory.
const MOST_FRAGMENTS: f64 = 10_000.0;

/// `$fn`, `$fa` (degrees) and `$fs` (length) of an item.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fineness {
    count: f64,
    angle: f64,
    size: f64,
}

impl Fineness {
    pub fn of(arguments: &Arguments) -> Result<Fineness, Refusal> {
        let fineness = Fineness {
            count: arguments.number("$fn", 0.0)?,
            angle: arguments.number("$fa", 12.0)?.max(0.01),
            size: arguments.number("$fs", 2.0)?.max(0.01),
        };
        match fineness.count > MOST_FRAGMENTS {
            true => Err(arguments.refusal(&format!("$fn is more than {MOST_FRAGMENTS}"))),
            false => Ok(fineness),
        }
    }

    /// The number of fragments of a full circle.
    pub fn fragments(&self, radius: f64) -> usize {
        let fragments = match () {
            () if radius < GRID_FINE => 3.0,
            () if self.count > 0.0 => self.count.max(3.0).floor(),
            () => (360.0 / self.angle).min(radius * TAU / self.size).max(5.0).ceil(),
        };
        fragments.min(MOST_FRAGMENTS) as usize
    }
}

/// The direction of fragment `k` of `n`, as (cos, sin).
pub(super) fn direction(k: f64, n: usize) -> [f64; 2] {
    let angle = 360.0 * k / n as f64;
    let (sin, cos) = rayweave_math::sin_cos_degrees(angle);
    [cos, sin]
}

/// The rings (radius, z) of a sphere, from the top down: none at the poles.
pub(super) fn sphere_rings(radius: f64, fragments: usize) -> Vec<[f64; 2]> {
    let rings = fragments.div_ceil(2);
    let ring = |k: usize| {
        let angle = 180.0 * (k as f64 + 0.5) / rings as f64;
        let (sin, cos) = rayweave_math::sin_cos_degrees(angle);
        [radius * sin, radius * cos]
    };
    (0..rings).map(ring).collect()
}

/// The planes (a, b, c, d) of the convex solid between rings (radius, z) of `fragments` vertices each, from the top down,
/// closed by flat faces at both ends. A ring may be a point.
pub(super) fn ring_planes(rings: &[[f64; 2]], fragments: usize) -> Vec<[f64; 4]> {
    let (top, bottom) = (rings[0], rings[rings.len() - 1]);
    let mut planes = Vec::with_capacity(rings.len() * fragments);
    // a point at the end has no face
    if top[0] > 0.0 {
        planes.push([0.0, 0.0, 1.0, top[1]]);
    }
    if bottom[0] > 0.0 {
        planes.push([0.0, 0.0, -1.0, -bottom[1]]);
    }
    // from the axis to the middle of an edge
    let inner = direction(0.5, fragments)[0];
    for pair in rings.windows(2) {
        let [upper, lower] = [pair[0], pair[1]].map(|[radius, z]| [radius * inner, z]);
        let (outward, upward) = (upper[1] - lower[1], lower[0] - upper[0]);
        let offset = outward * upper[0] + upward * upper[1];
        planes.extend((0..fragments).map(|k| {
            let [cos, sin] = direction(k as f64 + 0.5, fragments);
            [outward * cos, outward * sin, upward, offset]
        }));
    }
    planes
}
