//! Errors of light sources.

use crate::component::ComponentError;
use rayweave_error::Message;
use rayweave_math::SingularError;

/// Error of a source that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// A length, a power or another size that is zero, negative, infinite or NaN.
    #[error("{parameter} of the {part} is {value}: it must be finite and greater than 0.{}", or_positive(*.value))]
    NotPositive {
        /// The source.
        part: &'static str,
        /// The parameter at fault.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// An angle outside its range.
    #[error("{parameter} of the {part} is {value}: it must be greater than 0 and at most {most} degrees.")]
    Angle {
        /// The source.
        part: &'static str,
        /// The parameter at fault.
        parameter: &'static str,
        /// Its value, in degrees.
        value: f64,
        /// The greatest angle allowed, in degrees.
        most: f64,
    },
    /// A source without rays, or with more than can be numbered.
    #[error("{part} has {count} rays: a source needs from 1 to 2^53 rays.")]
    Count {
        /// The source.
        part: &'static str,
        /// The number of rays.
        count: u64,
    },
    /// Inconsistent settings.
    #[error("{0}")]
    Inconsistent(Message),
    /// Columns of different lengths.
    #[error("column {column} of the rays has {found} rows: the origins have {expected}.")]
    Column {
        /// The column at fault.
        column: &'static str,
        /// Its length.
        found: usize,
        /// The number of rays.
        expected: usize,
    },
    /// An invalid ray.
    #[error("{column}[{ray}] of the rays is {value}: {why}.")]
    BadRay {
        /// The column at fault.
        column: &'static str,
        /// The number of the ray.
        ray: usize,
        /// The value.
        value: String,
        /// The reason why it is invalid.
        why: &'static str,
    },
    /// A ray file that is invalid, or cannot be read.
    #[error("{problem}")]
    File {
        /// The problems, one per line.
        problem: String,
    },
    /// Invalid Stokes parameters.
    #[error("stokes is {parameters:?}: i, q, u, v must be finite, with i > 0 and q^2 + u^2 + v^2 <= i^2.")]
    Stokes {
        /// The parameters.
        parameters: [f64; 4],
    },
    /// An invalid wavelength.
    #[error("wavelength of the spectrum is {value} nm: wavelengths must be finite and greater than 0.")]
    Wavelength {
        /// The wavelength.
        value: f64,
    },
    /// A weight or a density that is negative, infinite or NaN.
    #[error(
        "weight of the spectrum is {value} at {wavelength_nm} nm: weights must be finite and not negative. Is it in decibels?"
    )]
    Weight {
        /// The weight.
        value: f64,
        /// Its wavelength.
        wavelength_nm: f64,
    },
    /// A band, or a table, whose wavelengths do not increase.
    #[error(
        "wavelength {after} nm of the spectrum follows {before} nm: wavelengths must increase. Are they swapped?"
    )]
    NotIncreasing {
        /// A wavelength.
        before: f64,
        /// The next one.
        after: f64,
    },
    /// A spectrum without power.
    #[error(
        "spectrum has no power: all its weights are 0, or there are none. Is its band far from the wavelengths of the source?"
    )]
    NoPower,
    /// An invalid aperture.
    #[error(transparent)]
    Aperture(#[from] ComponentError),
    /// A singular placement.
    #[error(transparent)]
    Singular(#[from] SingularError),
}

fn or_positive(value: f64) -> String {
    let is_wrong_sign = value < 0.0 && value.is_finite();
    if is_wrong_sign { format!(" Did you mean {}?", -value) } else { String::new() }
}

/// The value, if it is finite and greater than 0.
pub(super) fn positive(part: &'static str, parameter: &'static str, value: f64) -> Result<f64, SourceError> {
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(SourceError::NotPositive { part, parameter, value }),
    }
}

/// The angle in degrees, if it is greater than 0 and at most `most`.
pub(super) fn angle(
    part: &'static str,
    parameter: &'static str,
    value: f64,
    most: f64,
) -> Result<f64, SourceError> {
    match value > 0.0 && value <= most {
        true => Ok(value),
        false => Err(SourceError::Angle { part, parameter, value, most }),
    }
}
