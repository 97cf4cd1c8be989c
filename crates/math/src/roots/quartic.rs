//! Quartic solver: real roots at which a quartic polynomial changes sign.
//!
//! *Source* and *guarantee*: [isolate](super::isolate); extrema by [`cubic()`]. Times are within 4 ulp of the
//! exact roots of the given coefficients unless three or four of them nearly coincide. Nearly double roots are distinguished
//! from none within doubled precision. (Algorithms that factor the quartic, such as A. G. Orellana, C. De Michele, ACM
//! Algorithm 1010 (2020), are faster, but distinguish nearly double roots within working precision only.) Coefficients may
//! be any finite numbers.
//!
//! *Degenerate cases*: `c4 == 0` is the cubic. A NaN or infinite coefficient gives a nonnegative constant.

use super::isolate::sign_changes;
use super::{Crossings, cubic};

/// The sign changes of `c0 + c1 t + c2 t^2 + c3 t^3 + c4 t^4`.
pub fn quartic(c0: f64, c1: f64, c2: f64, c3: f64, c4: f64) -> Crossings<4> {
    if c4 == 0.0 {
        return cubic(c0, c1, c2, c3).widen();
    }
    let c = [c0, c1, c2, c3, c4];
    if !c.iter().all(|c| c.is_finite()) {
        return Crossings::constant(false);
    }
    let extrema = cubic(0.25 * c1, 0.5 * c2, 0.75 * c3, c4);
    sign_changes(&c, extrema.times())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roots::oracle::{check_polynomial, near, wide};
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn check(c: [f64; 5]) {
        let got = quartic(c[0], c[1], c[2], c[3], c[4]);
        check_polynomial(&c, got.starts_negative(), got.times());
    }

    #[test]
    fn random_and_nearly_double_roots() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for _ in 0..700 {
            check(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
            check(std::array::from_fn(|_| wide(150.0, &mut rng)));
            // (t - r)^2 (t^2 + p t + q) with coefficients moved by up to 32 ulp
            let [r, p, q]: [f64; 3] = std::array::from_fn(|_| rng.random_range(-2.0..2.0));
            let planted = [r * r * q, r * r * p - 2.0 * r * q, r * r - 2.0 * r * p + q, p - 2.0 * r, 1.0];
            check(planted.map(|c| near(c, 32, &mut rng)));
            check(planted.map(|c| near(-1e120 * c, 2, &mut rng)));
        }
    }

    /// `(|r|^2 + R^2 - q^2)^2 - 4 R^2 rho^2` along rays about and far from a torus, fat and thin.
    #[test]
    fn tori_from_near_and_far() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        for k in 0..600 {
            let (far, tube) = ([1.0, 1e3, 1.0][k % 3], [0.5, 0.5, 1e-3][k % 3]);
            let target = [1.0 + tube * rng.random_range(-1.5..1.5), 0.0, 0.0];
            let d: [f64; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
            let o: [f64; 3] = std::array::from_fn(|i| target[i] - far * d[i]);
            let dot = |a: [f64; 3], b: [f64; 3], n: usize| (0..n).map(|i| a[i] * b[i]).sum::<f64>();
            let (a, b, c) = (dot(d, d, 3), 2.0 * dot(o, d, 3), dot(o, o, 3) + 1.0 - tube * tube);
            check([
                c * c - 4.0 * dot(o, o, 2),
                2.0 * b * c - 8.0 * dot(o, d, 2),
                b * b + 2.0 * a * c - 4.0 * dot(d, d, 2),
                2.0 * a * b,
                a * a,
            ]);
        }
    }

    #[test]
    fn degenerate_polynomials_have_the_documented_results() {
        assert_eq!(quartic(4.0, 0.0, -5.0, 0.0, 1.0).times(), [-2.0, -1.0, 1.0, 2.0]);
        assert_eq!(quartic(-1.0, 0.0, 0.0, 0.0, 1.0).times(), [-1.0, 1.0]);
        assert_eq!(quartic(1.0, 0.0, -2.0, 0.0, 1.0), Crossings::constant(false));
        assert_eq!(quartic(0.0, 0.0, 0.0, 0.0, -1.0), Crossings::constant(true));
        assert_eq!(quartic(0.0, 0.0, 0.0, -1.0, 1.0).times(), [0.0, 1.0]);
        assert_eq!(quartic(-1.0, 1.0, 0.0, 0.0, 0.0).times(), [1.0]);
        assert_eq!(quartic(f64::INFINITY, 0.0, 0.0, 0.0, 1.0), Crossings::constant(false));
    }
}
