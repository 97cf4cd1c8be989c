//! Formatting of values with confidence intervals, as text and JSON.

use crate::terminal;
use rayweave::measure::Estimate;
use serde_json::Value;

/// The value and the half-width of its interval.
pub fn json(estimate: &Estimate) -> Value {
    serde_json::json!({ "value": estimate.value, "half_width": estimate.half_width })
}

/// A value with its half-width, such as `12.34 ± 0.05`. The half-width has at most two digits, and
/// the value has as many decimals.
pub fn text(estimate: &Estimate) -> String {
    let (value, width) = rounded(estimate);
    format!("{value} \u{b1} {width}")
}

/// The value and the half-width, rounded to two digits of the half-width.
pub fn rounded(estimate: &Estimate) -> (String, String) {
    let width = estimate.half_width;
    if !width.is_finite() {
        return (terminal::short(estimate.value), terminal::short(width));
    }
    // a half-width below 1e-10 of the value is not meaningful
    if width <= 1e-10 * estimate.value.abs() {
        return (terminal::short(estimate.value), "0".to_owned());
    }
    // the position of the second digit: one after the power of ten of the first
    let first = format!("{width:e}").split_once('e').and_then(|(_, power)| power.parse::<i32>().ok());
    let place = 1 - first.unwrap_or_default();
    if (0..=12).contains(&place) {
        let digits = place as usize;
        return (format!("{:.digits$}", estimate.value), format!("{width:.digits$}"));
    }
    let step = 10f64.powi(-place);
    let whole = |x: f64| terminal::short((x / step).round() * step);
    (whole(estimate.value), whole(width))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_rounded_to_two_digits_of_their_width() {
        let text = |value: f64, half_width: f64| super::text(&Estimate { value, half_width });
        assert_eq!(text(1234.5678, 0.0456), "1234.568 \u{b1} 0.046");
        assert_eq!(text(1234567.0, 456.0), "1234570 \u{b1} 460");
        assert_eq!(text(-0.25, 0.0), "-0.25 \u{b1} 0");
        assert_eq!(text(48.0, 1e-15), "48 \u{b1} 0");
        assert_eq!(text(1.5e-20, 1e-22), "1.5e-20 \u{b1} 1e-22");
        assert_eq!(text(0.0, 0.0), "0 \u{b1} 0");
    }
}
