//! Errors of root-rays: times that are NaN, infinite or not increasing, and empty windows.

use rayweave_error::{Classified, ErrorKind};

/// Invalid input of a root-ray.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RootRayError {
    /// A root's time is NaN.
    #[error("root {index} is NaN: root times must be finite numbers.")]
    Nan {
        /// Position in the list of roots, from 0.
        index: usize,
    },
    /// A root's time is infinite.
    #[error(
        "root {index} is {t}: root times must be finite. Give the side at -inf as the start side instead."
    )]
    Infinite {
        /// Position in the list of roots, from 0.
        index: usize,
        /// The infinite time.
        t: f64,
    },
    /// A root's time is not greater than the one before it.
    #[error(
        "root {index} is {t}, not greater than {previous} before it: root times must be strictly increasing."
    )]
    NotIncreasing {
        /// Position in the list of roots, from 0, of the later entry.
        index: usize,
        /// The time before it.
        previous: f64,
        /// The offending time.
        t: f64,
    },
    /// A query time is NaN.
    #[error("the query time is NaN: it must be a number or an infinity.")]
    NanTime,
    /// An end of a window is NaN.
    #[error("the window ({t_min}, {t_max}) has a NaN end: use -inf or inf for an open end.")]
    NanWindow {
        /// Start of the window.
        t_min: f64,
        /// End of the window.
        t_max: f64,
    },
    /// A window that is empty or reversed.
    #[error("the window ({t_min}, {t_max}) is empty: t_min must be less than t_max.")]
    EmptyWindow {
        /// Start of the window.
        t_min: f64,
        /// End of the window.
        t_max: f64,
    },
    /// A sign that is neither +1 (outside) nor -1 (inside).
    #[error("the sign is {sign}: it must be +1 (starts outside) or -1 (starts inside).")]
    Sign {
        /// The sign found.
        sign: i64,
    },
}

impl Classified for RootRayError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

/// One finding of [`validate_times`](crate::validate_times). Indices count from 0 and name the later entry of a pair.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// A time is NaN.
    #[error("root {index} is NaN")]
    Nan {
        /// Position in the list.
        index: usize,
    },
    /// A time is infinite.
    #[error("root {index} is {t}, not finite")]
    Infinite {
        /// Position in the list.
        index: usize,
        /// The infinite time.
        t: f64,
    },
    /// A time is not greater than the last number before it.
    #[error("root {index} is {t}, not greater than {previous} before it")]
    NotIncreasing {
        /// Position in the list.
        index: usize,
        /// The last number before it.
        previous: f64,
        /// The offending time.
        t: f64,
    },
    /// Two finite neighbours in order, but closer than [`min_sep`](crate::min_sep).
    #[error("root {index} is {t}, closer than {min_sep:e} to {previous} before it")]
    TooClose {
        /// Position in the list.
        index: usize,
        /// The time before it.
        previous: f64,
        /// The time too close to it.
        t: f64,
        /// The least separation of the two.
        min_sep: f64,
    },
}
