//! Errors of sections.

use rayweave_error::{Classified, ErrorKind};
use rayweave_math::Vec3;
use rayweave_model::memory::Shortage;

/// Error of a section.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SectionError {
    /// The axes span no plane.
    #[error("the axes {across} and {up} span no plane: they must be finite and not parallel.")]
    Axes {
        /// The first axis.
        across: Vec3,
        /// The second axis.
        up: Vec3,
    },
    /// The window has no area.
    #[error("the window from {lo:?} to {hi:?} has no area: its ends must be finite, the lower one first.")]
    Window {
        /// The lower left corner.
        lo: [f64; 2],
        /// The upper right corner.
        hi: [f64; 2],
    },
    /// The tolerance is not positive and finite.
    #[error("the tolerance is {tolerance}: it must be positive and finite.")]
    Tolerance {
        /// The tolerance.
        tolerance: f64,
    },
    /// The tolerance is below the accuracy of contours.
    #[error("the tolerance is {tolerance:e}: for a section of this size it must be at least {least:.1e}.")]
    TooFine {
        /// The tolerance.
        tolerance: f64,
        /// The smallest one for the size of the section.
        least: f64,
    },
    /// Too few or too many columns.
    #[error("the number of columns is {columns}: it must be from 2 to 65536.")]
    Columns {
        /// The number of columns.
        columns: u32,
    },
    /// The section is too complex for its tolerance.
    #[error(
        "the section needs more than {limit} scan lines: its lines are too numerous for the tolerance. \
         Use a larger tolerance, or cut a smaller box (--within LO HI, in Python within=(lo, hi))."
    )]
    TooManyScanLines {
        /// The largest number of scan lines.
        limit: usize,
    },
    /// The section does not fit into memory.
    #[error("the section does not fit into memory: {0}. Use fewer columns or planes, or a larger tolerance.")]
    Memory(#[from] Shortage),
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl Classified for SectionError {
    fn kind(&self) -> ErrorKind {
        match self {
            SectionError::Cancelled => ErrorKind::Cancelled,
            _ => ErrorKind::Value,
        }
    }
}
