//! Errors of infill.

use rayweave_error::{Classified, ErrorKind, short_number};
use rayweave_model::memory::Shortage;

/// Error of infill, printed as `problem: reason. Suggestion.`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InfillError {
    /// The distance between scan lines is not positive and finite.
    #[error(
        "the spacing is {0}: the distance between scan lines must be positive and finite. Is its unit that of the model?"
    )]
    Spacing(f64),
    /// The direction of scan lines is not finite.
    #[error("the angle is {0}: the direction of scan lines must be finite, in degrees.")]
    Angle(f64),
    /// The angle between layers is not finite, or so large that the angle of the last layer is not.
    #[error("the turn is {0:?}: the angles of all layers must be finite, in degrees.")]
    Turn(f64),
    /// The shift of scan lines is not a fraction of the spacing.
    #[error("the phase is {0}: it must be a fraction of the spacing, from 0 to 1.")]
    Phase(f64),
    /// The distance between layers is not positive and finite.
    #[error("the layer height is {0}: the distance between layers must be positive and finite.")]
    LayerHeight(f64),
    /// The height of a layer is not finite, or too large for rays.
    #[error(
        "height {index} of the layers is {value:?}: a height must be finite and at most 1e59 in magnitude."
    )]
    Height {
        /// The number of the layer.
        index: usize,
        /// The height.
        value: f64,
    },
    /// There are too many scan lines.
    #[error(
        "the spacing {spacing:?} results in {} scan lines: at most {most} are filled in one run. Use a larger spacing.",
        short_number(*.lines)
    )]
    TooManyLines {
        /// The distance between scan lines.
        spacing: f64,
        /// The number of scan lines of all layers, or the largest number of one layer.
        lines: f64,
        /// The limit.
        most: u64,
    },
    /// There are too many layers.
    #[error(
        "the layer height {height} results in {} layers: at most {most} are filled in one run. Use a larger layer height.",
        short_number(*.layers)
    )]
    TooManyLayers {
        /// The distance between layers.
        height: f64,
        /// The number of layers.
        layers: f64,
        /// The limit.
        most: u64,
    },
    /// There is nothing to fill.
    #[error("{name} is empty: there is nothing to fill. Do its parts overlap as intended?")]
    Empty {
        /// The region.
        name: String,
    },
    /// The region is unbounded.
    #[error("{name} is unbounded in {axes}: scan lines would never end. Intersect it with a box.")]
    Unbounded {
        /// The region.
        name: String,
        /// The axes along which it is, or may be, unbounded.
        axes: String,
    },
    /// The region is too far from the origin.
    #[error(
        "{name} extends to {reach:e}: coordinates of filled regions must be at most {most:e}. Is the unit correct?"
    )]
    TooFar {
        /// The region.
        name: String,
        /// Its largest coordinate.
        reach: f64,
        /// The limit.
        most: f64,
    },
    /// The traces do not fit into memory.
    #[error("the traces do not fit into memory: {0}. Use a larger spacing, or fill fewer layers at a time.")]
    Memory(#[from] Shortage),
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl Classified for InfillError {
    fn kind(&self) -> ErrorKind {
        match self {
            InfillError::Empty { .. } | InfillError::Unbounded { .. } | InfillError::TooFar { .. } => {
                ErrorKind::Solid
            }
            InfillError::Cancelled => ErrorKind::Cancelled,
            _ => ErrorKind::Value,
        }
    }
}
