//! Why a component cannot be made.

use rayweave_math::SingularError;
use rayweave_shape::primitive::ShapeError;

/// Why a component cannot be made; the message reads "problem (why) suggestion?".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ComponentError {
    /// A length or another size that is zero, negative, infinite or NaN.
    #[error("{part}: {parameter} is {value} ({parameter} must be finite and greater than 0){}", or_positive(*.value))]
    NotPositive {
        /// What was to be made.
        part: &'static str,
        /// The parameter at fault.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// A number that is NaN or infinite, where any finite one will do.
    #[error("{part}: {parameter} is {value} ({parameter} must be finite)")]
    NotFinite {
        /// What was to be made.
        part: &'static str,
        /// The parameter at fault.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// A radius of curvature that is zero or NaN.
    #[error(
        "{part}: {parameter} is {value} (a radius of curvature is a number other than 0) did you mean inf, a plane?"
    )]
    Radius {
        /// What was to be made.
        part: &'static str,
        /// The parameter at fault.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// A number outside its range.
    #[error("{part}: {parameter} is {value} (it must be greater than {low} and less than {high}){}", or_degrees(*.value, *.high))]
    OutOfRange {
        /// What was to be made.
        part: &'static str,
        /// The parameter at fault.
        parameter: String,
        /// Its value.
        value: f64,
        /// The end of the range below, itself excluded.
        low: f64,
        /// The end of the range above, itself excluded.
        high: f64,
    },
    /// An aperture that reaches beyond where a surface ends.
    #[error(
        "{part}: the aperture reaches {} from the axis (the {surface} surface ends {} from it) is a diameter \
         given for a radius?",
        short(*reach), short(*limit)
    )]
    ApertureTooLarge {
        /// What was to be made.
        part: &'static str,
        /// The surface that ends.
        surface: &'static str,
        /// The distance of the farthest point of the aperture from the axis.
        reach: f64,
        /// The distance at which the surface ends.
        limit: f64,
    },
    /// Two surfaces that cross where there should be material between them.
    #[error(
        "{part}: the {first} and the {second} surface cross inside the aperture, {} from the axis (the aperture \
         reaches {}) is the thickness too small or the aperture too large?",
        short(*height), short(*reach)
    )]
    SurfacesCross {
        /// What was to be made.
        part: &'static str,
        /// The surface in front.
        first: String,
        /// The surface behind it.
        second: String,
        /// The distance from the axis at which they cross.
        height: f64,
        /// The distance of the farthest point of the aperture from the axis.
        reach: f64,
    },
    /// Lists whose lengths do not fit.
    #[error(
        "{part}: {radii} radii and {thicknesses} thicknesses (there is one radius more than thicknesses, at least 2) is one missing?"
    )]
    Counts {
        /// What was to be made.
        part: &'static str,
        /// The number of radii.
        radii: usize,
        /// The number of thicknesses.
        thicknesses: usize,
    },
    /// Sizes that do not fit together.
    #[error("{part}: {problem}")]
    Unfit {
        /// What was to be made.
        part: &'static str,
        /// What does not fit, why, and what may have been meant.
        problem: String,
    },
    /// A size beyond what can be computed with.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A map that cannot be undone.
    #[error(transparent)]
    Singular(#[from] SingularError),
}

/// A computed number as messages tell it, to six digits.
pub(crate) fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

fn or_positive(value: f64) -> String {
    let is_sign_slip = value < 0.0 && value.is_finite();
    if is_sign_slip { format!(" did you mean {}?", -value) } else { String::new() }
}

fn or_degrees(value: f64, high: f64) -> &'static str {
    if value > high { " is it in degrees?" } else { "" }
}

/// The value, if it is finite and greater than 0.
pub(super) fn positive(
    part: &'static str,
    parameter: impl Into<String>,
    value: f64,
) -> Result<f64, ComponentError> {
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(ComponentError::NotPositive { part, parameter: parameter.into(), value }),
    }
}

/// The value, if it is finite.
pub(super) fn finite(
    part: &'static str,
    parameter: impl Into<String>,
    value: f64,
) -> Result<f64, ComponentError> {
    match value.is_finite() {
        true => Ok(value),
        false => Err(ComponentError::NotFinite { part, parameter: parameter.into(), value }),
    }
}

/// The value, if it lies between two others.
pub(super) fn between(
    part: &'static str,
    parameter: impl Into<String>,
    value: f64,
    (low, high): (f64, f64),
) -> Result<f64, ComponentError> {
    match value > low && value < high {
        true => Ok(value),
        false => Err(ComponentError::OutOfRange { part, parameter: parameter.into(), value, low, high }),
    }
}

/// An error about sizes that do not fit together, unless they do.
pub(super) fn fit(
    part: &'static str,
    fits: bool,
    problem: impl FnOnce() -> String,
) -> Result<(), ComponentError> {
    if fits { Ok(()) } else { Err(ComponentError::Unfit { part, problem: problem() }) }
}
