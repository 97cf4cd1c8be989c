//! Sample points of a pupil, in units of its semi-diameter.

use nalgebra::{DMatrix, DVector};

/// The centre and rings of 6, 12, 18, ... points, the first of each on the x axis, the last ring on the rim.
pub fn hexapolar(rings: usize) -> Vec<[f64; 2]> {
    let ring = |k: usize| {
        (0..6 * k).map(move |i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * i as f64 / (6 * k) as f64);
            let r = k as f64 / rings as f64;
            [r * cos, r * sin]
        })
    };
    [[0.0; 2]].into_iter().chain((1..=rings).flat_map(ring)).collect()
}

/// The points inside the pupil of a square grid with `across` points along the diameter from rim to rim.
pub fn square(across: usize) -> Vec<[f64; 2]> {
    let at = |i: usize| if across < 2 { 0.0 } else { 2.0 * i as f64 / (across - 1) as f64 - 1.0 };
    let all = (0..across).flat_map(|i| (0..across).map(move |k| [at(k), at(i)]));
    all.filter(|[x, y]| x * x + y * y <= 1.0 + 1e-12).collect()
}

/// Points along x, from -1 to 1.
pub fn fan_x(count: usize) -> Vec<[f64; 2]> {
    fan_y(count).into_iter().map(|[x, y]| [y, x]).collect()
}

/// Points along y, from -1 to 1.
pub fn fan_y(count: usize) -> Vec<[f64; 2]> {
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count).map(|i| [0.0, 2.0 * i as f64 / last - 1.0]).collect()
}

/// Points of a pupil with weights: sums over them are means over the area of the pupil.
///
/// Hexapolar points that count equally are no such rule: the outermost ring lies on the rim and stands for an
/// annulus of half the width of the others, so that the rim counts about twice. RMS radii then converge as
/// slowly as 1 / rings.
#[derive(Clone, Debug, PartialEq)]
pub struct PupilQuadrature {
    /// The points, in units of the semi-diameter of the pupil.
    pub points: Vec<[f64; 2]>,
    /// The weight of each point; their sum is 1.
    pub weights: Vec<f64>,
}

impl PupilQuadrature {
    /// Rings of `2 * (rings + 2)` points, whose radii and weights are those of Gaussian quadrature in the square of
    /// the radius (G. W. Forbes, *Optical system assessment for design: numerical ray tracing in the Gaussian
    /// pupil*, J. Opt. Soc. Am. A 5, 1943, 1988): exact for polynomials in the coordinates up to the degree
    /// `2 * rings + 3`, and for those that do not depend on the azimuth up to `4 * rings - 2`. No point lies on
    /// the rim. Without rings, the centre only.
    ///
    /// The pupil has to be clear: behind an obstruction or a vignetting edge the rule converges as slowly as
    /// any other.
    pub fn gaussian(rings: usize) -> PupilQuadrature {
        if rings == 0 {
            return PupilQuadrature::equal(&[[0.0; 2]]);
        }
        let arms = 2 * (rings + 2);
        let (mut points, mut weights) = (Vec::with_capacity(rings * arms), Vec::with_capacity(rings * arms));
        for (square, weight) in gauss_legendre(rings) {
            let r = square.sqrt();
            for arm in 0..arms {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * arm as f64 / arms as f64);
                points.push([r * cos, r * sin]);
                weights.push(weight / arms as f64);
            }
        }
        PupilQuadrature { points, weights }
    }

    /// The points of [`hexapolar`] for drawings, each ring with a weight near the area of its annulus that makes sums
    /// exact for r^0, r^2, ... up to the power `2 * (rings / 2)`, at most 8: of all such weights those with the least
    /// square of the relative difference from the areas, weighted by area. They are positive.
    ///
    /// Radii of spots have a relative error of about 1e-4 with 10 rings; [`PupilQuadrature::gaussian`] is more accurate with
    /// fewer rays.
    pub fn hexapolar(rings: usize) -> PupilQuadrature {
        let points = hexapolar(rings);
        if rings == 0 {
            return PupilQuadrature::equal(&points);
        }
        let square = |k: usize| (k as f64 / rings as f64) * (k as f64 / rings as f64);
        // annuli half a step around each ring, with the square of the pupil's radius as 1
        let edge = |k: usize| ((k as f64 + 0.5) / rings as f64).min(1.0);
        let areas: Vec<f64> = (0..=rings)
            .map(|k| edge(k) * edge(k) - if k == 0 { 0.0 } else { edge(k - 1) * edge(k - 1) })
            .collect();
        let degree = (rings / 2).min(4);
        // in Legendre polynomials of 2 r^2 - 1, whose means are 0 except that of degree 0
        let terms = |k: usize| {
            let x = 2.0 * square(k) - 1.0;
            let mut all = vec![1.0, x];
            for n in 1..degree {
                let m = n as f64;
                all.push(((2.0 * m + 1.0) * x * all[n] - m * all[n - 1]) / (m + 1.0));
            }
            all.truncate(degree + 1);
            all
        };
        let table = DMatrix::from_fn(rings + 1, degree + 1, |k, n| terms(k)[n]);
        let scaled = DMatrix::from_fn(rings + 1, degree + 1, |k, n| areas[k] * table[(k, n)]);
        let wanted = DVector::from_fn(degree + 1, |n, _| if n == 0 { 1.0 } else { 0.0 });
        let missing = wanted - table.tr_mul(&DVector::from_column_slice(&areas));
        // the moments of positive areas at more points than terms are regular
        let change = table.tr_mul(&scaled).lu().solve(&missing).map(|factors| &scaled * factors);
        let ring = |k: usize| areas[k] + change.as_ref().map_or(0.0, |change| change[k]);
        let each = |k: usize| std::iter::repeat_n(ring(k) / (6 * k).max(1) as f64, (6 * k).max(1));
        PupilQuadrature { points, weights: (0..=rings).flat_map(each).collect() }
    }

    /// Points that count equally.
    pub fn equal(points: &[[f64; 2]]) -> PupilQuadrature {
        let weights = vec![1.0 / points.len() as f64; points.len()];
        PupilQuadrature { points: points.to_vec(), weights }
    }
}

