//! Root isolation by extrema: sign changes of a polynomial between its extrema, for [`cubic()`](super::cubic()) and
//! [`quartic()`](super::quartic()).
//!
//! *Source*: C. Yuksel, "High-Performance Polynomial Root Finding for Graphics", Proc. ACM Comput. Graph.
//! Interact. Tech. 5 (2022): between neighbouring extrema a polynomial is monotonic and changes sign at most
//! once. Values are computed by the compensated Horner scheme of S. Graillat, P. Langlois, N. Louvet
//! ("Compensated Horner Scheme", 2005), as if in doubled precision.
//!
//! *Guarantee*: the sign changes are in order and their number has the right parity under any rounding, because they
//! follow from the signs at a list of points. The sign at an extremum is right unless the value is below about `u^2` times the
//! sum of the magnitudes of the terms. No intermediate result over- or underflows: the terms are scaled by powers of two.
//!
//! *Degenerate cases*: a polynomial that is 0 at an extremum has a double root there, which is not a sign change.

use super::{Crossings, two_product, two_sum};

/// Sign changes of the polynomial `c[0] + c[1] t + ...` with the given extrema in increasing order. All coefficients are
/// finite, and the last one is not 0.
pub(super) fn sign_changes<const M: usize, const N: usize>(c: &[f64; M], extrema: &[f64]) -> Crossings<N> {
    let starts_negative = (c[M - 1] < 0.0) ^ M.is_multiple_of(2);
    let bound = bound(c);
    let (mut times, mut count) = ([0.0; N], 0);
    let (mut from, mut negative) = (-bound, starts_negative);
    let ends_negative = c[M - 1] < 0.0;
    let inner = extrema.iter().map(|&t| (t, Terms::at(c, t).value));
    let last = (bound, if ends_negative { -1.0 } else { 1.0 });
    for (to, value) in inner.chain([last]) {
        if value != 0.0 && (value < 0.0) != negative && count < N {
            times[count] = root(c, from, to, negative);
            count += 1;
            negative = !negative;
        }
        from = to;
    }
    Crossings::new(starts_negative, &times[..count])
}

/// Fujiwara's bound of the magnitude of all roots, `2 max |c_i / c_n|^(1 / (n - i))`, rounded up to a power of two.
fn bound<const M: usize>(c: &[f64; M]) -> f64 {
    let degree = M - 1;
    let exponent = |i: usize| libm::frexp(c[i]).1;
    let largest = (0..degree)
        .filter(|&i| c[i] != 0.0)
        .map(|i| (exponent(i) + 1 - exponent(degree)).div_euclid((degree - i) as i32) + 1)
        .max();
    libm::ldexp(2.0, largest.unwrap_or(0)).min(f64::MAX)
}

/// Value of a polynomial at a point, times a power of two that depends on the point, and its Newton step.
struct Terms {
    value: f64,
    /// The Newton step: value / slope.
    step: f64,
}

impl Terms {
    fn at<const M: usize>(c: &[f64; M], t: f64) -> Terms {
        let (mantissa, exponent) = if t == 0.0 { (0.0, 0) } else { libm::frexp(t) };
        let parts = c.map(libm::frexp);
        let power = |i: usize| parts[i].1 + exponent * i as i32;
        let largest = (0..M).filter(|&i| c[i] != 0.0).map(power).max().unwrap_or(0);
        let scaled: [f64; M] = std::array::from_fn(|i| libm::ldexp(parts[i].0, power(i) - largest));
        let value = value(&scaled, mantissa);
        Terms { value, step: libm::ldexp(value / slope(&scaled, mantissa), exponent) }
    }
}

/// The value at t by the compensated Horner scheme: rounded once unless it is tiny compared to its terms.
fn value<const M: usize>(c: &[f64; M], t: f64) -> f64 {
    let (mut sum, mut error) = (c[M - 1], 0.0);
    for &next in c[..M - 1].iter().rev() {
        let (product, product_error) = two_product(sum, t);
        let (total, sum_error) = two_sum(product, next);
        sum = total;
        error = error * t + (product_error + sum_error);
    }
    sum + error
}

fn slope<const M: usize>(c: &[f64; M], t: f64) -> f64 {
    (1..M).rev().fold(0.0, |sum, i| sum * t + i as f64 * c[i])
}

/// The sign change in a bracket, by Newton's method safeguarded by bisection: a step that leaves the bracket or hardly shortens
/// it is replaced by the middle.
fn root<const M: usize>(c: &[f64; M], mut lo: f64, mut hi: f64, negative: bool) -> f64 {
    let mut t = middle(lo, hi);
    while lo < t && t < hi {
        let terms = Terms::at(c, t);
        if terms.value == 0.0 || t - terms.step == t {
            return t;
        }
        if (terms.value < 0.0) == negative {
            lo = t;
        } else {
            hi = t;
        }
        let next = t - terms.step;
        let newton = lo < next && next < hi && terms.step.abs() < 0.5 * (hi - lo);
        t = if newton { next } else { middle(lo, hi) };
    }
    t
}

/// The midpoint; the geometric mean if the ends differ much in magnitude, so that bisection reaches roots near 0.
fn middle(lo: f64, hi: f64) -> f64 {
    if lo < 0.0 && hi > 0.0 {
        return 0.0;
    }
    let (near, far) = if lo.abs() < hi.abs() { (lo, hi) } else { (hi, lo) };
    if near.abs() > 0.25 * far.abs() {
        return 0.5 * lo + 0.5 * hi;
    }
    near.abs().max(f64::MIN_POSITIVE).sqrt() * far.abs().sqrt() * far.signum()
}
