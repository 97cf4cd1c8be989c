//! Conversions of single numbers: decimal rounding and random bits.

/// The number rounded to `digits` significant decimal digits; infinite numbers and NaN are returned unchanged.
pub fn round_to_digits(value: f64, digits: usize) -> f64 {
    let decimals = digits.saturating_sub(1);
    format!("{value:.decimals$e}").parse().unwrap_or(value)
}

/// A uniform number in [0, 1) from 64 random bits: the upper 53 of them as a fraction.
pub fn unit_fraction(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_digits() {
        assert_eq!(round_to_digits(2.0 / 3.0, 6), 0.666_667);
        assert_eq!(round_to_digits(-123456789.0, 3), -123000000.0);
        assert_eq!(round_to_digits(2.5, 0), round_to_digits(2.5, 1));
        assert_eq!(round_to_digits(f64::INFINITY, 6), f64::INFINITY);
        assert!(round_to_digits(f64::NAN, 6).is_nan());
    }

    #[test]
    fn ends_of_the_unit_interval() {
        assert_eq!((unit_fraction(0), unit_fraction(u64::MAX)), (0.0, 1.0 - f64::EPSILON / 2.0));
    }
}
