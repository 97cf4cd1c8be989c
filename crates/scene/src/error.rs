//! Errors of the compilation of a scene.

use rayweave_error::{Classified, ErrorKind, Message};
use rayweave_model::CompileError;

/// Error of a scene that cannot be compiled, or of an unknown name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A solid cannot be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// Nothing in the scene has this name.
    #[error("{0}")]
    UnknownName(Message),
}

impl Classified for SceneError {
    fn kind(&self) -> ErrorKind {
        match self {
            SceneError::Compile(error) => error.kind(),
            SceneError::UnknownName(_) => ErrorKind::Name,
        }
    }
}
