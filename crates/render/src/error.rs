//! Errors of cameras and rendering.

use crate::limits::{MAX_SAMPLES, MAX_SIDE};
use rayweave_error::{Classified, ErrorKind, short_number};

/// Error of a camera.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    #[error("the camera's {what} is not finite: its coordinates must be finite.")]
    NotFinite {
        /// The argument.
        what: &'static str,
    },
    /// The camera has no line of sight: position and target coincide.
    #[error(
        "the camera's position and target are the same point: the line of sight is undefined. Move one of them."
    )]
    NoDirection,
    /// The field of view is out of range.
    #[error("the field of view is {degrees} degrees: it must be between 0 and 180, both excluded.")]
    FieldOfView {
        /// The given value.
        degrees: f64,
    },
    /// The height of an orthographic picture is out of range.
    #[error("the height of the picture is {height}: it must be greater than 0.")]
    Height {
        /// The given value.
        height: f64,
    },
}

impl Classified for CameraError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

/// Error of rendering.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// The picture has no pixels, or too many.
    #[error(
        "a picture of {width} x {height} pixels cannot be drawn: each side must be from 1 to {} pixels.",
        MAX_SIDE
    )]
    Size {
        /// The requested width.
        width: u32,
        /// The requested height.
        height: u32,
    },
    /// The picture does not fit into memory.
    #[error(
        "a picture of {width} x {height} pixels cannot be drawn: it takes up to {needed} MiB of memory, and there are {available}. \
         Draw a smaller one."
    )]
    Memory {
        /// The requested width.
        width: u32,
        /// The requested height.
        height: u32,
        /// The memory that it may take, in MiB.
        needed: u64,
        /// The available memory, in MiB.
        available: u64,
    },
    /// The number of samples is out of range.
    #[error("{samples} samples along each side of a pixel: the number must be from 1 to {}.", MAX_SAMPLES)]
    Samples {
        /// The requested number.
        samples: u32,
    },
    /// The camera is too far from the model: the picture would be empty.
    #[error(
        "the camera is too far from the model: at a distance of {}, points are accurate to {}, and the model is {} thick. Move the \
         camera closer to the model, and keep the model close to the origin of the coordinates.",
        short_number(*.distance),
        short_number(*.accuracy),
        short_number(*.size)
    )]
    TooFar {
        /// The distance from the camera to the point of its rays that is closest to the model.
        distance: f64,
        /// The tolerance there.
        accuracy: f64,
        /// The shortest side of the box around the model.
        size: f64,
    },
    /// A number of the settings is out of range.
    #[error("the {what} is {value}: it must be from {lo} to {hi}.")]
    Range {
        /// The setting.
        what: &'static str,
        /// The given value.
        value: f64,
        /// The least admissible value.
        lo: f64,
        /// The greatest admissible value.
        hi: f64,
    },
    /// A light with an invalid property.
    #[error("light {index} has {problem}")]
    Light {
        /// The number of the light, from 0.
        index: usize,
        /// The problem.
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
