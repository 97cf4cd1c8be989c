//! Errors of components.

use rayweave_error::Message;
use rayweave_math::{SingularError, round_to_digits};
use rayweave_shape::primitive::ShapeError;

/// Error of a component that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ComponentError {
    /// A size that is zero, negative, infinite or NaN.
    #[error("{parameter} of the {part} is {value}: it must be finite and greater than 0.{}", or_positive(*.value))]
    NotPositive {
        /// The component.
        part: &'static str,
        /// The parameter at fault.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// A size that is negative, infinite or NaN.
    #[error("{parameter} of the {part} is {value}: it must be finite and at least 0.{}", or_positive(*.value))]
    Negative {
        /// The component.
        part: &'static str,
        /// The parameter at fault.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// A number that is NaN or infinite.
    #[error("{parameter} of the {part} is {value}: it must be finite.")]
    NotFinite {
        /// The component.
        part: &'static str,
        /// The parameter at fault.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// A radius of curvature that is zero or NaN.
    #[error(
        "{parameter} of the {part} is {value}: a radius of curvature is a number other than 0. Use inf for a plane."
    )]
    Radius {
        /// The component.
        part: &'static str,
        /// The parameter at fault.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// A number outside its range.
    #[error("{parameter} of the {part} is {value}: it must be greater than {low} and less than {high}.{}", or_degrees(*.value, *.high))]
    OutOfRange {
        /// The component.
        part: &'static str,
        /// The parameter at fault.
        parameter: String,
        /// Its value.
        value: f64,
        /// The lower end of the range, excluded.
        low: f64,
        /// The upper end of the range, excluded.
        high: f64,
    },
    /// An aperture that extends beyond the end of a surface.
    #[error(
        "the aperture of the {part} extends {} from the axis: the {surface} surface ends {} from it. \
         Is a diameter given as a radius?",
        round_to_digits(*reach, 6), round_to_digits(*limit, 6)
    )]
    ApertureTooLarge {
        /// The component.
        part: &'static str,
        /// The surface that ends.
        surface: &'static str,
        /// The distance of the farthest point of the aperture from the axis.
        reach: f64,
        /// The distance at which the surface ends.
        limit: f64,
    },
    /// Two surfaces that cross inside the aperture, so that there is no material between them.
    #[error(
        "surfaces {first} and {second} of the {part} cross inside the aperture, {} from the axis: the aperture \
         extends to {}. Increase the thickness or decrease the aperture.",
        round_to_digits(*height, 6), round_to_digits(*reach, 6)
    )]
    SurfacesCross {
        /// The component.
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
    /// Lists of inconsistent lengths.
    #[error(
        "{part} has {radii} radii and {thicknesses} thicknesses: it needs one radius more than thicknesses, and at least 2 radii."
    )]
    Counts {
        /// The component.
        part: &'static str,
        /// The number of radii.
        radii: usize,
        /// The number of thicknesses.
        thicknesses: usize,
    },
    /// Inconsistent sizes.
    #[error("{0}")]
    Inconsistent(Message),
    /// A size out of the range of the primitives.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A singular map.
    #[error(transparent)]
    Singular(#[from] SingularError),
}

fn or_positive(value: f64) -> String {
    let is_wrong_sign = value < 0.0 && value.is_finite();
    if is_wrong_sign { format!(" Did you mean {}?", -value) } else { String::new() }
}

fn or_degrees(value: f64, high: f64) -> &'static str {
    if value > high { " Is it in degrees?" } else { "" }
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

/// An error about inconsistent sizes, unless they are consistent.
pub(super) fn consistent(
    is_consistent: bool,
    message: impl FnOnce() -> Message,
) -> Result<(), ComponentError> {
    if is_consistent { Ok(()) } else { Err(ComponentError::Inconsistent(message())) }
}
