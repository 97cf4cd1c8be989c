//! Cubic solver: real roots at which a cubic polynomial changes sign.
//!
//! *Source* and *guarantee*: [isolate](super::isolate); extrema by [`quadratic()`]. Times are within 4 ulp of
//! the exact roots of the given coefficients unless they are nearly triple. Coefficients may be any finite
//! numbers.
//!
//! *Degenerate cases*: `c3 == 0` is the quadratic. A NaN or infinite coefficient gives a nonnegative constant.

use super::isolate::sign_changes;
use super::{Crossings, quadratic};

/// The sign changes of `c0 + c1 t + c2 t^2 + c3 t^3`.
pub fn cubic(c0: f64, c1: f64, c2: f64, c3: f64) -> Crossings<3> {
    if c3 == 0.0 {
        return quadratic(c2, 0.5 * c1, c0).widen();
    }
    let c = [c0, c1, c2, c3];
    if !c.iter().all(|c| c.is_finite()) {
        return Crossings::constant(false);
    }
    let extrema = quadratic(0.75 * c3, 0.25 * c2, 0.25 * c1);
    sign_changes(&c, extrema.times())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roots::oracle::{check_polynomial, near, wide};
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn check(c: [f64; 4]) {
        let got = cubic(c[0], c[1], c[2], c[3]);
        check_polynomial(&c, got.starts_negative(), got.times());
    }

    #[test]
    fn random_and_nearly_double_roots() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        for _ in 0..1000 {
            check(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
            check(std::array::from_fn(|_| wide(150.0, &mut rng)));
            // (t - r)^2 (t - s) with coefficients moved by up to 32 ulp
            let (r, s): (f64, f64) = (rng.random_range(-2.0..2.0), rng.random_range(-2.0..2.0));
            let planted = [-r * r * s, r * r + 2.0 * r * s, -(2.0 * r + s), 1.0];
            check(planted.map(|c| near(c, 32, &mut rng)));
            check(planted.map(|c| near(-1e120 * c, 2, &mut rng)));
        }
    }

    #[test]
    fn degenerate_polynomials_have_the_documented_results() {
        assert_eq!(cubic(-1.0, 0.0, 1.0, 0.0).times(), [-1.0, 1.0]);
        assert_eq!(cubic(0.0, 0.0, 0.0, 2.0), Crossings::new(true, &[0.0]));
        assert_eq!(cubic(0.0, -1.0, 0.0, 1.0).times(), [-1.0, 0.0, 1.0]);
        let triple = cubic(-8.0, 12.0, -6.0, 1.0);
        assert!(triple.times().len() == 1 && (triple.times()[0] - 2.0).abs() < 1e-10);
        assert_eq!(cubic(2.0, -5.0, 4.0, -1.0), Crossings::new(false, &[2.0]));
        assert_eq!(cubic(1.0, 0.0, f64::NAN, 1.0), Crossings::constant(false));
        let far = cubic(-1.0, 1.0, 0.0, 1e-300);
        assert_eq!((far.starts_negative(), far.times()), (true, &[1.0][..]));
    }
}
