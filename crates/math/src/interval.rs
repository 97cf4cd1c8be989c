//! Interval arithmetic with outward rounding: guaranteed enclosures of real values.
//!
//! *Source*: R. E. Moore, *Interval Analysis* (1966). Each end is computed in round-to-nearest and moved outward by one `f64`, so
//! that the result contains the exact result for all members of the operands (inclusion). A NaN end gives [`Interval::ALL`].

use std::ops::{Add, Mul, Neg, Sub};

/// The closed interval from `lo` to `hi`, `lo <= hi`; ends may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub lo: f64,
    /// The upper end.
    pub hi: f64,
}

impl Interval {
    /// All real numbers.
    pub const ALL: Interval = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// The interval that contains one number.
    pub const fn point(x: f64) -> Interval {
        Interval { lo: x, hi: x }
    }

    /// The interval between two numbers in increasing order; [`Interval::ALL`] if either is NaN.
    pub fn new(lo: f64, hi: f64) -> Interval {
        if lo <= hi { Interval { lo, hi } } else { Interval::ALL }
    }

    /// The numbers at a distance of at most `radius` from `middle`.
    pub fn around(middle: f64, radius: f64) -> Interval {
        Interval::outward(middle - radius, middle + radius)
    }

    /// The ends moved outward to the next `f64`.
    fn outward(lo: f64, hi: f64) -> Interval {
        Interval::new(lo.next_down(), hi.next_up())
    }

    /// True if the interval contains zero.
    pub fn contains_zero(self) -> bool {
        self.lo <= 0.0 && self.hi >= 0.0
    }

    /// True if `x` is in the interval.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// The largest magnitude of a number of the interval.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The intersection of both intervals, or `self` if that is empty.
    pub fn narrowed(self, other: Interval) -> Interval {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        if lo <= hi { Interval { lo, hi } } else { self }
    }

    /// The square roots of the nonnegative numbers of the interval.
    pub fn sqrt(self) -> Interval {
        let root = |x: f64| x.max(0.0).sqrt();
        Interval::new(root(self.lo).next_down().max(0.0), root(self.hi).next_up())
    }

    /// The reciprocals of an interval of positive numbers; zero counts as a limit and gives infinity.
    pub fn positive_recip(self) -> Interval {
        let lo = (1.0 / self.hi).next_down().max(0.0);
        Interval::new(lo, if self.lo > 0.0 { (1.0 / self.lo).next_up() } else { f64::INFINITY })
    }

    /// The product of two intervals of nonnegative numbers; ends may be infinite. `0 * inf` gives all nonnegative numbers.
    pub fn positive_product(self, other: Interval) -> Interval {
        let (lo, hi) = (self.lo * other.lo, self.hi * other.hi);
        let hi = if hi.is_nan() { f64::INFINITY } else { hi.next_up() };
        Interval::new(lo.next_down().max(0.0), hi)
    }

    /// The squares, none of which is negative.
    pub fn square(self) -> Interval {
        let (a, b) = (self.lo * self.lo, self.hi * self.hi);
        let least = if self.contains_zero() { 0.0 } else { a.min(b).next_down().max(0.0) };
        Interval::new(least, a.max(b).next_up())
    }
}

impl Add for Interval {
    type Output = Interval;

    fn add(self, other: Interval) -> Interval {
        Interval::outward(self.lo + other.lo, self.hi + other.hi)
    }
}

impl Sub for Interval {
    type Output = Interval;

    fn sub(self, other: Interval) -> Interval {
        Interval::outward(self.lo - other.hi, self.hi - other.lo)
    }
}

impl Neg for Interval {
    type Output = Interval;

    fn neg(self) -> Interval {
        Interval { lo: -self.hi, hi: -self.lo }
    }
}

impl Mul for Interval {
    type Output = Interval;

    fn mul(self, other: Interval) -> Interval {
        let products = [self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi];
        if products.iter().any(|p| p.is_nan()) {
            return Interval::ALL;
        }
        let lo = products.into_iter().fold(f64::INFINITY, f64::min);
        let hi = products.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Interval::outward(lo, hi)
    }
}

impl Mul<f64> for Interval {
    type Output = Interval;

    fn mul(self, factor: f64) -> Interval {
        let (a, b) = (self.lo * factor, self.hi * factor);
        if factor < 0.0 { Interval::outward(b, a) } else { Interval::outward(a, b) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_contain_the_results_of_members() {
        let (a, b) = (Interval::new(-1.5, 0.1), Interval::new(0.3, 7.0));
        for x in [a.lo, 0.0, a.hi] {
            for y in [b.lo, 2.0, b.hi] {
                assert!((a + b).contains(x + y) && (a - b).contains(x - y) && (a * b).contains(x * y));
                assert!((a * y).contains(x * y) && (a * -y).contains(x * -y));
                assert!(b.sqrt().contains(y.sqrt()) && b.positive_recip().contains(1.0 / y));
            }
            assert!(a.square().contains(x * x) && (-a).contains(-x) && x.abs() <= a.magnitude());
        }
        assert_eq!(a.square().lo, 0.0);
        assert!(b.square().lo > 0.0);
        assert_eq!(Interval::new(-1.0, 4.0).sqrt().lo, 0.0);
        assert_eq!(Interval::new(0.0, 2.0).positive_recip().hi, f64::INFINITY);
    }

    #[test]
    fn products_keep_their_sign_beside_infinity() {
        let (tiny, most) = (Interval::new(0.0, 2.0), Interval::new(3.0, f64::INFINITY));
        assert_eq!(tiny.positive_product(most), Interval::new(0.0, f64::INFINITY));
        assert_eq!(Interval::point(0.0).positive_product(most), Interval::new(0.0, f64::INFINITY));
        let exact = Interval::new(1.5, 2.0).positive_product(Interval::new(0.3, 7.0));
        assert!(exact.contains(1.5 * 0.3) && exact.contains(14.0) && exact.lo > 0.4499 && exact.hi < 14.001);
    }

    #[test]
    fn narrowing_is_never_empty() {
        let a = Interval::new(0.0, 2.0);
        assert_eq!(a.narrowed(Interval::new(1.0, 3.0)), Interval::new(1.0, 2.0));
        assert_eq!(a.narrowed(Interval::new(3.0, 4.0)), a);
    }

    #[test]
    fn undefined_results_are_all_numbers() {
        assert_eq!(Interval::new(f64::NAN, 1.0), Interval::ALL);
        assert_eq!(Interval::ALL * Interval::point(0.0), Interval::ALL);
        assert_eq!(Interval::ALL * 0.0, Interval::ALL);
        assert_eq!(Interval::ALL - Interval::ALL, Interval::ALL);
    }
}
