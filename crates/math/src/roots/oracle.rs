//! Exact arithmetic for the tests of the solvers.

use dashu::base::Sign;
use dashu::rational::RBig;
use rand::{RngExt, rngs::ChaCha8Rng};

/// The number itself.
pub fn exact(x: f64) -> RBig {
    RBig::try_from(x).expect("a finite number")
}

/// A number at most `ulps` representable numbers away.
pub fn near(x: f64, ulps: i64, rng: &mut ChaCha8Rng) -> f64 {
    step(x, rng.random_range(-ulps..=ulps))
}

/// The number `ulps` representable numbers away from zero (or towards it).
pub fn step(x: f64, ulps: i64) -> f64 {
    f64::from_bits((x.to_bits() as i64 + ulps) as u64)
}

/// A number of either sign between 10^-decades and 10^decades, evenly in the exponent.
pub fn wide(decades: f64, rng: &mut ChaCha8Rng) -> f64 {
    let size = libm::exp10(rng.random_range(-decades..decades));
    if rng.random() { size } else { -size }
}

/// The polynomial with coefficients `c[0] + c[1] t + ...` at t.
pub fn value(coefficients: &[f64], t: &RBig) -> RBig {
    coefficients
        .iter()
        .rev()
        .fold(RBig::ZERO, |sum, &c| sum * t + exact(c))
}

/// -1, 0 or 1.
pub fn sign(x: &RBig) -> i32 {
    match (x == &RBig::ZERO, x.sign()) {
        (true, _) => 0,
        (_, Sign::Negative) => -1,
        _ => 1,
    }
}

/// Asserts that the exact polynomial has its sign changes within `ulps` of the times.
pub fn sign_changes_within(
    c: &[f64],
    starts_negative: bool,
    times: &[f64],
    ulps: i64,
    label: &str,
) {
    let mut negative = starts_negative;
    for (k, &t) in times.iter().enumerate() {
        if t.abs() < 1e-290 {
            return; // an ulp is no measure there
        }
        let (lo, hi) = (step(t, -ulps), step(t, ulps));
        let (lo, hi) = (lo.min(hi), lo.max(hi));
        let before = sign(&value(c, &exact(lo)));
        let after = sign(&value(c, &exact(hi)));
        let alone = (k == 0 || times[k - 1] < lo) && times.get(k + 1).is_none_or(|&next| next > hi);
        assert!(
            !alone || before != after || before == 0,
            "{label}: no sign change at {t:e}"
        );
        if alone && before != 0 {
            assert_eq!(before < 0, negative, "{label}: wrong sign before {t:e}");
        }
        negative = !negative;
    }
}
