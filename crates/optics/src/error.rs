//! What can be wrong with an optical system and with the light that is sent into it.

use num_complex::Complex64;
use rayweave_model::{BadRay, CompileError};

/// An optical system, or light, that cannot be traced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OpticsError {
    /// An index of refraction that no medium has.
    #[error("medium `{medium}` has the index {index} (n is greater than 0, k at least 0, both finite)")]
    BadIndex {
        /// The medium.
        medium: String,
        /// Its index.
        index: Complex64,
    },
    /// A gradient that no medium has.
    #[error("the gradient of the index cannot be used: {problem}")]
    BadGradient {
        /// What is wrong.
        problem: String,
    },
    /// A number of a finish or an action out of its range.
    #[error("{what} of `{element}` is {value} (it has to be {range})")]
    BadNumber {
        /// The element.
        element: String,
        /// What the number is.
        what: &'static str,
        /// The number.
        value: f64,
        /// Which numbers are possible.
        range: &'static str,
    },
    /// A finish for faces that the element does not have.
    #[error("element `{element}` has no face `{face}` (its faces are {faces})")]
    NoFace {
        /// The element.
        element: String,
        /// The face asked for.
        face: String,
        /// The faces that there are.
        faces: String,
    },
    /// Two elements of one name.
    #[error(
        "two elements are called `{name}` (surfaces are told apart by these names) give one of them another"
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
        /// What is wrong.
        problem: CompileError,
    },
    /// A ray that cannot be traced.
    #[error(transparent)]
    Ray(#[from] BadRay),
    /// Columns of light of different lengths.
    #[error("the column `{column}` has {found} entries ({expected} rays have to be described)")]
    Length {
        /// The column.
        column: &'static str,
        /// Its length.
        found: usize,
        /// The number of rays.
        expected: usize,
    },
    /// A power or a wavelength that light cannot have.
    #[error("{column}[{ray}] is {value} ({range})")]
    BadLight {
        /// The column.
        column: &'static str,
        /// The ray.
        ray: usize,
        /// The number.
        value: f64,
        /// Which numbers are possible.
        range: &'static str,
    },
    /// Light of a wavelength at which the index of a medium is not known.
    #[error(
        "ray {ray} has a wavelength of {wavelength_nm} nm (the index of `{medium}` is known from {} nm to {} nm)",
        range_nm[0], range_nm[1]
    )]
    Wavelength {
        /// The ray.
        ray: usize,
        /// Its wavelength.
        wavelength_nm: f64,
        /// The medium.
        medium: String,
        /// Where its index is known.
        range_nm: [f64; 2],
    },
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}
