//! Errors of optical systems and of input light.

use num_complex::Complex64;
use rayweave_error::{Classified, ErrorKind, Message};
use rayweave_model::memory::Shortage;
use rayweave_model::{BadRay, CompileError};
use std::ops::Range;

/// Error of an optical system, or of light that cannot be traced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OpticsError {
    /// An impossible refractive index.
    #[error("medium `{medium}` has the index {index}: n must be greater than 0, k at least 0, both finite.")]
    BadIndex {
        /// The medium.
        medium: String,
        /// Its index.
        index: Complex64,
    },
    /// An invalid gradient.
    #[error("{0}")]
    BadGradient(Message),
    /// A number of a finish or an action out of its range.
    #[error("{what} of `{element}` is {value}: it must be {range}.")]
    BadNumber {
        /// The element.
        element: String,
        /// The name of the number.
        what: &'static str,
        /// The number.
        value: f64,
        /// The range.
        range: &'static str,
    },
    /// A finish of an unknown face.
    #[error("element `{element}` has no face `{face}`: its faces are {faces}.")]
    NoFace {
        /// The element.
        element: String,
        /// The unknown face.
        face: String,
        /// The faces of the element.
        faces: String,
    },
    /// Two elements with the same name.
    #[error(
        "two elements are called `{name}`: element names must be unique, since results refer to them. Rename one of them."
    )]
    SameName {
        /// The name.
        name: String,
    },
    /// The solids of the system do not compile.
    #[error("element `{element}`: {problem}")]
    Geometry {
        /// The element.
        element: String,
        /// The problem.
        problem: CompileError,
    },
    /// A ray that cannot be traced.
    #[error(transparent)]
    Ray(#[from] BadRay),
    /// Columns of light of different lengths.
    #[error("column `{column}` has {found} entries: there are {expected} rays.")]
    Length {
        /// The column.
        column: &'static str,
        /// Its length.
        found: usize,
        /// The number of rays.
        expected: usize,
    },
    /// An invalid power or wavelength.
    #[error("{column}[{ray}] is {value}: it must be {range}.")]
    BadLight {
        /// The column.
        column: &'static str,
        /// The ray.
        ray: usize,
        /// The number.
        value: f64,
        /// The range.
        range: &'static str,
    },
    /// A wavelength outside the range of a medium.
    #[error(
        "ray {ray} has a wavelength of {wavelength_nm} nm: the index of `{medium}` is known from {} nm to {} nm.",
        range_nm[0], range_nm[1]
    )]
    Wavelength {
        /// The ray.
        ray: usize,
        /// Its wavelength.
        wavelength_nm: f64,
        /// The medium.
        medium: String,
        /// The range of its index.
        range_nm: [f64; 2],
    },
    /// A range of rays that is not one of whole chunks.
    #[error(
        "the range of rays is {}:{}: it must lie in 0:{count}, and start and end at multiples of {} or at {count}.",
        range.start, range.end, step
    )]
    Range {
        /// The range.
        range: Range<usize>,
        /// The number of rays.
        count: usize,
        /// The number whose multiples are allowed.
        step: usize,
    },
    /// The segments of the light do not fit into memory.
    #[error(
        "the segments of {rays} rays cannot be kept: {shortage}. Trace fewer rays, or write the segments to a file."
    )]
    Memory {
        /// The number of rays.
        rays: usize,
        /// The memory.
        shortage: Shortage,
    },
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl Classified for OpticsError {
    fn kind(&self) -> ErrorKind {
        match self {
            OpticsError::Cancelled => ErrorKind::Cancelled,
            _ => ErrorKind::Optics,
        }
    }
}
