//! Why a model cannot be measured.

/// Why a model cannot be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// There is no end to what is to be measured.
    #[error("{name} is unbounded in {axes} (it has no volume) measure it within a box?")]
    Unbounded {
        /// What was to be measured.
        name: String,
        /// The axes along which it is unbounded, or may be for all that is known.
        axes: String,
    },
    /// The model is too far away, or too large, for its moments to be numbers.
    #[error(
        "{name} reaches to {reach:e} (coordinates of what is measured are at most {most:e}) is the unit right?"
    )]
    TooFar {
        /// What was to be measured.
        name: String,
        /// Its largest coordinate.
        reach: f64,
        /// The limit.
        most: f64,
    },
    /// The box to measure within is not one.
    #[error(
        "the box reaches from {lo:?} to {hi:?} (it must be finite, and hi greater than lo) are its corners swapped?"
    )]
    BadBox {
        /// Its lower corner.
        lo: [f64; 3],
        /// Its upper corner.
        hi: [f64; 3],
    },
    /// A number that is no relative precision.
    #[error("the precision is {0} (it must be greater than 0 and at most 1) try 1e-3?")]
    Precision(f64),
    /// A number that is no level of confidence.
    #[error("the confidence is {0} (it must be between 0.5 and 1, and below 1) try 0.99?")]
    Confidence(f64),
    /// Somebody asked the run to stop.
    #[error("cancelled")]
    Cancelled,
}
