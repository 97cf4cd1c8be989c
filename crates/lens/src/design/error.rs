//! Errors of tolerancing and optimisation.

use crate::analysis::LensAnalysisError;
use crate::design::DesignParameter;
use crate::prescription::PrescriptionError;
use rayweave_error::{Classified, ErrorKind};
use rayweave_model::memory::Shortage;

/// Error of a design task, printed as `problem: reason. Suggestion.`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    /// Text that names no parameter.
    #[error(
        "`{0}` is not a parameter: radius, curvature, thickness, conic, index and r^1 to r^16 take the number of a surface, such as `radius 2`; decentre x, decentre y, tilt x and tilt y take one surface or a range, such as `tilt x 3-4`.{question}", question = hint(.0)
    )]
    NoParameter(String),
    /// A parameter that the prescription does not have.
    #[error("there is no {parameter}: {why}.")]
    Absent {
        /// The parameter.
        parameter: DesignParameter,
        /// The reason.
        why: &'static str,
    },
    /// A number that is out of its range.
    #[error("{what} is {value}: it has to be {range}.")]
    BadNumber {
        /// The name of the number.
        what: String,
        /// The number.
        value: f64,
        /// The admissible range.
        range: &'static str,
    },
    /// An empty list where at least one entry is needed.
    #[error("there is no {0}: at least one is required.")]
    None(&'static str),
    /// The results of the trials do not fit into memory.
    #[error("the results of the trials cannot be kept: {0}. Run fewer trials.")]
    Memory(#[from] Shortage),
    /// The merit function has no finite value at the start.
    #[error(
        "the search cannot begin: goal {goal} of {goals} has no value, because a ray that it needs does not arrive, or because a surface ends before its height."
    )]
    NoStart {
        /// The number of the goal, counted from 1.
        goal: usize,
        /// The number of goals.
        goals: usize,
    },
    /// An error of the prescription.
    #[error(transparent)]
    Prescription(#[from] PrescriptionError),
    /// An error of the image analysis.
    #[error(transparent)]
    Analysis(#[from] LensAnalysisError),
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

/// A question about the American spelling of a parameter, after a space; else empty.
fn hint(name: &str) -> String {
    match name.contains("decenter") {
        true => format!(" Did you mean `{}`?", name.replace("decenter", "decentre")),
        false => String::new(),
    }
}
