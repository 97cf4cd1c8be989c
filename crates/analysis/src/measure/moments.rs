//! Moments: the contribution of a chord to the integrals over a region.

use rayweave_math::{Mat3, Vec3};

/// The number of integrals: of 1, x, y, z, xx, yy, zz, yz, zx, xy.
pub(super) const MOMENTS: usize = 10;

/// The integrals of 1, of the coordinates and of their products.
pub(super) type Moments = [f64; MOMENTS];

/// The integrals along a segment parallel to an axis, from one coordinate to another; `at` has the other two
/// coordinates.
pub(super) fn along(axis: usize, at: Vec3, from: f64, to: f64) -> Moments {
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    let (u, v) = (at[next], at[last]);
    let length = to - from;
    let first = 0.5 * (to + from) * length;
    let second = (to * to + to * from + from * from) * length / 3.0;
    let mut moments = [0.0; MOMENTS];
    moments[0] = length;
    (moments[1 + axis], moments[1 + next], moments[1 + last]) = (first, u * length, v * length);
    (moments[4 + axis], moments[4 + next], moments[4 + last]) = (second, u * u * length, v * v * length);
    // the product without a coordinate is stored at the index of that coordinate
    (moments[7 + axis], moments[7 + next], moments[7 + last]) = (u * v * length, v * first, u * first);
    moments
}

/// Adds a multiple of `moments` to `sum`.
pub(super) fn add(sum: &mut Moments, moments: &Moments, factor: f64) {
    sum.iter_mut().zip(moments).for_each(|(sum, moment)| *sum += factor * moment);
}

/// The weights of the integrals that give the entry (i, j) of the inertia tensor about a point, for density
/// 1: the integral of |p - c|^2 delta_ij - (p_i - c_i)(p_j - c_j).
pub(super) fn inertia_weights(i: usize, j: usize, c: Vec3) -> Moments {
    let mut weights = [0.0; MOMENTS];
    if i != j {
        weights[7 + (3 - i - j)] = -1.0;
        weights[1 + i] += c[j];
        weights[1 + j] += c[i];
        weights[0] = -c[i] * c[j];
        return weights;
    }
    for k in (0..3).filter(|&k| k != i) {
        weights[4 + k] = 1.0;
        weights[1 + k] = -2.0 * c[k];
        weights[0] += c[k] * c[k];
    }
    weights
}

/// The inertia tensor about a point, for density 1.
pub(super) fn inertia(moments: &Moments, c: Vec3) -> Mat3 {
    let entry = |i: usize, j: usize| dot(&inertia_weights(i, j, c), moments);
    let column = |j: usize| Vec3::new(entry(0, j), entry(1, j), entry(2, j));
    Mat3::from_cols(column(0), column(1), column(2))
}

/// The weights of the integrals that give, to first order, the error of a coordinate of the centre times the
/// volume.
pub(super) fn centre_weights(k: usize, centre: Vec3) -> Moments {
    let mut weights = [0.0; MOMENTS];
    (weights[1 + k], weights[0]) = (1.0, -centre[k]);
    weights
}

pub(super) fn dot(weights: &Moments, moments: &Moments) -> f64 {
    weights.iter().zip(moments).map(|(w, m)| w * m).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The box [0,1] x [0,2] x [0,3] as 50 x 50 lines along each axis: integrals over a box are products of
    /// those over its edges.
    #[test]
    fn a_box_of_lines() {
        let size = Vec3::new(1.0, 2.0, 3.0);
        let exact = {
            let [a, b, c] = size.to_array();
            let volume = a * b * c;
            let middle = [a, b, c].map(|x| volume * x / 2.0);
            let square = [a, b, c].map(|x| volume * x * x / 3.0);
            let product = [b * c, c * a, a * b].map(|xy| volume * xy / 4.0);
            let all = [[volume, 0.0, 0.0], middle, square, product];
            [
                all[0][0], all[1][0], all[1][1], all[1][2], all[2][0], all[2][1], all[2][2], all[3][0],
                all[3][1], all[3][2],
            ]
        };
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut sum = [0.0; MOMENTS];
            let n = 50;
            for i in 0..n * n {
                let mut at = Vec3::ZERO;
                at[next] = size[next] * ((i % n) as f64 + 0.5) / n as f64;
                at[last] = size[last] * ((i / n) as f64 + 0.5) / n as f64;
                let area = size[next] * size[last] / (n * n) as f64;
                add(&mut sum, &along(axis, at, 0.0, size[axis]), area);
            }
            for (k, (found, exact)) in sum.iter().zip(exact).enumerate() {
                // the midpoint rule is exact except for the squares of transverse coordinates, with an error of 1 / (4 n^2)
                assert!((found / exact - 1.0).abs() < 1.1 / (4.0 * 2500.0), "{axis} {k}: {found} {exact}");
            }
            let about = inertia(&sum, size / 2.0);
            let solid = 6.0 * (2.0 * 2.0 + 3.0 * 3.0) / 12.0;
            assert!((about.x_axis.x / solid - 1.0).abs() < 1e-3, "{about}");
            assert!(about.x_axis.y.abs() < 1e-12 * solid && about.z_axis.x.abs() < 1e-12 * solid, "{about}");
        }
    }
}
