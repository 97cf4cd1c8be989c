//! Numbers of documents, as literals or expressions, and their shortest text.

use crate::source::Spanned;

/// A number of a document: a literal, or an arithmetic expression of parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum Number {
    /// A literal.
    Value(f64),
    /// An arithmetic expression; see [`crate::arithmetic`].
    Text(String),
}

impl Default for Number {
    fn default() -> Number {
        Number::Value(0.0)
    }
}

impl From<f64> for Number {
    fn from(value: f64) -> Number {
        Number::Value(value)
    }
}

impl From<f64> for Spanned<Number> {
    fn from(value: f64) -> Spanned<Number> {
        Number::Value(value).into()
    }
}

/// The shortest TOML text that reads back as the same bits: `5`, `0.1`, `1e300`, `-inf`.
pub(crate) fn written(value: f64) -> String {
    // debug formatting gives the shortest text that round-trips, with an exponent where that is easier to read
    let text = match value.is_nan() {
        true => "nan".to_owned(),
        false => format!("{value:?}"),
    };
    match text.strip_suffix(".0") {
        Some(whole) if value != 0.0 || value.is_sign_positive() => whole.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_exact() {
        let cases = [
            (5.0, "5"),
            (0.0, "0"),
            (-0.0, "-0.0"),
            (0.1, "0.1"),
            (1e300, "1e300"),
            (1.0 / 3.0, "0.3333333333333333"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
            (f64::NAN, "nan"),
            (5e-324, "5e-324"),
        ];
        for (value, expected) in cases {
            assert_eq!(written(value), expected);
            let back: f64 = expected.parse().unwrap();
            assert!(back.to_bits() == value.to_bits() || value.is_nan());
        }
    }
}
