//! Errors of prescriptions.

use rayweave_error::{Classified, ErrorKind};
use rayweave_math::round_to_digits;
use rayweave_optics::OpticsError;
use rayweave_optics::component::ComponentError;
use rayweave_optics::glass::GlassError;

/// Error of a prescription, printed as `problem: reason. Suggestion.`; surfaces are counted from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrescriptionError {
    /// There is no surface, no field or no wavelength.
    #[error("the prescription has no {0}: it needs at least one.")]
    None(&'static str),
    /// A number that is out of its range.
    #[error("{what} is {value}: it has to be {range}.")]
    BadNumber {
        /// The name of the number, with its surface.
        what: String,
        /// The number.
        value: f64,
        /// The admissible range.
        range: &'static str,
    },
    /// A surface, field or wavelength that does not exist.
    #[error("the {what} is {number}: it must be from {first} to {last}.")]
    NoSuch {
        /// The kind of object.
        what: &'static str,
        /// Its number.
        number: usize,
        /// The number of the first one.
        first: usize,
        /// The number of the last one.
        last: usize,
    },
    /// An unknown medium, or one without an index.
    #[error("surface {surface}: {problem}")]
    Glass {
        /// The surface in front of the medium.
        surface: usize,
        /// The problem.
        problem: GlassError,
    },
    /// Surfaces that intersect inside the aperture: the thickness of the lens or gap is negative there.
    #[error(
        "surfaces {first} and {second} cross {} from the axis: their clear semi-diameters reach {}{}",
        round_to_digits(*height, 6), round_to_digits(*reach, 6), cause(*is_computed)
    )]
    Cross {
        /// The surface in front.
        first: usize,
        /// The surface behind it.
        second: usize,
        /// The distance from the axis of the intersection.
        height: f64,
        /// The clear semi-diameter.
        reach: f64,
        /// True if the semi-diameter of one of them is computed from the rays.
        is_computed: bool,
    },
    /// A coordinate break inside a lens.
    #[error(
        "surfaces {first} and {second} are tilted or decentred relative to each other, with glass between them: a lens has one axis."
    )]
    Tilted {
        /// The surface in front.
        first: usize,
        /// The surface behind it.
        second: usize,
    },
    /// A semi-diameter larger than the surface.
    #[error("the semi-diameter of surface {surface} is {reach}: the surface ends {limit} from the axis.")]
    TooLarge {
        /// The surface.
        surface: usize,
        /// Its semi-diameter.
        reach: f64,
        /// The distance from the axis at which the surface ends.
        limit: f64,
    },
    /// A part that cannot be built for another reason.
    #[error("surface {surface}: {problem}")]
    Component {
        /// The first surface of the part.
        surface: usize,
        /// The problem.
        problem: ComponentError,
    },
    /// A quantity that does not exist for this system.
    #[error("the system has no {what}: {why}.")]
    Undefined {
        /// The quantity.
        what: &'static str,
        /// The reason.
        why: &'static str,
    },
    /// A wavelength outside the range of a medium.
    #[error(
        "the wavelength is {wavelength_nm} nm: the index of `{medium}` is known from {} nm to {} nm. Is it in nanometres?",
        range_nm[0], range_nm[1]
    )]
    Wavelength {
        /// The medium.
        medium: String,
        /// The wavelength in nanometres.
        wavelength_nm: f64,
        /// The shortest and the longest wavelength of the medium in nanometres.
        range_nm: [f64; 2],
    },
    /// A ray that does not reach the image.
    #[error("the ray does not reach the image: {why} at surface {surface}.")]
    Lost {
        /// The surface, counted from 1; the image is the last.
        surface: usize,
        /// The reason.
        why: &'static str,
    },
    /// An error of ray tracing.
    #[error(transparent)]
    Optics(#[from] OpticsError),
}

impl Classified for PrescriptionError {
    fn kind(&self) -> ErrorKind {
        match self {
            PrescriptionError::Optics(error) => error.kind(),
            _ => ErrorKind::Optics,
        }
    }
}

/// A number that is out of its range.
pub(super) fn bad(what: impl Into<String>, value: f64, range: &'static str) -> PrescriptionError {
    PrescriptionError::BadNumber { what: what.into(), value, range }
}

/// The value if it is finite and greater than 0, otherwise an error.
pub(super) fn positive(what: impl Into<String>, value: f64) -> Result<f64, PrescriptionError> {
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(bad(what, value, "greater than 0 and finite")),
    }
}

/// The end of the message about surfaces that cross.
fn cause(is_computed: bool) -> &'static str {
    match is_computed {
        true => {
            ", which the rays of all fields need, since none is stated. State smaller ones (the semi_diameter of a surface, DIAM in a Zemax file), which vignette, or increase the thickness."
        }
        false => ". Is the thickness too small or a semi-diameter too large?",
    }
}
