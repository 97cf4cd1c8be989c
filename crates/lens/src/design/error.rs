//! What can be wrong with a task of design.

use crate::analysis::AnalysisError;
use crate::design::Parameter;
use crate::prescription::PrescriptionError;
use rayweave_error::{Classified, ErrorKind};

/// Error of a design task, printed as `problem: reason. Suggestion.`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    /// Text that names no parameter.
    #[error(
        "`{0}` is no parameter: radius, curvature, thickness, conic, index, r^1 to r^16 have the number of a surface, as `radius 2`; decentre x, decentre y, tilt x, tilt y that of one or of several, as `tilt x 3-4`."
    )]
    NoParameter(String),
    /// A parameter that the prescription does not have.
    #[error("there is no {parameter}: {why}.")]
    Absent {
        /// The parameter.
        parameter: Parameter,
        /// Why it is not there.
        why: &'static str,
    },
    /// A number that is out of its range.
    #[error("{what} is {value}: it has to be {range}.")]
    BadNumber {
        /// What the number is.
        what: String,
        /// The number.
        value: f64,
        /// Which numbers are possible.
        range: &'static str,
    },
    /// There is nothing to do.
    #[error("there is no {0}: at least one is needed.")]
    None(&'static str),
    /// The search cannot begin.
    #[error("the search cannot begin: {0}")]
    NoStart(String),
    /// The prescription itself, as it is.
    #[error(transparent)]
    Prescription(#[from] PrescriptionError),
    /// Its image.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
}

impl Classified for DesignError {
    fn kind(&self) -> ErrorKind {
        match self {
            DesignError::Prescription(error) => error.kind(),
            DesignError::Analysis(error) => error.kind(),
            _ => ErrorKind::Optics,
        }
    }
}
