//! Errors of measurements.

use rayweave_error::{Classified, ErrorKind};

/// Error of a measurement.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// A region is unbounded.
    #[error(
        "{name} is unbounded in {axes}: it has no volume. Intersect it with a box, or measure the part within one: --within LO HI, in Python within=(lo, hi)."
    )]
    Unbounded {
        /// The region.
        name: String,
        /// The axes along which it is, or may be, unbounded.
        axes: String,
    },
    /// The model is too far away, or too large, for finite moments.
    #[error(
        "{name} extends to {reach:e}: coordinates of measured regions must be at most {most:e}. Is the unit correct?"
    )]
    TooFar {
        /// The region.
        name: String,
        /// Its largest coordinate.
        reach: f64,
        /// The limit.
        most: f64,
    },
    /// The box of the measurement has no volume.
    #[error(
        "the box extends from {lo:?} to {hi:?}: the first corner must be the lower one along x, y and z, and the box must be finite. Are its corners swapped?"
    )]
    BadBox {
        /// Its lower corner.
        lo: [f64; 3],
        /// Its upper corner.
        hi: [f64; 3],
    },
    /// The relative precision is out of range.
    #[error("the precision is {0}: it must be greater than 0 and at most 1. Try 1e-3.")]
    Precision(f64),
    /// The level of confidence is out of range.
    #[error("the confidence is {0}: it must be at least 0.5 and below 1. Try 0.99.")]
    Confidence(f64),
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl Classified for MeasureError {
    fn kind(&self) -> ErrorKind {
        match self {
            MeasureError::Unbounded { .. } | MeasureError::TooFar { .. } => ErrorKind::Solid,
            MeasureError::Cancelled => ErrorKind::Cancelled,
            _ => ErrorKind::Value,
        }
    }
}
