//! Why a source cannot be made.

use crate::component::ComponentError;
use rayweave_math::SingularError;

/// Why a source cannot be made; the message reads "problem (why) suggestion?".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SourceError {
    /// A length, a power or another size that is zero, negative, infinite or NaN.
    #[error("{part}: {parameter} is {value} ({parameter} must be finite and greater than 0){}", or_positive(*.value))]
    NotPositive {
        /// What was to be made.
        part: &'static str,
        /// The parameter at fault.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// An angle outside its range.
    #[error("{part}: {parameter} is {value} (it must be greater than 0 and at most {most} degrees)")]
    Angle {
        /// What was to be made.
        part: &'static str,
        /// The parameter at fault.
        parameter: &'static str,
        /// Its value, in degrees.
        value: f64,
        /// The greatest angle allowed, in degrees.
        most: f64,
    },
    /// A source of no rays, or of more than can be numbered.
    #[error("{part}: {count} rays (a source has from 1 to 2^53) how many are wanted?")]
    Count {
        /// What was to be made.
        part: &'static str,
        /// The number of rays.
        count: u64,
    },
    /// Settings that do not fit together.
    #[error("{part}: {problem}")]
    Unfit {
        /// What was to be made.
        part: &'static str,
        /// What does not fit, why, and what may have been meant.
        problem: &'static str,
    },
    /// Columns of different lengths.
    #[error("rays: {column} has {found} rows (the origins have {expected}) is one missing?")]
    Column {
        /// The column at fault.
        column: &'static str,
        /// Its length.
        found: usize,
        /// The number of rays.
        expected: usize,
    },
    /// A ray that is none.
    #[error("rays: {column}[{ray}] is {value} ({why})")]
    BadRay {
        /// The column at fault.
        column: &'static str,
        /// The number of the ray.
        ray: usize,
        /// What stands there.
        value: String,
        /// What should.
        why: &'static str,
    },
    /// A file of rays that is wrong, or cannot be read.
    #[error("{problem}")]
    File {
        /// What is wrong with it, a line for each problem.
        problem: String,
    },
    /// A state of polarisation that is none.
    #[error("stokes is {parameters:?} (i, q, u, v are finite, with i > 0 and q^2 + u^2 + v^2 <= i^2)")]
    Stokes {
        /// The parameters.
        parameters: [f64; 4],
    },
    /// A wavelength that is none.
    #[error("spectrum: wavelength {value} nm (wavelengths are in nanometres, finite and greater than 0)")]
    Wavelength {
        /// The wavelength.
        value: f64,
    },
    /// A weight or a density that is negative, infinite or NaN.
    #[error(
        "spectrum: weight {value} at {wavelength_nm} nm (weights are finite and not negative) is it in decibels?"
    )]
    Weight {
        /// The weight.
        value: f64,
        /// Where it stands.
        wavelength_nm: f64,
    },
    /// A band, or a table, whose wavelengths do not increase.
    #[error("spectrum: {after} nm after {before} nm (wavelengths must increase) are they exchanged?")]
    NotIncreasing {
        /// A wavelength.
        before: f64,
        /// The next one.
        after: f64,
    },
    /// A spectrum without any light.
    #[error(
        "spectrum: it has no light (all its weights are 0, or there are none) is its band far from where the source shines?"
    )]
    Dark,
    /// An aperture that is none.
    #[error(transparent)]
    Aperture(#[from] ComponentError),
    /// A placement that cannot be undone.
    #[error(transparent)]
    Singular(#[from] SingularError),
}

fn or_positive(value: f64) -> String {
    let is_sign_slip = value < 0.0 && value.is_finite();
    if is_sign_slip { format!(" did you mean {}?", -value) } else { String::new() }
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
