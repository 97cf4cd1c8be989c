//! What can be wrong with a curve.

/// Why a curve could not be made, or not be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// A number that a curve is made from is NaN or infinite, or a vector has no direction, or the like.
    #[error("{what} ({why})")]
    BadInput {
        /// The name of the argument.
        what: &'static str,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A row of an array of knots cannot be used.
    #[error("{what}[{index}] ({why})")]
    BadKnot {
        /// The name of the array.
        what: &'static str,
        /// The index of the first bad row.
        index: usize,
        /// What is wrong with it.
        why: &'static str,
    },
    /// The window is no bounded stretch of time.
    #[error("the window from {t0} to {t1} (both ends must be finite, the first before the last)")]
    Window {
        /// The first time.
        t0: f64,
        /// The last time.
        t1: f64,
    },
    /// The window reaches beyond the curve.
    #[error("the window from {t0} to {t1} (the curve is defined from {first} to {last} only)")]
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
    #[error("the curve at t = {t} (its position or velocity is NaN or infinite)")]
    NotFinite {
        /// When.
        t: f64,
    },
    /// The acceleration bound is NaN, infinite or negative.
    #[error(
        "the acceleration bound between t = {t0} and t = {t1} is {bound} (it must be finite and at least 0)"
    )]
    BadBound {
        /// The first time asked about.
        t0: f64,
        /// The last time asked about.
        t1: f64,
        /// The bound given.
        bound: f64,
    },
    /// The curve moves more than its acceleration bound allows.
    #[error(
        "the curve between t = {t0} and t = {t1} (its positions or velocities differ by more than its \
         acceleration bound {bound} allows) is the velocity the derivative of the position?"
    )]
    BoundBroken {
        /// One time.
        t0: f64,
        /// The other.
        t1: f64,
        /// The bound given.
        bound: f64,
    },
    /// Isolation gave up.
    #[error(
        "the curve from t = {t0} to t = {t1} (more than {pieces} pieces of it had to be looked at) is its acceleration \
         bound far too large, or the window too long for a curve that keeps close to a surface?"
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
