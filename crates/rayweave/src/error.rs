//! The error type of the library.

use rayweave_error::{Classified, ErrorKind};
use rayweave_model::drive::Stopped;
#[cfg(feature = "scene")]
use rayweave_scene::Diagnostics;
use std::convert::Infallible;
use std::{fmt, io, iter};

/// Any error of the library, printed as `problem: reason. Suggestion.`
///
/// Opaque: its content may grow. [`Error::kind`] and the predicates classify it; [`Error::diagnostics`] lists
/// the positions in a model file.
pub struct Error(Box<dyn Classified + Send + Sync>);

impl Error {
    /// The error of a run by [`drive`](crate::model::drive::drive) whose closures return errors of the library, for `map_err`. Those of
    /// other types convert with `?`.
    pub fn from_stopped(stopped: Stopped<Error>) -> Error {
        match stopped {
            Stopped::Failed(error) => error,
            Stopped::Cancelled => Stopped::<Infallible>::Cancelled.into(),
        }
    }

    /// The kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind()
    }

    /// True if parameters of a shape are invalid.
    pub fn is_shape(&self) -> bool {
        self.kind() == ErrorKind::Shape
    }

    /// True if a solid cannot be compiled.
    pub fn is_compile(&self) -> bool {
        self.kind() == ErrorKind::Compile
    }

    /// True if a model file cannot be read or is invalid.
    pub fn is_model_file(&self) -> bool {
        self.kind() == ErrorKind::ModelFile
    }

    /// True if a file of rays or another input file cannot be read or is invalid.
    pub fn is_input(&self) -> bool {
        self.kind() == ErrorKind::Input
    }

    /// True if an output file cannot be written.
    pub fn is_output(&self) -> bool {
        self.kind() == ErrorKind::Output
    }

    /// True if the format of a file cannot be inferred from its name.
    pub fn is_format(&self) -> bool {
        self.kind() == ErrorKind::Format
    }

    /// True if a value is out of range.
    pub fn is_value(&self) -> bool {
        self.kind() == ErrorKind::Value
    }

    /// True if a query needs a non-empty, bounded solid and this one is empty or unbounded.
    pub fn is_solid(&self) -> bool {
        self.kind() == ErrorKind::Solid
    }

    /// True if an optical system is inconsistent, or light cannot be traced through it.
    pub fn is_optics(&self) -> bool {
        self.kind() == ErrorKind::Optics
    }

    /// True if a name is unknown.
    pub fn is_name(&self) -> bool {
        self.kind() == ErrorKind::Name
    }

    /// True if the run was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.kind() == ErrorKind::Cancelled
    }

    /// True if the reader of the output closed it, as `head` does after enough lines.
    pub fn is_broken_pipe(&self) -> bool {
        let first: &dyn std::error::Error = &*self.0;
        let mut causes = iter::successors(Some(first), |error| error.source());
        let is_closed = |error: &io::Error| error.kind() == io::ErrorKind::BrokenPipe;
        self.is_output() && causes.any(|error| error.downcast_ref().is_some_and(is_closed))
    }

    #[cfg(feature = "scene")]
    /// The problems of a model file, each with its position.
    pub fn diagnostics(&self) -> Option<&Diagnostics> {
        let error: &dyn std::error::Error = &*self.0;
        error.downcast_ref().or_else(|| error.source()?.downcast_ref())
    }
}

impl<E: Classified + Send + Sync + 'static> From<E> for Error {
    fn from(error: E) -> Error {
        Error(Box::new(error))
    }
}

/// Same text as [`fmt::Display`] after the kind, so that the output of `unwrap` and of a failing `main` is
/// readable.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}: {self}", self.kind())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The text is that of the cause, so the source is the source of the cause.
impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.source()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_and_predicates_agree() {
        let window = Error::from(rayweave_model::Window::new(2.0, 1.0).unwrap_err());
        assert!(window.is_value() && !window.is_input());
        assert!(window.to_string().contains("t_min must be less than t_max"));
        let cancelled = Error::from(rayweave_analysis::Cancelled);
        assert!(cancelled.is_cancelled() && cancelled.kind() == ErrorKind::Cancelled);
        let missing = rayweave_table::RayReader::open("no-such-file.csv").unwrap_err();
        assert!(Error::from(missing).is_input());
    }

    #[test]
    fn a_closed_pipe_is_recognised() {
        let error = io::Error::from(io::ErrorKind::BrokenPipe);
        let closed = rayweave_table::TableError::Io { action: "write", path: "-".to_owned(), error };
        assert!(Error::from(closed).is_broken_pipe());
        assert!(!Error::from(rayweave_analysis::Cancelled).is_broken_pipe());
    }
}
