//! Errors of image analysis.

use crate::prescription::PrescriptionError;
use rayweave_error::{Classified, ErrorKind};
use rayweave_math::round_to_digits;
use rayweave_optics::OpticsError;

/// Error of an analysis, printed as `problem: reason. Suggestion.`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LensAnalysisError {
    /// An invalid prescription.
    #[error(transparent)]
    Prescription(#[from] PrescriptionError),
    /// An error of ray tracing.
    #[error(transparent)]
    Optics(#[from] OpticsError),
    /// No sheet has this name.
    #[error("there is no sheet `{0}`: the image has to be a sheet of the system.")]
    NoSheet(String),
    /// A required ray does not arrive.
    #[error(
        "the {ray} ray of field {field} does not reach the image: it is vignetted, misses a surface or takes a different path."
    )]
    Stopped {
        /// The name of the ray.
        ray: &'static str,
        /// The number of the field, from 0.
        field: usize,
    },
    /// Rays through the paraxial entrance pupil of a field that miss the centre of the stop by far.
    #[error(
        "the real entrance pupil of field {field} is {} semi-diameters away from the paraxial one: rays through the latter pass only a part of the stop. Aim the rays at the stop.",
        round_to_digits(*off, 3)
    )]
    Unaimed {
        /// The number of the field, from 0.
        field: usize,
        /// The distance of the chief ray from the centre of the paraxial entrance pupil, in units of its
        /// semi-diameter.
        off: f64,
    },
    /// Too few points for a fit.
    #[error(
        "{points} points do not determine {terms} terms: a fit needs at least one point per term. Use fewer terms."
    )]
    TooFew {
        /// The number of points.
        points: usize,
        /// The number of terms.
        terms: usize,
    },
}

impl Classified for LensAnalysisError {
    fn kind(&self) -> ErrorKind {
        match self {
            LensAnalysisError::Prescription(error) => error.kind(),
            LensAnalysisError::Optics(error) => error.kind(),
            _ => ErrorKind::Optics,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_those_of_the_cause() {
        let cancelled = PrescriptionError::from(OpticsError::Cancelled);
        assert_eq!(cancelled.kind(), ErrorKind::Cancelled);
        assert_eq!(LensAnalysisError::from(cancelled).kind(), ErrorKind::Cancelled);
        assert_eq!(LensAnalysisError::NoSheet("image".to_owned()).kind(), ErrorKind::Optics);
    }
}
