//! The error of all drawings.

use crate::TimelineError;
use rayweave_analysis::section::SectionError;
use rayweave_error::{Classified, ErrorKind, Message};
use rayweave_model::CompileError;
use rayweave_optics::OpticsError;
use rayweave_render::{CameraError, RenderError};
use rayweave_rootray::RootRayError;
use rayweave_scene::SceneError;
use rayweave_shape::RayError;
use rayweave_shape::primitive::ShapeError;

/// An error in the request for a drawing, or in its subject.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// An option is out of range, or is not applicable to the model.
    #[error("{0}")]
    Option(Message),
    /// A name is unknown.
    #[error("{0}")]
    UnknownName(Message),
    /// The scene cannot be compiled, or has no solid with the given name.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The model cannot be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A plane that cuts the model is out of range.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The camera is invalid.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The settings of a picture are invalid, or the run was cancelled.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The contents of a time line are invalid.
    #[error(transparent)]
    Timeline(#[from] TimelineError),
    /// A ray is out of range.
    #[error(transparent)]
    Ray(#[from] RayError),
    /// The roots of a ray are not those of a root-ray.
    #[error(transparent)]
    RootRay(#[from] RootRayError),
    /// A section cannot be computed, or the run was cancelled.
    #[error(transparent)]
    Section(#[from] SectionError),
    /// Light cannot be traced, or the run was cancelled.
    #[error(transparent)]
    Optics(#[from] OpticsError),
}

impl Classified for DrawError {
    fn kind(&self) -> ErrorKind {
        match self {
            DrawError::Option(_) => ErrorKind::Value,
            DrawError::UnknownName(_) => ErrorKind::Name,
            DrawError::Scene(error) => error.kind(),
            DrawError::Compile(error) => error.kind(),
            DrawError::Shape(error) => error.kind(),
            DrawError::Camera(error) => error.kind(),
            DrawError::Render(error) => error.kind(),
            DrawError::Timeline(error) => error.kind(),
            DrawError::Ray(error) => error.kind(),
            DrawError::RootRay(error) => error.kind(),
            DrawError::Section(error) => error.kind(),
            DrawError::Optics(error) => error.kind(),
        }
    }
}
