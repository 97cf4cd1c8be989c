//! The error type of this crate.

use crate::infill::{ContourProblems, InfillError};
use crate::measure::MeasureError;
use crate::section::SectionError;
use rayweave_error::{Classified, ErrorKind, Message};
use rayweave_model::{BadPoint, BadRay, CompileError, Program};
use rayweave_scene::SceneError;
use rayweave_shape::primitive::ShapeError;
use rayweave_table::TableError;
use std::sync::Arc;

/// Error of an analysis.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// A solid cannot be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A scene cannot be compiled, or a name does not exist in it.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A box has no volume.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The evaluator cannot be created.
    #[error("{0}")]
    Evaluator(Box<dyn Classified + Send + Sync>),
    /// A region cannot be filled.
    #[error(transparent)]
    Infill(#[from] InfillError),
    /// A region cannot be measured.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// A cross-section cannot be computed.
    #[error(transparent)]
    Section(#[from] SectionError),
    /// A file of contours is invalid.
    #[error(transparent)]
    Contours(#[from] ContourProblems),
    /// A ray cannot be traced.
    #[error(transparent)]
    Ray(#[from] BadRay),
    /// A point is not finite.
    #[error(transparent)]
    Point(#[from] BadPoint),
    /// A file of rays cannot be read, or a table cannot be written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The analysis does not apply to an empty or unbounded model.
    #[error("{0}")]
    Solid(Message),
    /// A setting is out of range.
    #[error("{0}")]
    Value(Message),
    /// A name is unknown.
    #[error("{0}")]
    Name(Message),
    /// The run was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The run was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl Classified for Cancelled {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Cancelled
    }
}

impl Classified for AnalysisError {
    fn kind(&self) -> ErrorKind {
        match self {
            AnalysisError::Compile(error) => error.kind(),
            AnalysisError::Scene(error) => error.kind(),
            AnalysisError::Shape(error) => error.kind(),
            AnalysisError::Evaluator(error) => error.kind(),
            AnalysisError::Infill(error) => error.kind(),
            AnalysisError::Measure(error) => error.kind(),
            AnalysisError::Section(error) => error.kind(),
            AnalysisError::Contours(error) => error.kind(),
            // the rays are those of a file
            AnalysisError::Ray(_) => ErrorKind::Input,
            AnalysisError::Point(bad) => bad.kind(),
            AnalysisError::Table(error) => error.kind(),
            AnalysisError::Solid(_) => ErrorKind::Solid,
            AnalysisError::Value(_) => ErrorKind::Value,
            AnalysisError::Name(_) => ErrorKind::Name,
            AnalysisError::Cancelled(error) => error.kind(),
        }
    }
}

/// Function that creates the evaluator of a compiled program.
pub(crate) type Make<'a, E> = dyn Fn(Arc<Program>) -> Result<E, AnalysisError> + 'a;

/// Wraps the caller's `make` to return the error of this crate.
pub(crate) fn maker<E, X: Classified + Send + Sync + 'static>(
    make: impl Fn(Arc<Program>) -> Result<E, X>,
) -> impl Fn(Arc<Program>) -> Result<E, AnalysisError> {
    move |program| make(program).map_err(|error| AnalysisError::Evaluator(Box::new(error)))
}
