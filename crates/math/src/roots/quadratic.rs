//! Quadratic solver: real roots at which a quadratic polynomial changes sign.
//!
//! *Source*: W. Kahan, "On the Cost of Floating-Point Computation Without Extra-Precise Arithmetic" (2004);
//! the discriminant is a compensated difference of products.
//!
//! *Guarantee*: each time is within 4 ulp of the exact root of the polynomial with the given (rounded)
//! coefficients, also next to a double root. The exact sign of the discriminant decides whether there are roots. No
//! intermediate result over- or underflows: coefficients may be any finite numbers. A factor 2^k on all coefficients changes no
//! bit; a power of two as a factor on t scales the times exactly.
//!
//! *Degenerate cases*: `a == 0` is the linear case, `a == half_b == 0` a constant with the sign of `c`. A double root is not a
//! sign change, nor are two roots that round to the same number. A time beyond the range of f64 is dropped; at -inf it changes
//! the sign at the start. A NaN gives a nonnegative constant.

use super::{Crossings, difference_of_products};

/// The sign changes of `a t^2 + 2 half_b t + c`.
pub fn quadratic(a: f64, half_b: f64, c: f64) -> Crossings<2> {
    if a == 0.0 {
        return linear(half_b, 0.5 * c);
    }
    if in_fast_range(a) && in_fast_range(half_b) && in_fast_range(c) {
        let discriminant = difference_of_products(half_b, half_b, a, c);
        return match far_part(half_b, discriminant) {
            Some(q) => ordered(a < 0.0, q / a, c / q),
            None => Crossings::constant(a < 0.0),
        };
    }
    quadratic_scaled(a, half_b, c)
}

/// The sign changes of `b t + c`.
fn linear(b: f64, c: f64) -> Crossings<2> {
    if b == 0.0 || b.is_nan() {
        return Crossings::constant(c < 0.0);
    }
    Crossings::new(b > 0.0, &[-c / b])
}

/// True if the square and its rounding error are normal numbers: 0 or 2^-450 <= |x| <= 2^450.
fn in_fast_range(x: f64) -> bool {
    const LEAST: f64 = f64::from_bits((1023 - 450) << 52);
    const LARGEST: f64 = f64::from_bits((1023 + 450) << 52);
    x == 0.0 || (LEAST..=LARGEST).contains(&x.abs())
}

/// `q = -(b + sign(b) sqrt(discriminant))`, a sum without cancellation; the roots are q / a and c / q. `None` if there are no
/// two real roots.
fn far_part(half_b: f64, discriminant: f64) -> Option<f64> {
    (discriminant > 0.0).then(|| -(half_b + discriminant.sqrt().copysign(half_b)))
}

fn ordered(starts_negative: bool, t: f64, s: f64) -> Crossings<2> {
    Crossings::new(starts_negative, &[t.min(s), t.max(s)])
}

/// The quadratic with exponents handled separately, for coefficients whose products would over- or underflow.
fn quadratic_scaled(a: f64, half_b: f64, c: f64) -> Crossings<2> {
    if !(a.is_finite() && half_b.is_finite() && c.is_finite()) {
        return Crossings::constant(a < 0.0);
    }
    let ((a, ea), (b, eb), (c, ec)) = (parts(a), parts(half_b), parts(c));
    // the discriminant in units of 2^(2 e)
    let e = eb.max((ea + ec + 1).div_euclid(2));
    let b = libm::ldexp(b, eb - e);
    let discriminant = difference_of_products(b, b, a, libm::ldexp(c, ea + ec - 2 * e));
    match far_part(b, discriminant) {
        Some(q) => ordered(a < 0.0, libm::ldexp(q / a, e - ea), libm::ldexp(c / q, ec - e)),
        None => Crossings::constant(a < 0.0),
    }
}

