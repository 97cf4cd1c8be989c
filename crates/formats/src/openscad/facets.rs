//! Tessellation of round shapes as in OpenSCAD: number of fragments and positions of vertices.

use super::arguments::{Arguments, Refusal};
use super::extent::Way;
use rayweave_math::Vec3;
use std::f64::consts::TAU;

/// Radius below which OpenSCAD treats a circle as a point: 2^-20.
const GRID_FINE: f64 = 1.0 / 1_048_576.0;

/// Maximum number of fragments of a circle; more would exhaust memory.
const MAX_FRAGMENTS: f64 = 10_000.0;

/// With up to this number of sides, people mean a polygon (a nut, a pyramid); with more, a coarse circle.
const MOST_SIDES_OF_POLYGON: f64 = 8.0;

/// Tessellation parameters of an item: `$fn`, `$fa` (degrees) and `$fs` (length).
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
        match fineness.count > MAX_FRAGMENTS {
            true => Err(arguments.refusal(&format!("$fn is more than {MAX_FRAGMENTS}"))),
            false => Ok(fineness),
        }
    }

    /// The number of fragments that `$fn` states, if it does.
    pub fn stated(&self) -> Option<f64> {
        (self.count > 0.0).then(|| self.count.max(3.0).floor())
    }

    /// True if `$fn` asks for a polygon rather than for a coarse circle: 6 for a nut, 4 for a pyramid.
    pub fn is_polygon(&self) -> bool {
        self.stated().is_some_and(|sides| sides <= MOST_SIDES_OF_POLYGON)
    }

    /// Number of fragments of a full circle.
    pub fn fragments(&self, radius: f64) -> usize {
        let fragments = match self.stated() {
            _ if radius < GRID_FINE => 3.0,
            Some(count) => count,
            None => (360.0 / self.angle).min(radius * TAU / self.size).max(5.0).ceil(),
        };
        fragments.min(MAX_FRAGMENTS) as usize
    }

    /// Number of slices of a `linear_extrude` with twist or unequal scale, over a region with the given extents along x and
    /// y: at least three per turn; from `$fn`, or from the coarser of `$fa` and `$fs` along the path of the farthest point.
    pub fn slices(&self, reach: [f64; 2], twist: f64, way: &Way) -> usize {
        let least = (twist / 120.0).ceil().max(1.0);
        let height = way.top - way.bottom;
        let radius = libm::hypot(reach[0], reach[1]);
        let slices = match () {
            () if self.count > 0.0 && twist > 0.0 => (twist / 360.0 * self.count).ceil(),
            () if self.count > 0.0 => self.count,
            () => {
                let length = match twist > 0.0 {
                    true => libm::hypot(height, spiral(radius, twist.to_radians(), way.scale[0])),
                    false => {
                        let moved = [0, 1].map(|k| (way.scale[k] - 1.0) * reach[k]);
                        libm::hypot(height, libm::hypot(moved[0], moved[1]))
                    }
                };
                let by_size = (length / self.size).ceil();
                if twist > 0.0 { by_size.min((twist / self.angle).ceil()) } else { by_size }
            }
        };
        slices.max(least).min(MAX_FRAGMENTS) as usize
    }
}

/// Path length, projected to the plane, of a point that rotates by an angle while its radius is scaled by a factor: an arc,
/// or a piece of an Archimedean spiral.
fn spiral(radius: f64, angle: f64, factor: f64) -> f64 {
    if factor == 1.0 {
        return radius * angle;
    }
    let end = if factor > 1.0 { angle * factor / (factor - 1.0) } else { angle / (1.0 - factor) };
    let length = |t: f64| 0.5 * radius / end * (t * (1.0 + t * t).sqrt() + libm::asinh(t));
    length(end) - length(end - angle)
}

/// Direction of fragment `k` of `n`, as (cos, sin).
pub(super) fn direction(k: f64, n: usize) -> [f64; 2] {
    let angle = 360.0 * k / n as f64;
    let (sin, cos) = rayweave_math::sin_cos_degrees(angle);
    [cos, sin]
}

/// Rings (radius, z) of a sphere, from the top down, none at the poles.
pub(super) fn sphere_rings(radius: f64, fragments: usize) -> Vec<[f64; 2]> {
    let rings = fragments.div_ceil(2);
    let ring = |k: usize| {
        let angle = 180.0 * (k as f64 + 0.5) / rings as f64;
        let (sin, cos) = rayweave_math::sin_cos_degrees(angle);
        [radius * sin, radius * cos]
    };
    (0..rings).map(ring).collect()
}

/// Planes (a, b, c, d) of the convex solid between rings (radius, z) of `fragments` vertices each, from the top down,
/// closed by flat faces at both ends. A ring may be a point.
pub(super) fn ring_planes(rings: &[[f64; 2]], fragments: usize) -> Vec<[f64; 4]> {
    let (top, bottom) = (rings[0], rings[rings.len() - 1]);
    let mut planes = Vec::with_capacity(rings.len() * fragments);
    // a ring that is a point has no face
    if top[0] > 0.0 {
        planes.push([0.0, 0.0, 1.0, top[1]]);
    }
    if bottom[0] > 0.0 {
        planes.push([0.0, 0.0, -1.0, -bottom[1]]);
    }
    // distance from the axis to the midpoint of an edge
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

/// Vertices of rings.
pub(super) fn ring_points(rings: &[[f64; 2]], fragments: usize) -> Vec<Vec3> {
    let mut points = Vec::with_capacity(rings.len() * fragments);
    for &[radius, z] in rings {
        let count = if radius > 0.0 { fragments } else { 1 };
        points.extend((0..count).map(|k| {
            let [cos, sin] = direction(k as f64, fragments);
            Vec3::new(radius * cos, radius * sin, z)
        }));
    }
    points
}
