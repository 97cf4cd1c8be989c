//! Decimal text of numbers.

/// A number rounded to a resolution: as many digits as the resolution needs, no trailing zeros, a power of ten where that is
/// shorter (`2.5×10^-9`). Values below half of the resolution give `0`.
///
/// ```
/// use rayweave_math::format_to_resolution;
///
/// assert_eq!(format_to_resolution(1.0 / 3.0, 1e-3), "0.3333");
/// assert_eq!(format_to_resolution(0.1 + 0.2, 1e-3), "0.3");
/// ```
pub fn format_to_resolution(value: f64, resolution: f64) -> String {
    if value.abs() < 0.5 * resolution {
        return "0".to_owned();
    }
    let size = libm::log10(value.abs().max(resolution));
    let digits = (size - libm::floor(libm::log10(resolution))).ceil().clamp(1.0, 17.0);
    // the exponential form is rounded to a number of digits
    let exponent_form = format!("{:.*e}", digits as usize, value);
    let rounded: f64 = exponent_form.parse().unwrap_or(value);
    // next to the largest number rounding up overflows
    let rounded = if rounded.is_finite() { rounded } else { value };
    let plain = rounded.to_string();
    let with_exponent = format!("{rounded:e}").replace('e', "\u{d7}10^");
    if plain.chars().count() <= with_exponent.chars().count() + 1 { plain } else { with_exponent }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_they_need() {
        let cases = [
            (0.1 + 0.2, 1e-3, "0.3"),
            (1.0 / 3.0, 1e-3, "0.3333"),
            (-2.0, 0.01, "-2"),
            (-0.0, 0.01, "0"),
            (1e-17, 0.01, "0"),
            (100_000_000.25, 0.1, "100000000.25"),
            (1e8, 1e3, "1\u{d7}10^8"),
            (2.5e-9, 1e-10, "2.5\u{d7}10^-9"),
            (123_456.0, 1000.0, "123500"),
            (f64::MAX, 1e306, "1.7976931348623157\u{d7}10^308"),
        ];
        for (value, resolution, text) in cases {
            assert_eq!(format_to_resolution(value, resolution), text);
        }
    }
}
