//! Gradient index from values on a grid, interpolated by a cubic spline.

use super::check::bad;
use crate::error::OpticsError;
use rayweave_math::Vec3;

/// The greatest number of values; more are an error of the input.
const MAX_VALUES: usize = 1 << 28;

/// Values on a rectangular grid with tricubic spline interpolation: twice continuously
/// differentiable, with zero second derivative at the outermost values (natural spline; C. de Boor,
/// *A Practical Guide to Splines*, 1978, chapters IV and XVII).
///
/// Beyond the grid the spline continues as the polynomial of its last cell.
#[derive(Clone, Debug, PartialEq)]
pub struct IndexGrid {
    count: [usize; 3],
    origin: Vec3,
    spacing: Vec3,
    /// Coefficients of B-splines, with one more at each end of each direction; x varies fastest.
    coefficients: Vec<f64>,
}

impl IndexGrid {
    /// A grid of `count[0] * count[1] * count[2]` values, with x varying fastest and the first
    /// value at `origin`.
    ///
    /// # Errors
    /// [`OpticsError::BadGradient`] for fewer than two values in a direction, a wrong number of
    /// values, values that are not positive and finite, and a spacing that is not positive.
    pub fn new(
        count: [usize; 3],
        origin: Vec3,
        spacing: Vec3,
        values: &[f64],
    ) -> Result<IndexGrid, OpticsError> {
        check(count, origin, spacing, values)?;
        let mut wide = values.to_vec();
        let mut size = count;
        for axis in 0..3 {
            wide = filtered(&wide, size, axis);
            size[axis] += 2;
        }
        Ok(IndexGrid { count, origin, spacing, coefficients: wide })
    }

    /// The value and its gradient.
    pub(super) fn at(&self, point: Vec3) -> (f64, Vec3) {
        let local = (point - self.origin) / self.spacing;
        let cell: [(usize, [f64; 4], [f64; 4]); 3] = std::array::from_fn(|k| {
            let last = self.count[k] as f64 - 2.0;
            // the cell of a NaN is 0, and the NaN propagates through the weights
            let first = local[k].floor().clamp(0.0, last) as usize;
            let (weights, slopes) = basis(local[k] - first as f64);
            (first, weights, slopes)
        });
        let [x, y, z] = &cell;
        let (mut value, mut gradient) = (0.0, Vec3::ZERO);
        for (c, (wz, sz)) in z.1.iter().zip(&z.2).enumerate() {
            for (b, (wy, sy)) in y.1.iter().zip(&y.2).enumerate() {
                let row = self.row(x.0, y.0 + b, z.0 + c);
                let dot = |w: &[f64; 4]| (0..4).map(|a| w[a] * row[a]).sum::<f64>();
                let (here, along) = (dot(&x.1), dot(&x.2));
                value += wz * wy * here;
                gradient += Vec3::new(wz * wy * along, wz * sy * here, sz * wy * here);
            }
        }
        (value, gradient / self.spacing)
    }

    /// Four coefficients along x.
    fn row(&self, x: usize, y: usize, z: usize) -> &[f64] {
        let [nx, ny, _] = self.count.map(|count| count + 2);
        let first = (z * ny + y) * nx + x;
        &self.coefficients[first..first + 4]
    }
}

fn check(count: [usize; 3], origin: Vec3, spacing: Vec3, values: &[f64]) -> Result<(), OpticsError> {
    if let Some(few) = count.iter().find(|count| **count < 2) {
        return Err(bad(format!("gradient grid has {few} values in one direction"), "it needs at least two"));
    }
    let wanted = count.iter().try_fold(1usize, |product, count| product.checked_mul(*count));
    let wanted = wanted.filter(|wanted| *wanted <= MAX_VALUES);
    if wanted != Some(values.len()) {
        let [x, y, z] = count;
        let problem = format!("gradient grid has {} values", values.len());
        return Err(bad(problem, format!("its size is {x} x {y} x {z}")));
    }
    let is_good = spacing.cmpgt(Vec3::ZERO).all() && spacing.is_finite() && origin.is_finite();
    if !is_good {
        let problem = format!("gradient grid has the spacing {spacing} and the origin {origin}");
        return Err(bad(problem, "the spacing must be greater than 0, and both finite"));
    }
    match values.iter().position(|value| !(*value > 0.0 && value.is_finite())) {
        Some(k) => {
            let problem = format!("value {k} of the gradient grid is {}", values[k]);
            Err(bad(problem, "it must be finite and greater than 0"))
        }
        None => Ok(()),
    }
}

/// The four non-zero cubic B-splines at x in [0, 1] of a cell, and their derivatives.
fn basis(x: f64) -> ([f64; 4], [f64; 4]) {
    let y = 1.0 - x;
    let weights = [
        y * y * y / 6.0,
        (4.0 - 6.0 * x * x + 3.0 * x * x * x) / 6.0,
        (4.0 - 6.0 * y * y + 3.0 * y * y * y) / 6.0,
        x * x * x / 6.0,
    ];
    let slopes = [-0.5 * y * y, 1.5 * x * x - 2.0 * x, 2.0 * y - 1.5 * y * y, 0.5 * x * x];
    (weights, slopes)
}

