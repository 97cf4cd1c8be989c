//! Radii of `CURV` lines, which state curvatures.
//!
//! Between 1 and 2 and every power of 2 times that, curvatures in f64 are farther apart than radii in part of the
//! range, so that not every radius is 1 / c of some number c in f64. Curvatures are therefore written with as many
//! digits as the radius needs, and their reciprocals are computed from the decimal digits.

use super::decimal;

/// Digits after the point of curvatures that need more than those of an f64: 10^22 times 2^52 fits into 128 bits.
const PLACES: usize = 22;

/// The radius of curvature of the argument of `CURV`; infinite for 0.
pub(super) fn radius(text: &str, curvature: f64) -> f64 {
    match curvature {
        0.0 => f64::INFINITY,
        _ => reciprocal(text).unwrap_or_else(|| decimal(1.0 / curvature)),
    }
}

/// The argument of `CURV` whose [`radius`] is this one: with 16 digits if that is enough.
pub(super) fn curvature(radius: f64) -> String {
    let near = if radius.is_infinite() { 0.0 } else { 1.0 / radius };
    let plain = format!("{near:.15e}");
    let is_same = |text: &String| text.parse().is_ok_and(|c| self::radius(text, c) == radius);
    let numbers = [near, near.next_up(), near.next_down()].map(|c| format!("{c:e}"));
    let found = [plain.clone()].into_iter().chain(numbers).chain(long(radius)).find(is_same);
    found.unwrap_or(plain)
}

/// The reciprocal of a radius from 1 to 1e5 with [`PLACES`] digits after the point, of which at least 18 count.
fn long(radius: f64) -> Option<String> {
    let size = radius.abs();
    if !(1.0..1e5).contains(&size) {
        return None;
    }
    // radius = mantissa 2^-shift
    let shift = 1075 - (size.to_bits() >> 52) as u32;
    let mantissa = u128::from((size.to_bits() & ((1 << 52) - 1)) | 1 << 52);
    let digits = ((10_u128.pow(PLACES as u32) << shift) + mantissa / 2) / mantissa;
    // a zero at the end would not count
    let digits = (digits + u128::from(digits.is_multiple_of(10))).to_string();
    let (first, rest) = digits.split_at(1);
    let sign = if radius < 0.0 { "-" } else { "" };
    Some(format!("{sign}{first}.{rest}e{}", digits.len() as i32 - 1 - PLACES as i32))
}

/// The reciprocal of a decimal number with more digits than an f64 has, correctly rounded; `None` for other numbers and
/// where it is below 1.
fn reciprocal(text: &str) -> Option<f64> {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (sign, mantissa) = match mantissa.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, mantissa.strip_prefix('+').unwrap_or(mantissa)),
    };
    let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let part = part.trim_end_matches('0');
    let digits = format!("{whole}{part}");
    if digits.trim_start_matches('0').len() <= 17 || digits.len() > 38 {
        return None;
    }
    let digits: u128 = digits.parse().ok()?;
    let exponent = exponent.parse::<i64>().ok()?.checked_neg()?.checked_add(part.len() as i64)?;
    let power = 10_u128.checked_pow(u32::try_from(exponent).ok()?).filter(|power| *power >= digits)?;
    // 53 digits after the binary point
    let numerator = (power < 1 << 74).then_some(power << 53)?;
    let bits = (numerator + digits / 2) / digits;
    Some(sign * bits as f64 / (1_u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{Rng, SeedableRng};

    #[test]
    fn every_radius_comes_back() {
        let mut random = ChaCha8Rng::seed_from_u64(6);
        let mut without_number = 0;
        for _ in 0..20_000 {
            let fraction = 1.0 + (random.next_u64() >> 12) as f64 / (1_u64 << 52) as f64;
            let size = fraction * f64::from(1_u32 << (random.next_u64() % 16));
            let wanted = if random.next_u64() % 2 == 0 { size } else { -size };
            let text = curvature(wanted);
            let number: f64 = text.parse().unwrap();
            assert_eq!(radius(&text, number).to_bits(), wanted.to_bits(), "{wanted} {text}");
            without_number += u32::from(1.0 / number != wanted);
        }
        // a curvature has steps of 2^-53 for radii r from 1 to 2, in 1 / c of r^2 2^-53, where those of r are 2^-52: from
        // sqrt(2) on, a fraction of 1 - 2 / r^2 is left out, in the mean (sqrt(2) - 1)^2
        let expected = 20_000.0 * (2.0_f64.sqrt() - 1.0).powi(2);
        assert!((f64::from(without_number) - expected).abs() < 0.1 * expected, "{without_number}");
    }

    #[test]
    fn texts_of_curvatures() {
        assert_eq!(curvature(50.0), "2.000000000000000e-2");
        assert_eq!(curvature(f64::INFINITY), "0.000000000000000e0");
        // 1 / c of the number is 3 up to rounding
        assert_eq!(radius("3.33333333333333333333E-001", 1.0 / 3.0), 3.0);
        for text in ["0.25", "1e400", "-4", "1.2345678901234567890123456789e-2", "00000000000000000000.5"] {
            let number: f64 = text.parse().unwrap();
            let plain = decimal(1.0 / number);
            assert!((radius(text, number) - plain).abs() <= 1e-15 * plain.abs(), "{text}");
        }
        assert_eq!(radius("0.0", 0.0), f64::INFINITY);
    }
}
