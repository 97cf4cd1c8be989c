//! Watertight line-triangle intersection with symbolic perturbation.
//!
//! *Source*: S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", Journal of Computer Graphics Techniques
//! 2 (2013): a shear maps the line to the coordinate axis of its largest component. Projection along this axis maps the line to
//! the origin and each vertex to a point of the plane, which depends on the vertex and the line alone.
//!
//! *Guarantee*: a line crosses a triangle if the projected triangle contains the origin. Orientation signs are exact for
//! the computed projections; where an orientation is 0, the sign is that for the origin moved by (e, e^2), e > 0 infinitesimal
//! (H. Edelsbrunner, E. P. Mücke, "Simulation of simplicity", 1990), the same point for all triangles. A line therefore
//! crosses every closed mesh an even number of times, also through edges and vertices. The error of a projection is at most
//! `4 u (|o| + |v|)`, the rounding error of points of the line.

use rayweave_math::roots::difference_of_products;
use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// The infinite line `r(t) = origin + t direction`.
///
/// Components of the origin are at most 1e100 in absolute value, and the largest one of the direction is between 1e-70
/// and 1e70.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The point at t = 0.
    pub origin: Vec3,
    /// The displacement per unit of t, of any length.
    pub direction: Vec3,
}

/// Directions of symbolic perturbation: a line that lies in a face counts as moved along the first of these directions that is not
/// tangent to the face.
pub type Perturbation = [Vec3; 4];

/// A crossing of the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshCrossing {
    /// The time, in units of the direction.
    pub t: f64,
    /// The index of the triangle in the mesh.
    pub triangle: u32,
}

impl Line {
    /// The point at time `t`.
    pub fn at(&self, t: f64) -> Vec3 {
        self.origin + t * self.direction
    }

    /// The time at which the line is closest to a point.
    pub fn closest_time(&self, point: Vec3) -> f64 {
        (point - self.origin).dot(self.direction) / self.direction.length_squared()
    }

    /// The tolerance at time `t`: within this distance, rounding makes points of the line and of a face indistinguishable.
    /// `magnitude` bounds the distance of the face from the origin.
    pub fn delta(&self, t: f64, magnitude: f64) -> f64 {
        64.0 * UNIT_ROUNDOFF * (self.origin.length() + t.abs() * self.direction.length() + magnitude)
    }
}

/// The projection of a point along a line.
pub(crate) type Image = [f64; 2];

/// Coordinates of projections below this are set to 0: products of two would underflow.
const MIN_IMAGE: f64 = 1e-130;

/// The shear that maps a line to a coordinate axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    origin: Vec3,
    axes: [usize; 3],
    slope: [f64; 2],
}

impl Shear {
    pub fn new(line: &Line) -> Shear {
        let d = line.direction.abs();
        let z = if d.x > d.y && d.x > d.z { 0 } else { 1 + usize::from(d.z >= d.y) };
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let slope = [0, 1].map(|k| line.direction[axes[k]] / line.direction[z]);
        Shear { origin: line.origin, axes, slope }
    }

    /// The projection of a point along the line, with the line at the origin.
    pub fn image(&self, point: Vec3) -> Image {
        let q = (point - self.origin).to_array();
        let [x, y, z] = self.axes.map(|axis| q[axis]);
        [x - self.slope[0] * z, y - self.slope[1] * z].map(|x| if x.abs() < MIN_IMAGE { 0.0 } else { x })
    }
}

/// The orientation of `p`, `q` and the origin moved by (e, e^2): 1 counter-clockwise, -1 clockwise, 0 only if `p` and `q` are
/// equal.
pub(crate) fn orientation(p: Image, q: Image) -> i8 {
    let (a, b) = (p[0] * q[1], p[1] * q[0]);
    // floating-point filter: two products and a difference, each with an error of at most u
    if (a - b).abs() > 4.0 * UNIT_ROUNDOFF * (a.abs() + b.abs()) {
        return if a > b { 1 } else { -1 };
    }
    sign(difference_of_products(p[0], q[1], p[1], q[0]))
        .or_else(|| sign_of_difference(p[1], q[1]))
        .or_else(|| sign_of_difference(q[0], p[0]))
        .unwrap_or(0)
}

fn sign(x: f64) -> Option<i8> {
    sign_of_difference(x, 0.0)
}

/// The sign of `a - b`, by comparison, which does not round.
fn sign_of_difference(a: f64, b: f64) -> Option<i8> {
    if a == b { None } else { Some(if a > b { 1 } else { -1 }) }
}

/// True if a projected triangle contains the origin moved by (e, e^2).
pub(crate) fn contains_origin([a, b, c]: [Image; 3]) -> bool {
    let first = orientation(a, b);
    first != 0 && first == orientation(b, c) && first == orientation(c, a)
}

/// True if the projected corners and the origin may be collinear within `delta`: the plane of the triangle may contain the line.
pub(crate) fn is_edge_on([a, b, c]: [Image; 3], delta: f64) -> bool {
    let size = |p: Image| p[0].abs() + p[1].abs();
    let is_near = |p: Image, q: Image| {
        let area = p[0] * q[1] - p[1] * q[0];
        area.abs() <= 4.0 * delta * (size(p) + size(q) + delta)
    };
    is_near(a, b) && is_near(b, c) && is_near(c, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::rational::RBig;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    /// The orientation about the point (e, e^2) for a rational e smaller than any difference of the inputs.
    fn oracle(p: Image, q: Image) -> i8 {
        let exact = |x: f64| RBig::try_from(x).unwrap();
        let e = RBig::from_parts(1.into(), dashu::integer::UBig::ONE << 600);
        let [px, qx] = [p[0], q[0]].map(|x| exact(x) - &e);
        let [py, qy] = [p[1], q[1]].map(|y| exact(y) - &e * &e);
        (px * qy).cmp(&(py * qx)) as i8
    }

    #[test]
    fn orientations_are_those_about_one_point_beside_the_origin() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (mut left, mut right, mut none) = (0, 0, 0);
        for _ in 0..20_000 {
            let slope = f64::from(rng.random_range(-4i32..=4));
            let mut image = || {
                let x = f64::from(rng.random_range(-4i32..=4)) * 0.1;
                let y = slope * x;
                let ulps = if rng.random_bool(0.2) { rng.random_range(-1i64..=1) } else { 0 };
                if y == 0.0 { [x, y] } else { [x, f64::from_bits((y.to_bits() as i64 + ulps) as u64)] }
            };
            let (p, q) = (image(), image());
            let found = orientation(p, q);
            assert_eq!(found, oracle(p, q), "{p:?} {q:?}");
            assert_eq!(found, -orientation(q, p));
            match found {
                1 => left += 1,
                -1 => right += 1,
                _ => none += 1,
            }
        }
        assert!(left > 5000 && right > 5000 && none > 500, "{left} {right} {none}");
    }
}
