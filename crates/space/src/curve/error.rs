//! Errors of curves.

/// Error: a curve cannot be constructed or traced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// An argument of a constructor is invalid.
    #[error("{what} is invalid: {why}.")]
    InvalidArgument {
        /// The name of the argument.
        what: &'static str,
        /// The reason.
        why: &'static str,
    },
    /// A row of an array of knots is invalid.
    #[error("{what}[{index}] is invalid: {why}.")]
    InvalidKnot {
        /// The name of the array.
        what: &'static str,
        /// The index of the first invalid row.
        index: usize,
        /// The reason.
        why: &'static str,
    },
    /// The time window is not finite or not increasing.
    #[error(
        "the window from {t0} to {t1} is invalid: both ends must be finite, and the first before the last."
    )]
    Window {
        /// The first time.
        t0: f64,
        /// The last time.
        t1: f64,
    },
    /// The time window exceeds the domain of the curve.
    #[error("the window from {t0} to {t1} is out of range: the curve is defined from {first} to {last}.")]
    OutsideDomain {
        /// The first time of the window.
        t0: f64,
        /// The last time of the window.
        t1: f64,
        /// The first time of the curve.
        first: f64,
        /// The last time of the curve.
        last: f64,
    },
    /// Position or velocity is NaN or infinite.
    #[error("the curve at t = {t} is invalid: its position or velocity is NaN or infinite.")]
    NotFinite {
        /// The time.
        t: f64,
    },
    /// The acceleration bound is NaN, infinite or negative.
    #[error(
        "the acceleration bound between t = {t0} and t = {t1} is {bound}: it must be finite and nonnegative."
    )]
    InvalidBound {
        /// The first time.
        t0: f64,
        /// The last time.
        t1: f64,
        /// The returned bound.
        bound: f64,
    },
    /// The curve violates its acceleration bound.
    #[error(
        "the curve between t = {t0} and t = {t1} is inconsistent: its positions or velocities differ by more than its \
         acceleration bound {bound} allows. Check that the velocity is the derivative of the position."
    )]
    BoundViolated {
        /// One time.
        t0: f64,
        /// The other.
        t1: f64,
        /// The returned bound.
        bound: f64,
    },
    /// Isolation exceeded its limit of work.
    #[error(
        "the curve from t = {t0} to t = {t1} takes too much work: more than {pieces} subdivisions are needed. Tighten its \
         acceleration bound, or shorten the window if the curve runs close to a surface."
    )]
    TooMuchWork {
        /// The first time of the window.
        t0: f64,
        /// The last time of the window.
        t1: f64,
        /// The number of pieces examined.
        pieces: usize,
    },
}
