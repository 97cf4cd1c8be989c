//! Eigenvalues and eigenvectors (principal axes) of a symmetric 3 x 3 matrix.

use crate::{Mat3, UNIT_ROUNDOFF, Vec3, unit};

/// Eigenvalues with their orthonormal eigenvectors, in no particular order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen {
    /// The eigenvalues.
    pub values: Vec3,
    /// The unit eigenvector of each eigenvalue.
    pub vectors: [Vec3; 3],
    /// True if the matrix was diagonal: the eigenvalues are then its diagonal and the eigenvectors the coordinate axes, exactly.
    /// Otherwise each eigenvalue has an error of a few unit roundoffs times the largest one.
    pub exact: bool,
}

/// Eigenvalues and eigenvectors by cyclic Jacobi rotations (G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed., 8.5).
///
/// Uses the symmetric part of the matrix. Entries must be finite.
pub fn symmetric_eigen(matrix: &Mat3) -> Eigen {
    let mut a = (*matrix + matrix.transpose()) * 0.5;
    let mut vectors = Mat3::IDENTITY;
    let exact = is_diagonal(&a);
    // quadratic convergence: five sweeps suffice, more are a safety margin
    for _ in 0..16 {
        if is_diagonal(&a) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut vectors, p, q);
        }
    }
    Eigen {
        values: Vec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z),
        vectors: [vectors.x_axis, vectors.y_axis, vectors.z_axis].map(unit),
        exact,
    }
}

fn is_diagonal(a: &Mat3) -> bool {
    a.x_axis.y == 0.0 && a.x_axis.z == 0.0 && a.y_axis.z == 0.0
}

/// Rotates columns and rows p and q so that the entry (p, q) becomes 0.
fn rotate(a: &mut Mat3, vectors: &mut Mat3, p: usize, q: usize) {
    let (app, aqq, apq) = (a.col(p)[p], a.col(q)[q], a.col(p)[q]);
    if apq.abs() <= 0.125 * UNIT_ROUNDOFF * app.abs().min(aqq.abs()) {
        a.col_mut(p)[q] = 0.0;
        a.col_mut(q)[p] = 0.0;
        return;
    }
    let (c, s) = jacobi_angle(app, aqq, apq);
    let mut turn = Mat3::IDENTITY;
    turn.col_mut(p)[p] = c;
    turn.col_mut(q)[q] = c;
    turn.col_mut(q)[p] = s;
    turn.col_mut(p)[q] = -s;
    *a = turn.transpose() * *a * turn;
    a.col_mut(p)[q] = 0.0;
    a.col_mut(q)[p] = 0.0;
    *vectors *= turn;
}

/// The cosine and sine of the smaller rotation that makes the matrix (app, apq; apq, aqq) diagonal.
fn jacobi_angle(app: f64, aqq: f64, apq: f64) -> (f64, f64) {
    let cot = (aqq - app) / (2.0 * apq);
    let tan = if cot.is_finite() { 1f64.copysign(cot) / (cot.abs() + (1.0 + cot * cot).sqrt()) } else { 0.0 };
    let c = 1.0 / (1.0 + tan * tan).sqrt();
    (c, tan * c)
}

/// A unit vector perpendicular to a unit vector; a coordinate axis if the argument is one.
pub fn any_perpendicular(axis: Vec3) -> Vec3 {
    let size = axis.abs();
    let least = if size.x <= size.y && size.x <= size.z {
        Vec3::X
    } else if size.y <= size.z {
        Vec3::Y
    } else {
        Vec3::Z
    };
    unit(least - axis.dot(least) * axis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Affine;

    #[test]
    fn diagonal_matrices_are_exact() {
        let diagonal = Vec3::new(3.0, -1e-20, 7.0);
        let eigen = symmetric_eigen(&Mat3::from_diagonal(diagonal));
        assert!(eigen.exact);
        assert_eq!(eigen.values, diagonal);
        assert_eq!(eigen.vectors, Vec3::AXES);
    }

    #[test]
    fn rotated_matrices_have_the_same_eigenvalues_and_rotated_axes() {
        let turn = Affine::rotation(Vec3::new(1.0, -2.0, 0.3), 50.0).linear;
        for values in [Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(1e-9, 1.0, 0.0)] {
            let matrix = turn * Mat3::from_diagonal(values) * turn.transpose();
            let eigen = symmetric_eigen(&matrix);
            for (k, e) in eigen.vectors.into_iter().enumerate() {
                assert!((matrix * e - eigen.values[k] * e).length() < 2e-15 * values.length());
                assert!((e.length() - 1.0).abs() < 1e-15);
                assert!(e.dot(eigen.vectors[(k + 1) % 3]).abs() < 1e-15);
            }
            let (mut got, mut want) = (eigen.values.to_array(), values.to_array());
            got.sort_by(f64::total_cmp);
            want.sort_by(f64::total_cmp);
            assert!((0..3).all(|k| (got[k] - want[k]).abs() < 4e-15));
        }
    }

    #[test]
    fn perpendiculars_are_perpendicular() {
        for axis in [Vec3::X, -Vec3::Z, unit(Vec3::new(1.0, 2.0, -3.0))] {
            let side = any_perpendicular(axis);
            assert!(side.dot(axis).abs() < 1e-16 && (side.length() - 1.0).abs() < 3e-16);
        }
        assert_eq!(any_perpendicular(Vec3::Z), Vec3::X);
    }
}