/// The coefficients of the natural spline along one direction: two more than there are values.
fn filtered(values: &[f64], size: [usize; 3], axis: usize) -> Vec<f64> {
    let count = size[axis];
    let stride: usize = size[..axis].iter().product();
    let blocks = values.len() / (stride * count);
    let mut wide = vec![0.0; blocks * stride * (count + 2)];
    let mut line = vec![0.0; count];
    for block in 0..blocks {
        for lane in 0..stride {
            for k in 0..count {
                line[k] = values[(block * count + k) * stride + lane];
            }
            solve(&mut line);
            let mut put = |k: usize, value: f64| wide[(block * (count + 2) + k) * stride + lane] = value;
            (0..count).for_each(|k| put(k + 1, line[k]));
            // natural ends: c[-1] - 2 c[0] + c[1] = 0
            put(0, 2.0 * line[0] - line[1]);
            put(count + 1, 2.0 * line[count - 1] - line[count - 2]);
        }
    }
    wide
}

/// Solves for the coefficients in place (tridiagonal system):
/// `(c[k-1] + 4 c[k] + c[k+1]) / 6 = v[k]`, and `c = v` at both ends.
fn solve(line: &mut [f64]) {
    let last = line.len() - 1;
    let mut above = vec![0.0; line.len()];
    for k in 1..last {
        let pivot = 4.0 - above[k - 1];
        above[k] = 1.0 / pivot;
        line[k] = (6.0 * line[k] - line[k - 1]) / pivot;
    }
    for k in (1..last).rev() {
        line[k] -= above[k] * line[k + 1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(f: impl Fn(Vec3) -> f64) -> IndexGrid {
        let (origin, spacing) = (Vec3::new(-1.0, 0.0, 2.0), Vec3::new(0.5, 0.25, 1.0));
        let mut values = Vec::new();
        for z in 0..4 {
            for y in 0..6 {
                for x in 0..5 {
                    values.push(f(origin + spacing * Vec3::new(f64::from(x), f64::from(y), f64::from(z))));
                }
            }
        }
        IndexGrid::new([5, 6, 4], origin, spacing, &values).unwrap()
    }

    /// A natural spline reproduces functions that are linear in each direction.
    #[test]
    fn trilinear_functions_are_kept() {
        let f = |p: Vec3| 20.0 + p.x * p.y - 2.0 * p.z + 0.5 * p.x * p.y * p.z;
        let slope = |p: Vec3| Vec3::new(p.y + 0.5 * p.y * p.z, p.x + 0.5 * p.x * p.z, -2.0 + 0.5 * p.x * p.y);
        let grid = grid(f);
        for p in [Vec3::new(-0.9, 0.1, 2.2), Vec3::new(0.3, 1.1, 4.7), Vec3::new(1.2, -0.3, 5.5)] {
            let (value, gradient) = grid.at(p);
            assert!((value - f(p)).abs() < 1e-13, "{p}");
            assert!((gradient - slope(p)).length() < 1e-12, "{p}");
        }
    }

    #[test]
    fn values_are_met_and_slopes_fit() {
        let f = |p: Vec3| 1.5 + 0.1 * (2.0 * p.x).sin() * p.y.cos() + 0.02 * p.z * p.z;
        let grid = grid(f);
        for x in 0..5 {
            let p = Vec3::new(-1.0 + 0.5 * f64::from(x), 0.75, 4.0);
            assert!((grid.at(p).0 - f(p)).abs() < 1e-14);
        }
        let (p, step) = (Vec3::new(0.37, 0.61, 3.3), 1e-5);
        for (k, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            let slope = (grid.at(p + step * axis).0 - grid.at(p - step * axis).0) / (2.0 * step);
            assert!((grid.at(p).1[k] - slope).abs() < 1e-10);
        }
    }

    #[test]
    fn refusals() {
        let make = |count, values: &[f64], spacing| IndexGrid::new(count, Vec3::ZERO, spacing, values);
        let ones = [1.5; 8];
        assert!(make([2, 2, 2], &ones, Vec3::ONE).is_ok());
        assert!(make([2, 2, 2], &ones[..7], Vec3::ONE).is_err());
        assert!(make([1, 2, 4], &ones, Vec3::ONE).is_err());
        assert!(make([2, 2, 2], &ones, Vec3::new(1.0, 0.0, 1.0)).is_err());
        assert!(make([2, 2, 2], &[f64::NAN; 8], Vec3::ONE).is_err());
        assert!(make([usize::MAX, 2, 2], &ones, Vec3::ONE).is_err());
    }
}
