//! Zernike polynomials as terms in x and y.
//!
//! `Z(rho, theta) = N R_n^m(rho) cos(m theta)`, or `sin(|m| theta)` for m < 0, with theta counted from +x towards +y and
//! `R_n^m(rho) = sum over k of (-1)^k (n - k)! / (k! ((n + m) / 2 - k)! ((n - m) / 2 - k)!) rho^(n - 2 k)`
//! (M. Born and E. Wolf, *Principles of Optics*, section 9.2.1).

use super::MAX_DEGREE;

/// Numbering (from 1, for `Osa` from 0) and normalisation of Zernike polynomials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zernike {
    /// R. J. Noll, J. Opt. Soc. Am. 66 (1976) 207: numbers from 1, root mean square 1 over the disc.
    Noll,
    /// ANSI Z80.28 and ISO 24157: numbers `(n (n + 2) + m) / 2` from 0, root mean square 1 over the disc.
    Osa,
    /// The University of Arizona's fringe order: numbers `(1 + (n + |m|) / 2)^2 - 2 |m| + (1 - sgn m) / 2` from 1, value 1
    /// at the rim.
    Fringe,
}

impl Zernike {
    /// Radial order n and azimuthal order m of the polynomial at a zero-based index; m < 0 is a sine.
    fn orders(self, place: usize) -> (usize, isize) {
        match self {
            Zernike::Osa => {
                let n = (0..).find(|n| (n + 1) * (n + 2) / 2 > place).unwrap_or(0);
                (n, (2 * place) as isize - (n * (n + 2)) as isize)
            }
            Zernike::Noll => {
                let n = (0..).find(|n| (n + 1) * (n + 2) / 2 > place).unwrap_or(0);
                let within = place - n * (n + 1) / 2;
                let m = n % 2 + 2 * ((within + (n + 1) % 2) / 2);
                // Noll's numbers start at 1: even numbers are cosines
                (n, if place % 2 == 1 { m as isize } else { -(m as isize) })
            }
            Zernike::Fringe => {
                // groups of equal (n + |m|) / 2 = g begin at g^2, with decreasing |m|, cosine first
                let group = (0..).find(|g| (g + 1) * (g + 1) > place).unwrap_or(0);
                let within = place - group * group;
                let m = group - within / 2;
                (2 * group - m, if within.is_multiple_of(2) { m as isize } else { -(m as isize) })
            }
        }
    }

    fn norm(self, n: usize, m: isize) -> f64 {
        match (self, m) {
            (Zernike::Fringe, _) => 1.0,
            (_, 0) => ((n + 1) as f64).sqrt(),
            _ => (2.0 * (n + 1) as f64).sqrt(),
        }
    }
}

/// The terms (i, j, c) of `c x^i y^j` of a sum of Zernike polynomials over a disc of this radius. The coefficients are
/// lengths, in the order of the numbering.
///
/// Coefficients of the powers alternate in sign and grow with n (up to about 9,000 for n = 12), and so do rounding errors.
pub fn zernike_terms(order: Zernike, coefficients: &[f64], radius: f64) -> Vec<(u32, u32, f64)> {
    let mut terms = Vec::new();
    for (place, &c) in coefficients.iter().enumerate().filter(|(_, c)| **c != 0.0) {
        let (n, m) = order.orders(place);
        // beyond the highest degree the values do not matter: the surface is rejected
        if n > MAX_DEGREE {
            terms.push((n as u32, 0, c));
            continue;
        }
        add(&mut terms, (n, m), c * order.norm(n, m), radius);
    }
    terms
}

