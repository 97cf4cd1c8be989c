//! Why a region cannot be filled.

/// Why a region cannot be filled, as "problem (why) suggestion?".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InfillError {
    /// The distance of scan lines is no positive number.
    #[error(
        "the spacing is {0} (the distance of scan lines is greater than 0 and finite) is its unit that of the model?"
    )]
    Spacing(f64),
    /// The direction of scan lines is no number.
    #[error("the angle is {0} (the direction of scan lines is finite, in degrees)")]
    Angle(f64),
    /// The angle by which layers are turned is no number, or so large that the angle of the last one is none.
    #[error("the turn is {0:?} (the angles of all layers are finite, in degrees)")]
    Turn(f64),
    /// The shift of scan lines is no fraction of the spacing.
    #[error("the phase is {0} (it is a fraction of the spacing, from 0 to 1)")]
    Phase(f64),
    /// The distance of layers is no positive number.
    #[error("the layer height is {0} (the distance of layers is greater than 0 and finite)")]
    LayerHeight(f64),
    /// The height of a layer is no number, or too large for rays.
    #[error("height {index} of the layers is {value:?} (a height is finite, and at most 1e59 in magnitude)")]
    Height {
        /// The number of the layer.
        index: usize,
        /// What was given.
        value: f64,
    },
    /// There are more scan lines than anybody can mean.
    #[error(
        "the spacing {spacing:?} makes {lines:.3e} scan lines (at most {most} are filled in one run) use a larger spacing?"
    )]
    TooManyLines {
        /// The distance of scan lines.
        spacing: f64,
        /// The number of scan lines of all layers, or the largest number of one.
        lines: f64,
        /// The limit.
        most: u64,
    },
    /// There are more layers than anybody can mean.
    #[error(
        "the layer height {height} makes {layers:.3e} layers (at most {most} are filled in one run) use a larger layer height?"
    )]
    TooManyLayers {
        /// The distance of layers.
        height: f64,
        /// The number of layers.
        layers: f64,
        /// The limit.
        most: u64,
    },
    /// There is nothing to fill.
    #[error("{name} is empty (there is nothing to fill) do its parts overlap as they should?")]
    Empty {
        /// What was to be filled.
        name: String,
    },
    /// There is no end to what is to be filled.
    #[error("{name} is unbounded in {axes} (scan lines would never end) intersect it with a box?")]
    Unbounded {
        /// What was to be filled.
        name: String,
        /// The axes along which it is unbounded, or may be for all that is known.
        axes: String,
    },
    /// The region is too far from the origin.
    #[error(
        "{name} reaches to {reach:e} (coordinates of what is filled are at most {most:e}) is the unit right?"
    )]
    TooFar {
        /// What was to be filled.
        name: String,
        /// Its largest coordinate.
        reach: f64,
        /// The limit.
        most: f64,
    },
    /// Somebody asked the run to stop.
    #[error("cancelled")]
    Cancelled,
}
