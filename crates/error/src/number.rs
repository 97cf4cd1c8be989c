//! Numbers in messages.

/// A number with four significant digits, without trailing zeros: `2`, `0.0625`, `1.235e15`.
#[must_use]
pub fn short_number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) || !rounded.is_finite() {
        true => format!("{rounded}"),
        false => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::short_number;

    #[test]
    fn numbers_are_short_and_plain() {
        let cases = [
            (2.0, "2"),
            (0.0, "0"),
            (-0.062_5, "-0.0625"),
            (1.0 / 3.0, "0.3333"),
            (1e15, "1e15"),
            (1.234_56e15, "1.235e15"),
            (123_456.0, "123500"),
            (9.999_9e5, "1e6"),
            (1e-7, "1e-7"),
            (f64::INFINITY, "inf"),
            (f64::MAX, "1.798e308"),
        ];
        for (value, text) in cases {
            assert_eq!(short_number(value), text);
        }
    }
}