fn add(terms: &mut Vec<(u32, u32, f64)>, (n, m): (usize, isize), c: f64, radius: f64) {
    let around = m.unsigned_abs();
    for k in 0..=(n - around) / 2 {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let radial = sign * binomial(n - k, k) * binomial(n - 2 * k, (n - around) / 2 - k);
        let power = (n - around) / 2 - k;
        let scale = (0..n - 2 * k).fold(c * radial, |scale, _| scale / radius);
        // (x^2 + y^2)^power times the real or imaginary part of (x + i y)^|m|
        for q in 0..=power {
            for p in (usize::from(m < 0)..=around).step_by(2) {
                let turn = if p / 2 % 2 == 0 { 1.0 } else { -1.0 };
                let factor = turn * binomial(power, q) * binomial(around, p);
                let (i, j) = (2 * (power - q) + around - p, 2 * q + p);
                terms.push((i as u32, j as u32, scale * factor));
            }
        }
    }
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(terms: &[(u32, u32, f64)], x: f64, y: f64) -> f64 {
        terms.iter().map(|&(i, j, c)| c * libm::pow(x, f64::from(i)) * libm::pow(y, f64::from(j))).sum()
    }

    fn one(order: Zernike, number: usize, x: f64, y: f64) -> f64 {
        let mut list = vec![0.0; number];
        list.push(1.0);
        value(&zernike_terms(order, &list, 2.0), 2.0 * x, 2.0 * y)
    }

    /// Noll's table I, the first eleven.
    #[test]
    fn nolls_table() {
        for (x, y) in [(0.3, -0.5), (0.8, 0.1), (-0.2, -0.9)] {
            let r2 = x * x + y * y;
            let table = [
                1.0,
                2.0 * x,
                2.0 * y,
                3f64.sqrt() * (2.0 * r2 - 1.0),
                6f64.sqrt() * 2.0 * x * y,
                6f64.sqrt() * (x * x - y * y),
                8f64.sqrt() * (3.0 * r2 - 2.0) * y,
                8f64.sqrt() * (3.0 * r2 - 2.0) * x,
                8f64.sqrt() * (3.0 * x * x * y - y * y * y),
                8f64.sqrt() * (x * x * x - 3.0 * x * y * y),
                5f64.sqrt() * (6.0 * r2 * r2 - 6.0 * r2 + 1.0),
            ];
            for (place, expected) in table.into_iter().enumerate() {
                let found = one(Zernike::Noll, place, x, y);
                assert!((found - expected).abs() < 1e-14, "Z{}: {found} {expected}", place + 1);
            }
        }
    }

    /// The published fringe set: piston, tilts, focus, astigmatism, coma, spherical, trefoil, ... and the last of 37.
    #[test]
    fn the_fringe_table() {
        let (x, y) = (0.3, -0.5);
        let r2: f64 = x * x + y * y;
        let table = [
            (0, 1.0),
            (1, x),
            (2, y),
            (3, 2.0 * r2 - 1.0),
            (4, x * x - y * y),
            (5, 2.0 * x * y),
            (6, (3.0 * r2 - 2.0) * x),
            (7, (3.0 * r2 - 2.0) * y),
            (8, 6.0 * r2 * r2 - 6.0 * r2 + 1.0),
            (9, x * x * x - 3.0 * x * y * y),
            (10, 3.0 * x * x * y - y * y * y),
            (15, 20.0 * r2 * r2 * r2 - 30.0 * r2 * r2 + 12.0 * r2 - 1.0),
        ];
        for (place, expected) in table {
            let found = one(Zernike::Fringe, place, x, y);
            assert!((found - expected).abs() < 1e-14, "Z{}: {found} {expected}", place + 1);
        }
        assert_eq!(Zernike::Fringe.orders(35), (10, 0));
    }

    /// OSA numbers by definition, in both directions.
    #[test]
    fn osa_numbers() {
        for place in 0..200 {
            let (n, m) = Zernike::Osa.orders(place);
            assert_eq!((n * (n + 2)) as isize + m, 2 * place as isize);
            assert!(m.unsigned_abs() <= n && (n - m.unsigned_abs()) % 2 == 0);
        }
    }

    /// Normalised polynomials are orthonormal over the disc, by Gaussian quadrature in r^2 and equal steps in theta, which
    /// is exact for these degrees.
    #[test]
    fn they_are_orthonormal() {
        // 5-point Gauss-Legendre on [0, 1]
        let (a, b) = (0.906_179_845_938_664, 0.538_469_310_105_683_1);
        let (wa, wb) = (0.236_926_885_056_189_1, 0.478_628_670_499_366_47);
        let nodes = [(-a, wa), (-b, wb), (0.0, 0.568_888_888_888_888_9), (b, wb), (a, wa)];
        let all: Vec<Vec<(u32, u32, f64)>> = (0..15)
            .map(|place| {
                let mut list = vec![0.0; place];
                list.push(1.0);
                zernike_terms(Zernike::Osa, &list, 1.0)
            })
            .collect();
        for i in 0..all.len() {
            for j in 0..=i {
                let mut sum = 0.0;
                for (node, weight) in nodes {
                    let r = (0.5 * (node + 1.0_f64)).sqrt();
                    for step in 0..16 {
                        let angle = f64::from(step) * std::f64::consts::PI / 8.0;
                        let (x, y) = (r * libm::cos(angle), r * libm::sin(angle));
                        sum += 0.5 * weight / 16.0 * value(&all[i], x, y) * value(&all[j], x, y);
                    }
                }
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((sum - expected).abs() < 1e-12, "{i} {j} {sum}");
            }
        }
    }
}
