//! Why a solid cannot be compiled.

use rayweave_error::{Classified, ErrorKind};
use rayweave_math::SingularError;

/// A solid that cannot be compiled, with the way to the part that is at fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path}: {problem}")]
pub struct CompileError {
    /// The names and operators on the way from the root to the part, as `lens/union[1]/sphere`.
    pub path: String,
    /// What is wrong there.
    pub problem: CompileProblem,
}

impl Classified for CompileError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Compile
    }
}

/// What can be wrong with a solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompileProblem {
    /// A map without inverse.
    #[error("{0}")]
    Transform(#[from] SingularError),
    /// More parts than the 31-bit numbers of a program can tell apart.
    #[error(
        "the model has more than 2^31 {what}: their numbers do not fit. Are shared parts placed instead of copied?"
    )]
    TooLarge {
        /// Leaves, surfaces or placements.
        what: &'static str,
    },
    /// Nearly equal surfaces that form a chain so long that its ends are not equal.
    #[error(
        "faces {first} and {second} are neither equal nor apart: a chain of nearly coincident faces joins them. Were they computed in different ways?"
    )]
    WideClass {
        /// A face at one end of the chain.
        first: String,
        /// A face at the other end.
        second: String,
    },
    /// A length of a shape under its map is greater than [`rayweave_shape::Ray::MOST`], as are the ways to it, or a size
    /// vanished.
    #[error(
        "the shape has no usable size or place here: beyond 1e100 squares overflow, and sizes may vanish. Is a scale far too large or small?"
    )]
    NotFinite,
}
