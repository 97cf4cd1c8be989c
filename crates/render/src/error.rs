//! What can be wrong with a request for a picture.

use crate::limits::{LARGEST_SIDE, MOST_SAMPLES};
use rayweave_error::{Classified, ErrorKind};

/// Why a camera cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    #[error("the camera's {what} is not finite: a camera stands somewhere.")]
    NotFinite {
        /// Which argument.
        what: &'static str,
    },
    /// Nothing says where the camera looks.
    #[error(
        "the camera's position and target are the same point: nothing says where it looks. Move one of them."
    )]
    NoDirection,
    /// The field of view is out of range.
    #[error("the field of view is {degrees} degrees: it must be between 0 and 180, both excluded.")]
    FieldOfView {
        /// What was given.
        degrees: f64,
    },
    /// The height of an orthographic picture is out of range.
    #[error("the height of the picture is {height}: it must be greater than 0.")]
    Height {
        /// What was given.
        height: f64,
    },
}

impl Classified for CameraError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The token of the run was used.
    #[error("cancelled")]
    Cancelled,
    /// The picture has no pixels, or too many.
    #[error(
        "a picture of {width} x {height} pixels cannot be drawn: each side must be from 1 to {} pixels.",
        LARGEST_SIDE
    )]
    Size {
        /// The width that was asked for.
        width: u32,
        /// The height that was asked for.
        height: u32,
    },
    /// The number of samples is out of range.
    #[error("{samples} samples along each side of a pixel: the number must be from 1 to {}.", MOST_SAMPLES)]
    Samples {
        /// What was asked for.
        samples: u32,
    },
    /// A number of the settings is out of range.
    #[error("the {what} is {value}: it must be from {lo} to {hi}.")]
    Range {
        /// Which setting.
        what: &'static str,
        /// What was given.
        value: f64,
        /// The least legal value.
        lo: f64,
        /// The greatest legal value.
        hi: f64,
    },
    /// A light cannot shine.
    #[error("light {index} has {problem}")]
    Light {
        /// The number of the light, from 0.
        index: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
}

impl Classified for RenderError {
    fn kind(&self) -> ErrorKind {
        match self {
            RenderError::Cancelled => ErrorKind::Cancelled,
            _ => ErrorKind::Value,
        }
    }
}
