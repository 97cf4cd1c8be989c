//! Error-free transformations: sums and products of `f64` with their exact rounding errors (double-double parts).
//!
//! *Source*: T. J. Dekker, "A floating-point technique for extending the available precision", Numer. Math.
//! 18 (1971), with G. W. Veltkamp's splitting; D. E. Knuth, TAOCP 2, 4.2.2 (two-sum); W. Kahan's
//! difference of products.
//!
//! *Guarantee*: only +, -, * in round-to-nearest, never a fused operation, so every platform and every SIMD
//! level gives the same bits. `two_sum` is exact unless it overflows. `two_product` is exact if the factors
//! are below 2^996 in magnitude and the product is 0 or above 2^-916 (its error is then a normal number).
//!
//! *Degenerate cases*: infinities and NaN give NaN.

/// The rounded sum of two numbers and its exact error: `a + b = sum + error`.
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The rounded product of two numbers and its exact error: `a * b = product + error`.
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let (ah, al) = split(a);
    let (bh, bl) = split(b);
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

/// Splits a number into two of at most 26 significant bits each, whose products are exact (Veltkamp).
fn split(a: f64) -> (f64, f64) {
    let shifted = 134_217_729.0 * a; // 2^27 + 1
    let high = shifted - (shifted - a);
    (high, a - high)
}

/// `a b - c d` within 2 ulp of the exact value under any cancellation, in the range of [`two_product`]. The sign is exact, and
/// the result is 0 only if the products are equal.
///
/// The four parts of the two exact products are summed leading parts first. If the leading parts cancel, their difference is
/// exact (Sterbenz); if not, the other parts are below its rounding.
pub fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (p, p_error) = two_product(a, b);
    let (q, q_error) = two_product(c, d);
    let (high, high_error) = two_sum(p, -q);
    let (low, low_error) = two_sum(p_error, -q_error);
    (high + low) + (high_error + low_error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::rational::RBig;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn exact(x: f64) -> RBig {
        RBig::try_from(x).unwrap()
    }

    fn near(x: f64, rng: &mut ChaCha8Rng) -> f64 {
        let ulps = rng.random_range(-32i64..=32);
        f64::from_bits((x.to_bits() as i64 + ulps) as u64)
    }

    #[test]
    fn products_and_sums_are_exact() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..2000 {
            let a = rng.random_range(-1.0..1.0) * libm::exp2(rng.random_range(-400.0..400.0));
            let b = rng.random_range(-1.0..1.0) * libm::exp2(rng.random_range(-400.0..400.0));
            let (p, e) = two_product(a, b);
            assert_eq!(exact(a) * exact(b), exact(p) + exact(e), "{a} * {b}");
            let (s, e) = two_sum(a, b);
            assert_eq!(exact(a) + exact(b), exact(s) + exact(e), "{a} + {b}");
        }
    }

    #[test]
    fn differences_of_nearly_equal_products_keep_their_digits() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..5000 {
            let a = rng.random_range(0.5..2.0);
            let b = rng.random_range(0.5..2.0);
            let c = near(a, &mut rng);
            let d = near(a * b / c, &mut rng);
            let truth = exact(a) * exact(b) - exact(c) * exact(d);
            let got = difference_of_products(a, b, c, d);
            let error = (exact(got) - truth.clone()).to_f64().value().abs();
            assert!(error <= truth.to_f64().value().abs() * 4.5e-16, "{a} {b} {c} {d}");
            assert_eq!(got == 0.0, truth == RBig::ZERO);
        }
    }
}
