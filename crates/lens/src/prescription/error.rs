//! What can be wrong with a prescription.

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
        /// What the number is, with its surface.
        what: String,
        /// The number.
        value: f64,
        /// Which numbers are possible.
        range: &'static str,
    },
    /// A surface, field or wavelength that does not exist.
    #[error("the {what} is number {number}: there are {count}.")]
    NoSuch {
        /// What was asked for.
        what: &'static str,
        /// Its number.
        number: usize,
        /// How many there are.
        count: usize,
    },
    /// A medium that is not known.
    #[error("surface {surface}: {problem}")]
    Glass {
        /// The surface in front of the medium.
        surface: usize,
        /// What is wrong.
        problem: GlassError,
    },
    /// Surfaces that cross inside the aperture: the lens, or the space between two lenses, has a negative thickness there.
    #[error(
        "surfaces {first} and {second} cross {} from the axis: their clear semi-diameters reach {}. Is the thickness too small or a semi-diameter too large?",
        round_to_digits(*height, 6), round_to_digits(*reach, 6)
    )]
    Cross {
        /// The surface in front.
        first: usize,
        /// The surface behind it.
        second: usize,
        /// The distance from the axis at which they cross.
        height: f64,
        /// How far the aperture reaches.
        reach: f64,
    },
    /// A coordinate break within a lens.
    #[error(
        "surfaces {first} and {second} are tilted or decentred against each other, with glass between them: a lens has one axis."
    )]
    Tilted {
        /// The surface in front.
        first: usize,
        /// The surface behind it.
        second: usize,
    },
    /// A semi-diameter that reaches beyond where the surface ends.
    #[error("surface {surface}: its semi-diameter is {reach}: the surface ends {limit} from the axis.")]
    TooLarge {
        /// The surface.
        surface: usize,
        /// Its semi-diameter.
        reach: f64,
        /// Where it ends.
        limit: f64,
    },
    /// A part that cannot be made for another reason.
    #[error("surface {surface}: {problem}")]
    Component {
        /// The first surface of the part.
        surface: usize,
        /// What is wrong.
        problem: ComponentError,
    },
    /// What is asked for does not exist for this system.
    #[error("the system has no {what}: {why}.")]
    Undefined {
        /// What was asked for.
        what: &'static str,
        /// Why there is none.
        why: &'static str,
    },
    /// A wavelength at which the index of a medium is not known.
    #[error(
        "the wavelength is {wavelength_nm} nm: the index of `{medium}` is known from {} nm to {} nm. Is it in nanometres?",
        range_nm[0], range_nm[1]
    )]
    Wavelength {
        /// The medium.
        medium: String,
        /// The wavelength in nanometres.
        wavelength_nm: f64,
        /// The least and the greatest one in nanometres.
        range_nm: [f64; 2],
    },
    /// A ray that does not arrive.
    #[error("the ray does not reach the image: {why} at surface {surface}.")]
    Lost {
        /// The surface, counted from 1; the image is the last.
        surface: usize,
        /// What happens there.
        why: &'static str,
    },
    /// Light that cannot be traced.
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

/// The value, if it is finite and greater than 0.
pub(super) fn positive(what: impl Into<String>, value: f64) -> Result<f64, PrescriptionError> {
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(bad(what, value, "greater than 0 and finite")),
    }
}