/// Nodes and weights of Gauss-Legendre quadrature on the interval from 0 to 1, from the lowest node: the roots of
/// the Legendre polynomial by Newton's method, from their asymptotic positions (NIST *Digital Library of
/// Mathematical Functions*, 3.5.20 and 18.16.12).
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let node = |k: usize| {
        let mut x = -libm::cos(std::f64::consts::PI * (k as f64 + 0.75) / (count as f64 + 0.5));
        // the start is good to about 1 / count^3, and the error is squared in each step
        for _ in 0..6 {
            let (value, slope) = legendre(count, x);
            x -= value / slope;
        }
        let (_, slope) = legendre(count, x);
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}

/// The Legendre polynomial of a degree from 1 and its derivative, inside -1 to 1 (DLMF 18.9.1, 18.9.17).
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for n in 1..degree {
        let n = n as f64;
        (before, value) = (value, ((2.0 * n + 1.0) * x * value - n * before) / (n + 1.0));
    }
    (value, degree as f64 * (before - x * value) / (1.0 - x * x))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of x^a y^b over the unit disk: 0 for odd powers, otherwise
    /// (a - 1)!! (b - 1)!! / ((a + b)!! (a + b + 2) / 2), by integration in polar coordinates.
    fn mean(a: u32, b: u32) -> f64 {
        let odd = |n: u32| (1..n).step_by(2).map(f64::from).product::<f64>();
        let even = |n: u32| (2..=n).step_by(2).map(f64::from).product::<f64>();
        if a % 2 + b % 2 > 0 { 0.0 } else { odd(a) * odd(b) / even(a + b) * 2.0 / f64::from(a + b + 2) }
    }

    #[test]
    fn gaussian_rings_are_exact_for_polynomials() {
        for rings in 1..=12 {
            let PupilQuadrature { points, weights } = PupilQuadrature::gaussian(rings);
            assert_eq!(points.len(), 2 * rings * (rings + 2));
            let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
                points.iter().zip(&weights).map(|([x, y], weight)| weight * f(*x, *y)).sum()
            };
            // sums of some hundred terms of at most 1: 1e-14 is their rounding
            let degree = (2 * rings + 3).min(4 * rings - 2) as i32;
            for (a, b) in (0..=degree).flat_map(|a| (0..=degree - a).map(move |b| (a, b))) {
                let found = sum(&|x, y| x.powi(a) * y.powi(b));
                assert!((found - mean(a as u32, b as u32)).abs() < 1e-14, "{rings} rings, x^{a} y^{b}");
            }
            // the mean of r^(2 k) is 1 / (k + 1)
            for k in 0..2 * rings as i32 {
                let found = sum(&|x, y| (x * x + y * y).powi(k));
                assert!((found - 1.0 / f64::from(k + 1)).abs() < 1e-14, "{rings} rings, r^{}", 2 * k);
            }
        }
        assert_eq!(PupilQuadrature::gaussian(0), PupilQuadrature::equal(&[[0.0; 2]]));
    }

    #[test]
    fn hexapolar_rings_have_positive_weights_and_exact_moments() {
        for rings in 1..=20 {
            let PupilQuadrature { points, weights } = PupilQuadrature::hexapolar(rings);
            assert_eq!((points.len(), weights.len()), (1 + 3 * rings * (rings + 1), points.len()));
            assert!(weights.iter().all(|&weight| weight > 0.0), "{rings} rings");
            for k in 0..=(rings / 2).min(4) as i32 {
                let sum: f64 = points
                    .iter()
                    .zip(&weights)
                    .map(|([x, y], weight)| weight * (x * x + y * y).powi(k))
                    .sum();
                assert!((sum - 1.0 / f64::from(k + 1)).abs() < 1e-13, "{rings} rings, r^{}: {sum}", 2 * k);
            }
        }
        assert_eq!(PupilQuadrature::hexapolar(0), PupilQuadrature::equal(&[[0.0; 2]]));
    }

    #[test]
    fn many_rings_keep_their_weights() {
        let PupilQuadrature { points, weights } = PupilQuadrature::gaussian(256);
        assert!(points.iter().all(|[x, y]| libm::hypot(*x, *y) < 1.0));
        assert!(weights.iter().all(|&weight| weight > 0.0));
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
