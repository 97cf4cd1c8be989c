//! Affine maps that are exact in `f64`: dyadic shifts, scales by powers of two, quarter turns, mirrors.

use super::Dyadic;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;

/// A 4 x 4 matrix of exact numbers.
pub type Matrix = [[Dyadic; 4]; 4];

/// An elementary map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Map {
    /// A shift.
    Move([f64; 3]),
    /// One factor for each axis, powers of two of either sign.
    Scale([f64; 3]),
    /// Quarter turns about an axis, 0 to 2, right-handed.
    Turn(usize, u8),
    /// A mirror across an axis, 0 to 2.
    Mirror(usize),
}

/// Zero, for folds.
pub fn zero() -> Dyadic {
    Dyadic::ZERO
}

fn diagonal(entries: [f64; 4]) -> Matrix {
    let entry = |i: usize, j: usize| if i == j { Dyadic::from(entries[i]) } else { zero() };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// The identity matrix.
pub fn identity() -> Matrix {
    diagonal([1.0; 4])
}

/// The product of two matrices.
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| (0..4).fold(zero(), |sum, k| &sum + &(&a[i][k] * &b[k][j]));
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// `L^T Q L`: transforms the matrix of a quadric from its own frame to the world, L being `local_from_world`.
pub fn carried(quadric: &Matrix, local_from_world: &Matrix) -> Matrix {
    let transposed: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| local_from_world[j][i].clone()));
    product(&product(&transposed, quadric), local_from_world)
}

impl Map {
    /// The inverse as a matrix: `inner_from_outer`.
    pub fn inverse(&self) -> Matrix {
        match *self {
            Map::Move(v) => {
                let mut matrix = identity();
                (0..3).for_each(|k| matrix[k][3] = Dyadic::from(-v[k]));
                matrix
            }
            Map::Scale(s) => {
                for factor in s {
                    assert_eq!(libm::frexp(factor.abs()).0, 0.5, "{factor} is not a power of two");
                }
                diagonal([1.0 / s[0], 1.0 / s[1], 1.0 / s[2], 1.0])
            }
            Map::Turn(axis, quarters) => {
                (0..quarters % 4).fold(identity(), |all, _| product(&quarter_back(axis), &all))
            }
            Map::Mirror(axis) => {
                let mut factors = [1.0; 4];
                factors[axis] = -1.0;
                diagonal(factors)
            }
        }
    }

    /// The map as the engine's `Affine`.
    pub fn affine(&self) -> Affine {
        let axis = |k: usize| Vec3::AXES[k];
        match *self {
            Map::Move(v) => Affine::translate(v.into()),
            Map::Scale(s) => Affine::scale(s.into()),
            Map::Turn(k, quarters) => Affine::rotation(axis(k), 90.0 * f64::from(quarters)),
            Map::Mirror(k) => Affine::mirror(axis(k)),
        }
    }

    /// The solid under the map, by the methods of `Solid`.
    pub fn applied(&self, solid: &Solid) -> Solid {
        match *self {
            Map::Move(v) => solid.translate(v),
            Map::Scale(s) => solid.scale(s),
            Map::Turn(0, quarters) => solid.rotate_x(90.0 * f64::from(quarters)),
            Map::Turn(1, quarters) => solid.rotate_y(90.0 * f64::from(quarters)),
            Map::Turn(_, quarters) => solid.rotate_z(90.0 * f64::from(quarters)),
            Map::Mirror(k) => solid.mirror(Vec3::AXES[k]),
        }
    }
}

/// The inverse of a right-handed quarter turn: for (i, j, k) cyclic from axis i, it maps j to -k and k to j.
fn quarter_back(axis: usize) -> Matrix {
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut matrix = diagonal([0.0, 0.0, 0.0, 1.0]);
    matrix[axis][axis] = Dyadic::ONE;
    matrix[j][k] = Dyadic::ONE;
    matrix[k][j] = -&Dyadic::ONE;
    matrix
}
