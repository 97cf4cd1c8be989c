//! Errors of compiling a solid.

use rayweave_error::{Classified, ErrorKind};
use rayweave_math::SingularError;

/// A solid that cannot be compiled, with the path to the part at fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path}: {problem}")]
pub struct CompileError {
    /// The names and operators on the way from the root to the part, e.g. `lens/union[1]/sphere`.
    pub path: String,
    /// The problem with that part.
    pub problem: CompileProblem,
}

impl CompileError {
    pub(crate) fn cancelled() -> CompileError {
        CompileError { path: "model".to_owned(), problem: CompileProblem::Cancelled }
    }
}

impl Classified for CompileError {
    fn kind(&self) -> ErrorKind {
        match self.problem {
            CompileProblem::Cancelled => ErrorKind::Cancelled,
            _ => ErrorKind::Compile,
        }
    }
}

/// The problem with a part of a solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompileProblem {
    /// A singular map.
    #[error("{0}")]
    Transform(#[from] SingularError),
    /// More parts than the 31-bit ids of a program can number.
    #[error(
        "the model has more than 2^31 {what}: their numbers do not fit. Nest fewer copies in each other, or place shared parts (`place`) instead of copying them."
    )]
    TooLarge {
        /// Leaves, surfaces or placements.
        what: &'static str,
    },
    /// Solids that expand to too many leaves. The limit is 2^24, or 64 for each solid and copy in the description, whichever
    /// is greater; for model files 500,000, or 8 for each.
    #[error(
        "its {nodes} solids and copies describe more than {limit} leaves: each use of a solid under a different map copies all of its leaves. Place shared solids instead (`place`), which copies nothing."
    )]
    Repeated {
        /// The number of solids and copies in the description.
        nodes: u64,
        /// The number of leaves that they may make.
        limit: u64,
    },
    /// The compilation was cancelled.
    #[error("the compilation was cancelled")]
    Cancelled,
    /// A chain of nearly equal surfaces so long that its ends are not equal.
    #[error(
        "faces {first} and {second} are neither equal nor distinct: a chain of nearly coincident faces connects them. Were they computed in different ways?"
    )]
    WideClass {
        /// A face at one end of the chain.
        first: String,
        /// A face at the other end.
        second: String,
    },
    /// A length of a shape under its map, or of the translations that lead to it, exceeds
    /// [`rayweave_shape::Ray::MAX_COMPONENT`], or a size vanished.
    #[error(
        "the size or position of the shape is out of range here: lengths beyond 1e100 overflow, and tiny sizes vanish. Is a scale far too large or small?"
    )]
    NotFinite,
}
