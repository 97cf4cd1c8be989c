//! Zernike polynomials and least-squares fits.

use super::LensAnalysisError;
use nalgebra::{DMatrix, DVector};

/// A Zernike polynomial: radial order n and azimuthal frequency m, negative for sines; n - |m| is even.
///
/// Normalised to a mean square of 1 over the unit disk: sqrt(n + 1) R(r) for m = 0, else sqrt(2 (n + 1)) R(r)
/// cos(m a) or sin(|m| a), with the angle a from x to y. A coefficient of a fit is then its contribution to
/// the RMS (R. J. Noll, J. Opt. Soc. Am. 66, 207, 1976; ANSI Z80.28).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ZernikePolynomial {
    /// The radial order.
    pub n: u32,
    /// The azimuthal frequency.
    pub m: i32,
}

impl ZernikePolynomial {
    /// The polynomial of a Noll index: 1 piston, 2 and 3 tilts along x and y, 4 defocus, 5 and 6 astigmatism,
    /// 7 and 8 coma along y and x, 11 spherical aberration. Even indices are cosines. Index 0 does not exist
    /// and is treated as 1.
    pub fn noll(j: u32) -> ZernikePolynomial {
        let j = j.max(1);
        let mut n = 0;
        // (n + 1) (n + 2) / 2 polynomials have an order of at most n
        while (n + 1) * (n + 2) / 2 < j {
            n += 1;
        }
        let place = j - n * (n + 1) / 2;
        // frequencies come in pairs, except 0
        let m = if n.is_multiple_of(2) { place / 2 * 2 } else { (place - 1) / 2 * 2 + 1 } as i32;
        ZernikePolynomial { n, m: if j.is_multiple_of(2) { m } else { -m } }
    }

    /// The polynomial of an OSA/ANSI index (n (n + 2) + m) / 2: 0 piston, 1 and 2 tilts along y and x, 4
    /// defocus, 12 spherical aberration.
    pub fn osa(j: u32) -> ZernikePolynomial {
        let mut n = 0;
        while (n + 1) * (n + 2) / 2 <= j {
            n += 1;
        }
        ZernikePolynomial { n, m: (2 * j) as i32 - (n * (n + 2)) as i32 }
    }

    /// The value at a point of the unit disk.
    pub fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let (r, angle) = (libm::hypot(x, y), libm::atan2(y, x));
        let order = f64::from(self.n + 1);
        let (sin, cos) = libm::sincos(f64::from(self.m.unsigned_abs()) * angle);
        let radial = radial(self.n as usize, self.m.unsigned_abs() as usize, r);
        match self.m {
            0 => order.sqrt() * radial,
            m if m > 0 => (2.0 * order).sqrt() * radial * cos,
            _ => (2.0 * order).sqrt() * radial * sin,
        }
    }
}

/// The radial polynomial, by the recurrence R(n, m) = r (R(n-1, |m-1|) + R(n-1, m+1)) - R(n-2, m), which is
/// stable at high orders (B. Honarvar Shakibaei and R. Paramesran, Opt. Lett. 38, 2487, 2013).
fn radial(n: usize, m: usize, r: f64) -> f64 {
    let mut rows = [vec![0.0; n + 2], vec![0.0; n + 2], vec![0.0; n + 2]];
    // rows of orders n - 2, n - 1 and n
    rows[1][0] = 1.0;
    for order in 1..=n {
        let [before, last, next] = &mut rows;
        for frequency in 0..=n {
            let has_term = frequency <= order && (order - frequency).is_multiple_of(2);
            let lower = last[frequency.abs_diff(1)] + last[frequency + 1];
            next[frequency] = if has_term { r * lower - before[frequency] } else { 0.0 };
        }
        rows.rotate_left(1);
    }
    rows[1][m]
}

/// A least-squares fit: a sum of Zernike polynomials.
#[derive(Clone, Debug, PartialEq)]
pub struct ZernikeFit {
    /// The polynomials with their coefficients, in the unit of the values.
    pub terms: Vec<(ZernikePolynomial, f64)>,
    /// The root mean square of the residuals.
    pub residual_rms: f64,
}

impl ZernikeFit {
    /// The coefficient of a polynomial; 0 if it is not among the terms.
    pub fn coefficient(&self, of: ZernikePolynomial) -> f64 {
        self.terms.iter().find(|(zernike, _)| *zernike == of).map_or(0.0, |term| term.1)
    }

    /// The value of the sum at a point of the unit disk.
    pub fn at(&self, point: [f64; 2]) -> f64 {
        self.terms.iter().map(|(zernike, coefficient)| coefficient * zernike.at(point)).sum()
    }
}

/// Fits Zernike polynomials to values at points of the unit disk by least squares. The singular value
/// decomposition gives the solution of least norm where the points do not determine all terms.
///
/// # Errors
/// [`LensAnalysisError::TooFew`] if there are fewer points than terms.
pub fn fit_zernike(
    points: &[[f64; 2]],
    values: &[f64],
    terms: &[ZernikePolynomial],
) -> Result<ZernikeFit, LensAnalysisError> {
    let count = points.len().min(values.len());
    let too_few = || LensAnalysisError::TooFew { points: count, terms: terms.len() };
    if count < terms.len() || terms.is_empty() {
        return Err(too_few());
    }
    let matrix = DMatrix::from_fn(count, terms.len(), |row, column| terms[column].at(points[row]));
    let wanted = DVector::from_column_slice(&values[..count]);
    let singular = matrix.clone().svd(true, true);
    let least = 1e-12 * singular.singular_values.max();
    let solve = |right: &DVector<f64>| singular.solve(right, least).map_err(|_| too_few());
    let first = solve(&wanted)?;
    // the singular value iteration stops early for nearly equal values: one step of iterative refinement
    let solution = &first + solve(&(&wanted - &matrix * &first))?;
    let left = wanted - matrix * &solution;
    Ok(ZernikeFit {
        terms: terms.iter().copied().zip(solution.iter().copied()).collect(),
        residual_rms: left.norm() / (count as f64).sqrt(),
    })
}
