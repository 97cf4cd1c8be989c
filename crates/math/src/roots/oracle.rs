//! Exact rational arithmetic as the oracle of the solvers' tests.

use dashu::base::Sign;
use dashu::rational::RBig;
use rand::{RngExt, rngs::ChaCha8Rng};

/// The exact value of a number.
pub fn exact(x: f64) -> RBig {
    RBig::try_from(x).expect("a finite number")
}

/// A random number at most `ulps` representable numbers away.
pub fn near(x: f64, ulps: i64, rng: &mut ChaCha8Rng) -> f64 {
    step(x, rng.random_range(-ulps..=ulps))
}

/// The number `ulps` representable numbers away from zero (or towards it).
pub fn step(x: f64, ulps: i64) -> f64 {
    f64::from_bits((x.to_bits() as i64 + ulps) as u64)
}

/// A random number of either sign between 10^-decades and 10^decades, uniform in the exponent.
pub fn wide(decades: f64, rng: &mut ChaCha8Rng) -> f64 {
    let size = libm::exp10(rng.random_range(-decades..decades));
    if rng.random() { size } else { -size }
}

/// The value of the polynomial `c[0] + c[1] t + ...` at t.
pub fn value(coefficients: &[f64], t: &RBig) -> RBig {
    coefficients.iter().rev().fold(RBig::ZERO, |sum, &c| sum * t + exact(c))
}

/// The sign: -1, 0 or 1.
pub fn sign(x: &RBig) -> i32 {
    match (x == &RBig::ZERO, x.sign()) {
        (true, _) => 0,
        (_, Sign::Negative) => -1,
        _ => 1,
    }
}

/// Asserts that the exact polynomial has its sign changes within `ulps` of the times.
pub fn sign_changes_within(c: &[f64], starts_negative: bool, times: &[f64], ulps: i64, label: &str) {
    let mut negative = starts_negative;
    for (k, &t) in times.iter().enumerate() {
        if t.abs() < 1e-290 {
            return; // ulps are not a relative measure there
        }
        let (lo, hi) = (step(t, -ulps), step(t, ulps));
        let (lo, hi) = (lo.min(hi), lo.max(hi));
        let before = sign(&value(c, &exact(lo)));
        let after = sign(&value(c, &exact(hi)));
        let alone = (k == 0 || times[k - 1] < lo) && times.get(k + 1).is_none_or(|&next| next > hi);
        assert!(!alone || before != after || before == 0, "{label}: no sign change at {t:e}");
        if alone && before != 0 {
            assert_eq!(before < 0, negative, "{label}: wrong sign before {t:e}");
        }
        negative = !negative;
    }
}

/// The number of distinct real roots, by Sturm's theorem.
pub fn count_real_roots(c: &[f64]) -> usize {
    let first = trimmed(c.iter().map(|&c| exact(c)).collect());
    let derivative = (1..first.len()).map(|k| exact(k as f64) * &first[k]).collect();
    let mut chain = vec![first, trimmed(derivative)];
    while chain[chain.len() - 1].len() > 1 {
        let rest = negated_remainder(&chain[chain.len() - 2], &chain[chain.len() - 1]);
        if rest.is_empty() {
            break;
        }
        chain.push(rest);
    }
    let changes = |left: bool| {
        let turn = |p: &Vec<RBig>| if left && p.len().is_multiple_of(2) { -1 } else { 1 };
        let signs = chain.iter().filter(|p| !p.is_empty());
        let signs: Vec<i32> = signs.map(|p| turn(p) * sign(&p[p.len() - 1])).collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    };
    changes(true) - changes(false)
}

fn trimmed(mut p: Vec<RBig>) -> Vec<RBig> {
    while p.last().is_some_and(|c| c == &RBig::ZERO) {
        p.pop();
    }
    p
}

fn negated_remainder(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    let mut rest = a.to_vec();
    while rest.len() >= b.len() {
        let factor = &rest[rest.len() - 1] / &b[b.len() - 1];
        let shift = rest.len() - b.len();
        for (k, c) in b.iter().enumerate() {
            rest[shift + k] = &rest[shift + k] - &factor * c;
        }
        rest.pop();
        rest = trimmed(rest);
    }
    rest.into_iter().map(|c| -c).collect()
}

/// Asserts that the sign at the start and the number of sign changes are exact and each is within 4 ulp.
pub fn check_polynomial(c: &[f64], starts_negative: bool, times: &[f64]) {
    let label = format!("{c:?}: {starts_negative} {times:?}");
    assert_eq!(starts_negative, (c[c.len() - 1] < 0.0) ^ c.len().is_multiple_of(2), "{label}");
    assert_eq!(times.len(), count_real_roots(c), "{label}");
    sign_changes_within(c, starts_negative, times, 4, &label);
}
