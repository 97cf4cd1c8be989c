//! Surfaces of degree 1 and 2 as symmetric 4 x 4 matrices of exact numbers.

use super::Dyadic;
use super::map::{Matrix, zero};
use rayweave_math::Vec3;
use rayweave_shape::Ray;

/// The surface `[p 1] Q [p 1]^T = 0`, with the inside where it is negative.
#[derive(Clone, Debug)]
pub struct Surface {
    matrix: Matrix,
    rounded: [[f64; 4]; 4],
    /// Its size and distance from the origin plus the lengths of all translations in its map, to which the
    /// tolerance is proportional.
    pub magnitude: f64,
}

/// A ray, taken as exactly the numbers that it consists of.
#[derive(Clone, Debug)]
pub struct Line {
    /// The ray.
    pub ray: Ray,
    origin: [Dyadic; 4],
    direction: [Dyadic; 4],
}

impl Line {
    /// The exact form of a ray.
    pub fn new(ray: Ray) -> Line {
        let exact = |v: Vec3, last: Dyadic| {
            let [x, y, z] = v.to_array().map(Dyadic::from);
            [x, y, z, last]
        };
        Line { ray, origin: exact(ray.origin, Dyadic::ONE), direction: exact(ray.direction, Dyadic::ZERO) }
    }

    /// The point at a time, in homogeneous coordinates.
    pub fn at(&self, t: &Dyadic) -> [Dyadic; 4] {
        std::array::from_fn(|k| &self.origin[k] + &(t * &self.direction[k]))
    }
}

impl Surface {
    /// A surface from the matrix of its equation.
    pub fn new(matrix: Matrix, magnitude: f64) -> Surface {
        let rounded = std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j].to_f64()));
        Surface { matrix, rounded, magnitude }
    }

    /// True if both are the same surface, regardless of which side is inside.
    pub fn is_same(&self, other: &Surface) -> bool {
        let (a, b) = (self.entries(), other.entries());
        let Some(k) = a.iter().position(|x| !x.is_zero()) else { return false };
        // proportional: a_i b_k = a_k b_i
        !b[k].is_zero() && (0..a.len()).all(|i| a[i] * b[k] == a[k] * b[i])
    }

    /// True if both have the same matrix.
    pub fn is_equal(&self, other: &Surface) -> bool {
        self.entries().into_iter().zip(other.entries()).all(|(a, b)| a == b)
    }

    fn entries(&self) -> Vec<&Dyadic> {
        self.matrix.iter().flatten().collect()
    }

    /// The distance of a plane from the origin; `None` for other surfaces.
    pub fn distance(&self) -> Option<f64> {
        let q = &self.rounded;
        let normal = 2.0 * Vec3::new(q[0][3], q[1][3], q[2][3]);
        let plane = q[..3].iter().all(|row| row[..3].iter().all(|&entry| entry == 0.0));
        plane.then(|| q[3][3].abs() / normal.length())
    }

    /// True for circular cylinders: the quadratic part A is a multiple of the projection across the axis, so that
    /// `2 A^2 = trace(A) A`.
    pub fn is_circular_cylinder(&self) -> bool {
        let a = |i: usize, j: usize| &self.matrix[i][j];
        let trace = &(a(0, 0) + a(1, 1)) + a(2, 2);
        let square = |i: usize, j: usize| (0..3).fold(Dyadic::ZERO, |sum, k| &sum + &(a(i, k) * a(k, j)));
        !trace.is_zero() && (0..9).all(|k| square(k / 3, k % 3).scaled(1) == &trace * a(k / 3, k % 3))
    }

    /// True if the engine's unit normal or principal axes are rounded: for planes not perpendicular to a
    /// coordinate axis, and for quadrics whose axes are not the coordinate axes.
    pub fn is_rounded(&self) -> bool {
        let oblique = (0..3).filter(|&k| self.rounded[k][3] != 0.0).count() > 1;
        let turned = [(0, 1), (0, 2), (1, 2)].iter().any(|&(i, j)| self.rounded[i][j] != 0.0);
        turned || (self.distance().is_some() && oblique)
    }

    /// The product of the matrix and a vector.
    fn applied(&self, v: &[Dyadic; 4]) -> [Dyadic; 4] {
        std::array::from_fn(|i| dot(&self.matrix[i], v))
    }

    /// The coefficients `[a, b, c]` of `f(r(t)) = a t^2 + b t + c`.
    pub fn along(&self, line: &Line) -> [Dyadic; 3] {
        let by_direction = self.applied(&line.direction);
        let by_origin = self.applied(&line.origin);
        [
            dot(&by_direction, &line.direction),
            dot(&by_direction, &line.origin).scaled(1),
            dot(&by_origin, &line.origin),
        ]
    }

    /// The value at a point.
    pub fn value(&self, point: &[Dyadic; 4]) -> Dyadic {
        dot(&self.applied(point), point)
    }

    /// The gradient at a point.
    pub fn gradient(&self, point: &[Dyadic; 4]) -> [Dyadic; 3] {
        let [x, y, z, _] = self.applied(point);
        [x, y, z].map(|g| g.scaled(1))
    }

    /// The length of the gradient at a point.
    pub fn slope(&self, point: &[Dyadic; 4]) -> f64 {
        Vec3::from_array(self.gradient(point).map(|g| g.to_f64())).length()
    }

    /// Upper bound of the change of the gradient along w per unit of length: |w| < 2 times that of the
    /// gradient.
    pub fn bend(&self) -> f64 {
        let squares = self.rounded[..3].iter().flat_map(|row| &row[..3]).map(|entry| entry * entry);
        4.0 * squares.sum::<f64>().sqrt()
    }

    /// True if an arbitrarily small change of some ray adds a crossing far out, so that rounding decides: all
    /// surfaces but planes, ellipsoids and cylinders over ellipses.
    pub fn is_open(&self) -> bool {
        let q = &self.rounded;
        let bowl = |k: usize| q[k][k] > 0.0 || (q[k][k] == 0.0 && q[k][3] == 0.0);
        !(self.distance().is_some() || (0..3).all(bowl))
    }
}

fn dot(a: &[Dyadic; 4], b: &[Dyadic; 4]) -> Dyadic {
    (0..4).fold(zero(), |sum, k| &sum + &(&a[k] * &b[k]))
}
