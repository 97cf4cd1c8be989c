//! Checks of the numbers of gradients.

use crate::error::OpticsError;
use rayweave_error::Message;

/// An error of an invalid gradient.
pub(super) fn bad(problem: String, reason: impl Into<String>) -> OpticsError {
    OpticsError::BadGradient(Message::new(problem, reason))
}

/// The coefficients, if there is at least one and all are finite.
pub(super) fn finite(what: &str, values: &[f64]) -> Result<Vec<f64>, OpticsError> {
    if values.is_empty() {
        return Err(bad(format!("gradient has no {what}"), "the first is the factor at the origin"));
    }
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(bad(format!("one of the {what} of the gradient is {value}"), "it must be finite")),
        None => Ok(values.to_vec()),
    }
}

/// Checks that a length is finite and greater than 0.
pub(super) fn positive(what: &str, value: f64) -> Result<(), OpticsError> {
    let is_good = value > 0.0 && value.is_finite();
    let problem = || format!("{what} of the gradient is {value}");
    if is_good { Ok(()) } else { Err(bad(problem(), "it must be finite and greater than 0")) }
}