/// Mantissa in [0.5, 1) and exponent; the exponent of 0 is below all others.
fn parts(x: f64) -> (f64, i32) {
    if x == 0.0 { (0.0, -10_000) } else { libm::frexp(x) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roots::oracle::{exact, near, sign_changes_within, wide};
    use dashu::base::Sign;
    use dashu::rational::RBig;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    /// Checks exactly: the number of sign changes by the discriminant, each time by the signs on both sides of it.
    fn check(a: f64, half_b: f64, c: f64) {
        let got = quadratic(a, half_b, c);
        let discriminant = exact(half_b) * exact(half_b) - exact(a) * exact(c);
        let two = a != 0.0 && discriminant.sign() == Sign::Positive && discriminant != RBig::ZERO;
        let label = format!("{a:e} t^2 + 2 {half_b:e} t + {c:e}: {got:?}");
        assert!(two || got.times().is_empty(), "{label}");
        if two && got.times().len() == 2 {
            assert_eq!(got.starts_negative(), a < 0.0, "{label}");
        }
        let coefficients = [c, 2.0 * half_b, a];
        sign_changes_within(&coefficients, got.starts_negative(), got.times(), 4, &label);
    }

    #[test]
    fn times_are_within_four_ulp_next_to_double_roots() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..4000 {
            let a: f64 = rng.random_range(0.1..10.0);
            let half_b = rng.random_range(-10.0..10.0);
            let c = near(half_b * half_b / a, 32, &mut rng);
            check(a, half_b, c);
            check(-a, half_b, -c);
        }
    }

    #[test]
    fn wide_ranges_neither_overflow_nor_underflow() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for _ in 0..4000 {
            let (a, half_b) = (wide(150.0, &mut rng), wide(150.0, &mut rng));
            check(a, half_b, wide(150.0, &mut rng));
            let (a, half_b) = (wide(90.0, &mut rng), wide(90.0, &mut rng));
            check(a, half_b, near(half_b / a * half_b, 32, &mut rng));
        }
        let tiny = libm::ldexp(1.0, -1000);
        assert_eq!(quadratic(1e300, 0.0, -1e300).times(), [-1.0, 1.0]);
        assert_eq!(quadratic(1e-300, 0.0, -4e-300).times(), [-2.0, 2.0]);
        assert_eq!(quadratic(tiny, -1.5 * tiny, 2.0 * tiny).times(), [1.0, 2.0]);
        // the far root is beyond the range of f64 and counts as passed: the sign at the start is the one after it
        let passed = quadratic(1e-300, 1e200, 1e200);
        assert!(passed.starts_negative());
        assert_eq!(passed.times(), [-0.5]);
    }

    #[test]
    fn degenerate_polynomials_have_the_documented_results() {
        assert_eq!(quadratic(0.0, 1.0, -2.0), Crossings::new(true, &[1.0]));
        assert_eq!(quadratic(0.0, -1.0, -2.0), Crossings::new(false, &[-1.0]));
        assert_eq!(quadratic(0.0, 0.0, -1.0), Crossings::constant(true));
        assert_eq!(quadratic(0.0, 0.0, 0.0), Crossings::constant(false));
        assert_eq!(quadratic(-1.0, 1.0, -1.0), Crossings::constant(true));
        assert_eq!(quadratic(1.0, 0.0, 0.0), Crossings::constant(false));
        assert_eq!(quadratic(1.0, 1.0, 0.0).times(), [-2.0, 0.0]);
        assert!(quadratic(1.0, 1.0, 0.0).times()[1].is_sign_positive());
        assert_eq!(quadratic(f64::NAN, 1.0, 0.0), Crossings::constant(false));
        assert_eq!(quadratic(1.0, f64::NAN, 0.0), Crossings::constant(false));
    }

    #[test]
    fn powers_of_two_scale_exactly() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..500 {
            let [a, b, c]: [f64; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
            let got = quadratic(a, b, c);
            for scale in [480, -480, 37] {
                let by = |x: f64| libm::ldexp(x, scale);
                assert_eq!(quadratic(by(a), by(b), by(c)), got);
                let slower = quadratic(libm::ldexp(a, -2 * (scale / 2)), libm::ldexp(b, -(scale / 2)), c);
                let times: Vec<f64> = got.times().iter().map(|&t| libm::ldexp(t, scale / 2)).collect();
                assert_eq!(slower.times(), times);
            }
        }
    }
}
