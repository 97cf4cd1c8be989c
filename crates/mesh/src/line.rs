//! A line, and on which side of it points and edges are.
//!
//! *Source*: S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", Journal of Computer Graphics Techniques
//! 2 (2013): space is sheared until the line is the axis of its largest component, so that each vertex becomes a point of
//! the plane, computed from that vertex and the line alone, and the line the origin.
//!
//! *Guarantee*: a triangle is crossed if its image holds the origin. The sign of a turn is exact for the computed images
//! and, where it is 0, that of the origin moved by (e, e^2), e > 0 infinitesimal: one point, in general position, for all
//! triangles. So every closed mesh is crossed an even number of times, through edges and vertices too. An image is off by
//! `4 u (|o| + |v|)` at most, the rounding of points of the line.

use rayweave_math::roots::difference_of_products;
use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// `r(t) = origin + t direction`, the whole line.
///
/// Components of the origin are at most 1e100 in absolute value, the largest of the direction is between 1e-70 and 1e70.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The point at t = 0.
    pub origin: Vec3,
    /// The displacement per unit of t.
    pub direction: Vec3,
}

/// Where a line that lies in a face is moved in thought: along the first of these directions that leaves the face.
pub type Aside = [Vec3; 4];

/// A change of side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// When, in units of the direction.
    pub t: f64,
    /// Through which triangle, by the mesh's own numbers.
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

    /// The distance within which points of the line at time `t` cannot be told from a face as far away as `reach`.
    pub fn delta(&self, t: f64, reach: f64) -> f64 {
        64.0 * UNIT_ROUNDOFF * (self.origin.length() + t.abs() * self.direction.length() + reach)
    }
}

/// A point of the plane across a line.
pub(crate) type Image = [f64; 2];

const LEAST_IMAGE: f64 = 1e-130;

/// The shear that makes a line an axis.
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

    /// A point, seen along the line, which is the origin.
    pub fn image(&self, point: Vec3) -> Image {
        let q = (point - self.origin).to_array();
        let [x, y, z] = self.axes.map(|axis| q[axis]);
        // below LEAST_IMAGE a product of two might vanish
        [x - self.slope[0] * z, y - self.slope[1] * z].map(|x| if x.abs() < LEAST_IMAGE { 0.0 } else { x })
    }
}

/// How the origin, moved by (e, e^2), sees the way from `p` to `q` turn: 1 left, -1 right; 0 only if they are equal.
pub(crate) fn turn(p: Image, q: Image) -> i8 {
    let (a, b) = (p[0] * q[1], p[1] * q[0]);
    // two products and a difference, each off by u at most
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

/// The sign of `a - b`, which a comparison knows without rounding.
fn sign_of_difference(a: f64, b: f64) -> Option<i8> {
    if a == b { None } else { Some(if a > b { 1 } else { -1 }) }
}

/// True if the image of a triangle holds the origin, moved by (e, e^2).
pub(crate) fn holds_origin([a, b, c]: [Image; 3]) -> bool {
    let first = turn(a, b);
    first != 0 && first == turn(b, c) && first == turn(c, a)
}

/// True if the three corners and the origin may lie on one line, within `delta`: if the triangle may lie along the line.
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

    /// The same turn about the point (e, e^2) for a rational e smaller than any difference of the inputs.
    fn oracle(p: Image, q: Image) -> i8 {
        let exact = |x: f64| RBig::try_from(x).unwrap();
        let e = RBig::from_parts(1.into(), dashu::integer::UBig::ONE << 600);
        let [px, qx] = [p[0], q[0]].map(|x| exact(x) - &e);
        let [py, qy] = [p[1], q[1]].map(|y| exact(y) - &e * &e);
        (px * qy).cmp(&(py * qx)) as i8
    }

    #[test]
    fn turns_are_those_about_one_point_beside_the_origin() {
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
            let found = turn(p, q);
            assert_eq!(found, oracle(p, q), "{p:?} {q:?}");
            assert_eq!(found, -turn(q, p));
            match found {
                1 => left += 1,
                -1 => right += 1,
                _ => none += 1,
            }
        }
        assert!(left > 5000 && right > 5000 && none > 500, "{left} {right} {none}");
    }
}
