//! Dyadic numbers m 2^e with integers m and e: exact arithmetic on `f64` values.

use dashu_int::ops::{BitTest, SquareRoot};
use dashu_int::{IBig, Sign};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// A number m 2^e.
#[derive(Clone, Debug)]
pub struct Dyadic {
    mantissa: IBig,
    exponent: isize,
}

/// More bits than any comparison of times in double precision needs.
const PRECISION: isize = 192;

impl Dyadic {
    /// Zero.
    pub const ZERO: Dyadic = Dyadic { mantissa: IBig::ZERO, exponent: 0 };
    /// One.
    pub const ONE: Dyadic = Dyadic { mantissa: IBig::ONE, exponent: 0 };

    /// True if it is zero.
    pub fn is_zero(&self) -> bool {
        self.mantissa.is_zero()
    }

    /// The sign: -1, 0 or 1.
    pub fn sign(&self) -> i32 {
        match self.mantissa.sign() {
            _ if self.mantissa.is_zero() => 0,
            Sign::Positive => 1,
            Sign::Negative => -1,
        }
    }

    /// The absolute value.
    pub fn abs(&self) -> Dyadic {
        if self.sign() < 0 { -self } else { self.clone() }
    }

    /// The number times 2^k.
    pub fn scaled(&self, k: isize) -> Dyadic {
        Dyadic { mantissa: self.mantissa.clone(), exponent: self.exponent + k }
    }

    /// The square.
    pub fn square(&self) -> Dyadic {
        self * self
    }

    /// Exact comparison.
    pub fn compare(&self, other: &Dyadic) -> Ordering {
        (self - other).sign().cmp(&0)
    }

    /// The number of bits of the mantissa.
    fn bits(&self) -> isize {
        self.mantissa.bit_len() as isize
    }

    /// The number truncated to 192 bits, towards -inf.
    pub fn rounded(&self) -> Dyadic {
        let excess = self.bits() - PRECISION;
        if excess <= 0 {
            return self.clone();
        }
        Dyadic { mantissa: &self.mantissa >> excess as usize, exponent: self.exponent + excess }
    }

    /// The square root of a number >= 0, to about 192 bits.
    pub fn root(&self) -> Dyadic {
        let missing = (2 * PRECISION - self.bits()).max(0);
        let shift = missing + (self.exponent - missing).rem_euclid(2);
        let mantissa = (&self.mantissa << shift as usize).sqrt();
        Dyadic { mantissa: mantissa.into(), exponent: (self.exponent - shift) / 2 }
    }

    /// The quotient by a number that is not zero, to about 192 bits.
    pub fn over(&self, divisor: &Dyadic) -> Dyadic {
        let shift = (PRECISION + divisor.bits() - self.bits()).max(0);
        let mantissa = (&self.mantissa << shift as usize) / &divisor.mantissa;
        Dyadic { mantissa, exponent: self.exponent - shift - divisor.exponent }
    }

    /// A nearby `f64`, within one ulp.
    pub fn to_f64(&self) -> f64 {
        let excess = (self.bits() - 100).max(0);
        let top = i128::try_from(&self.mantissa >> excess as usize).expect("100 bits fit");
        libm::ldexp(top as f64, (self.exponent + excess).clamp(-5000, 5000) as i32)
    }
}

impl From<f64> for Dyadic {
    /// Exact conversion. Panics if the number is not finite.
    fn from(x: f64) -> Dyadic {
        assert!(x.is_finite(), "{x} is not finite");
        let (fraction, exponent) = libm::frexp(x);
        let whole = libm::ldexp(fraction, 53) as i64;
        // short mantissas keep products short
        let zeros = if whole == 0 { 0 } else { whole.trailing_zeros() };
        Dyadic { mantissa: IBig::from(whole >> zeros), exponent: exponent as isize - 53 + zeros as isize }
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: &Dyadic) -> Dyadic {
        if self.is_zero() {
            return other.clone();
        }
        if other.is_zero() {
            return self.clone();
        }
        let (low, high) = if self.exponent <= other.exponent { (self, other) } else { (other, self) };
        let shift = (high.exponent - low.exponent) as usize;
        let mantissa = match shift {
            0 => &low.mantissa + &high.mantissa,
            _ => &low.mantissa + (&high.mantissa << shift),
        };
        Dyadic { mantissa, exponent: low.exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: &Dyadic) -> Dyadic {
        self + &-other
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: &Dyadic) -> Dyadic {
        if self.is_zero() || other.is_zero() {
            return Dyadic::ZERO;
        }
        Dyadic { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
}

impl Neg for &Dyadic {
    type Output = Dyadic;
    fn neg(self) -> Dyadic {
        Dyadic { mantissa: -&self.mantissa, exponent: self.exponent }
    }
}

impl PartialEq for Dyadic {
    fn eq(&self, other: &Dyadic) -> bool {
        self.compare(other).is_eq()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;

    #[test]
    fn arithmetic_without_rounding() {
        let mut rng = Random::new(1);
        for _ in 0..500 {
            let [a, b] = [rng.magnitude(-30.0, 30.0), rng.magnitude(-30.0, 30.0)];
            let (x, y) = (Dyadic::from(a), Dyadic::from(b));
            assert_eq!(x.to_f64(), a);
            assert_eq!((&x + &y).to_f64(), a + b);
            assert_eq!((&x - &y).to_f64(), a - b);
            assert_eq!((&x * &y).to_f64(), a * b);
            assert_eq!(&(&(&x + &y) - &x), &y);
            assert_eq!(x.compare(&y), a.total_cmp(&b));
        }
    }

    #[test]
    fn roots_and_quotients() {
        let mut rng = Random::new(2);
        for _ in 0..500 {
            let [a, b] = [rng.magnitude(-30.0, 30.0).abs(), rng.magnitude(-30.0, 30.0)];
            let (x, y) = (Dyadic::from(a), Dyadic::from(b));
            let small = |error: Dyadic, of: &Dyadic| {
                let bound = of.abs().scaled(-180);
                assert!(error.abs().compare(&bound).is_le(), "{a:e} {b:e}");
            };
            small(&x.root().square() - &x, &x);
            small(&(&x.over(&y) * &y) - &x, &x);
        }
    }
}
