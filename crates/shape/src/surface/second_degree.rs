//! Comparison of surfaces of degree 2, independently of the axes that describe them.
//!
//! A quadric lists its principal axes in any order and sense, and the axes of equal weights are any perpendicular vectors of
//! the plane (or space) that they span. So an ellipsoid turned by 90 degrees, and an ellipsoid with two equal half axes turned
//! by any angle about the third, can be the same surface with other axes. The sign of the equation is free as well: it
//! only exchanges the sides. Spheres, circular cylinders and cones are quadrics, too.

use super::{Quadric, Surface};
use rayweave_math::{UNIT_ROUNDOFF, Vec3, any_perpendicular};

/// Relative tolerance of equality: see [`share`](super::share).
pub(super) const TOLERANCE: f64 = 64.0 * UNIT_ROUNDOFF;

/// A surface of degree 2 as a quadric, with the matrix of its squares.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equation {
    /// The quadric, with its centre moved to the point nearest to the origin along the directions in which the surface does not
    /// change: a hyperbolic cylinder that is moved along itself is the same surface.
    quadric: Quadric,
    /// The entries xx, yy, zz, xy, xz, yz of `sum w_k e_k e_k^T`.
    matrix: [f64; 6],
    /// True if the surface may be a sphere, a circular cylinder or a cone.
    pub is_round: bool,
}

impl Equation {
    /// Number of [`Equation::number`]s.
    pub const NUMBERS: usize = 13;

    /// The equation of a surface; `None` for planes and for surfaces of a higher degree.
    pub fn new(surface: &Surface) -> Option<Equation> {
        let round = |centre: Vec3, axis: Vec3, weights: Vec3, constant: f64| {
            let side = any_perpendicular(axis);
            let axes = [side, axis.cross(side), axis];
            let largest = weights.abs().max_element();
            Quadric { centre, axes, weights: weights / largest, linear: Vec3::ZERO, constant }
        };
        let quadric = match surface {
            Surface::Sphere(s) => round(s.centre, Vec3::Z, Vec3::ONE, -s.radius * s.radius),
            Surface::Cylinder(s) => round(s.point, s.axis, Vec3::new(1.0, 1.0, 0.0), -s.radius * s.radius),
            Surface::Cone(s) => round(s.apex, s.axis, Vec3::new(1.0, 1.0, -s.slope * s.slope), 0.0),
            Surface::Quadric(s) => Quadric { centre: nearest_centre(s), ..**s },
            Surface::Plane(_) | Surface::Torus(_) | Surface::AffineTorus(_) | Surface::Object(_) => {
                return None;
            }
        };
        let term =
            |i: usize, j: usize, k: usize| quadric.weights[k] * quadric.axes[k][i] * quadric.axes[k][j];
        let entry = |(i, j)| term(i, j, 0) + term(i, j, 1) + term(i, j, 2);
        let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        Some(Equation { quadric, matrix: pairs.map(entry), is_round: is_round(&quadric) })
    }

    /// The sum of the weights; its sign distinguishes an equation from its negative unless it is 0.
    pub fn trace(&self) -> f64 {
        self.quadric.weights.element_sum()
    }

    /// Number `k` of the equation times `sign`, with the tolerance by which it may differ between equal surfaces.
    ///
    /// These numbers do not depend on the choice of the axes. They are equal for equal surfaces; the converse needs
    /// [`Equation::has_axes_of`], because an error that is small in the matrix may be large for its smallest weight.
    pub fn number(&self, magnitude: f64, sign: f64, k: usize) -> (f64, f64) {
        let Quadric { centre, linear, constant, .. } = self.quadric;
        match k {
            0..3 => (centre[k], TOLERANCE * magnitude),
            // at most three times the tolerance, by `has_axes_of` for two coordinate axes, and rounding
            3..9 => (sign * self.matrix[k - 3], 4.0 * TOLERANCE),
            9..12 => (sign * linear[k - 9], TOLERANCE * linear.length()),
            // of a sphere or cylinder minus the square of its radius, a length
            _ if self.is_round => {
                let radius = constant.abs().sqrt();
                (sign * constant, 2.0 * TOLERANCE * radius * magnitude.max(radius))
            }
            _ => (sign * constant, TOLERANCE * constant.abs()),
        }
    }

    /// True if the squares of both equations are equal, with those of the other one times `sign`.
    ///
    /// The difference of the two matrices is `sum (w_i - v_j) (e_i . g_j) e_i g_j^T` over all pairs of axes e, g with
    /// weights w, v. Every term has to be within the tolerance of its larger weight: axes of different weights are
    /// perpendicular, and axes that are not have equal weights.
    pub fn has_axes_of(&self, other: &Equation, sign: f64) -> bool {
        let (a, b) = (&self.quadric, &other.quadric);
        (0..9).all(|pair| {
            let (i, j) = (pair / 3, pair % 3);
            let (w, v) = (a.weights[i], sign * b.weights[j]);
            (w - v).abs() * a.axes[i].dot(b.axes[j]).abs() <= TOLERANCE * w.abs().max(v.abs())
        })
    }

    /// True if the equation of an equal surface has the opposite sign.
    pub fn is_negative_of(&self, other: &Equation) -> bool {
        let twice = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0];
        (0..6).map(|k| twice[k] * self.matrix[k] * other.matrix[k]).sum::<f64>() < 0.0
    }
}

/// True if two weights are equal, and the third one is equal to them, is 0 or makes a cone.
fn is_round(quadric: &Quadric) -> bool {
    let Quadric { weights, linear, constant, .. } = *quadric;
    let is_equal = |i: usize, j: usize| (weights[i] - weights[j]).abs() <= TOLERANCE * weights[i].abs();
    let has_axis = |i: usize, j: usize, k: usize| {
        let last = weights[k];
        is_equal(i, j) && (is_equal(i, k) || last == 0.0 || (constant == 0.0 && last * weights[i] < 0.0))
    };
    linear == Vec3::ZERO && (has_axis(0, 1, 2) || has_axis(0, 2, 1) || has_axis(1, 2, 0))
}

/// The centre without its components along the directions in which the surface does not change: those of weight 0 that are
/// perpendicular to the linear part.
fn nearest_centre(quadric: &Quadric) -> Vec3 {
    let flat = |v: Vec3| -> Vec3 {
        let axes = (0..3).filter(|&k| quadric.weights[k] == 0.0).map(|k| quadric.axes[k]);
        axes.map(|axis| v.dot(axis) * axis).sum()
    };
    let rise = flat(quadric.linear);
    let along_rise = match rise.length() > TOLERANCE * quadric.linear.length() {
        true => quadric.centre.dot(rise) / rise.length_squared() * rise,
        false => Vec3::ZERO,
    };
    quadric.centre - flat(quadric.centre) + along_rise
}
