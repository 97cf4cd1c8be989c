//! Errors of writers.

use crate::Format;
use rayweave_error::{Classified, ErrorKind};
use rayweave_mesh_io::FileError;
use rayweave_model::CompileError;
use rayweave_table::TableError;

/// The reason why a scene cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The format has a reader only.
    #[error("files of the format {0} are not written: the format has a reader only. Choose another format.")]
    NotWritten(Format),
    /// The tolerance is not a positive finite length.
    #[error("the tolerance is {0}: it must be finite and greater than 0.")]
    Tolerance(f64),
    /// A solid cannot be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A region is unbounded.
    #[error(
        "region `{region}` is unbounded: the format {format} needs bounded solids. Intersect it with a box."
    )]
    Unbounded {
        /// Name of the region.
        region: String,
        /// Format of the file.
        format: Format,
    },
    /// The model has no volume, and no reader accepts a mesh without triangles as a solid.
    #[error(
        "the model is empty: a file of the format {0} needs a solid. Check that no part of the model is missing."
    )]
    Empty(Format),
    /// The text or the number of triangles of a region becomes too large.
    #[error("region `{region}` becomes too large: {why}. Increase the tolerance.")]
    TooLarge {
        /// Name of the region.
        region: String,
        /// Limit that is exceeded.
        why: String,
    },
    /// A boolean operation on triangle meshes failed.
    #[error("the triangles of region `{region}` cannot be combined: {why}.")]
    Kernel {
        /// Name of the region.
        region: String,
        /// Message of the mesh kernel.
        why: String,
    },
    /// The mesh writer failed.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file cannot be written.
    #[error(transparent)]
    Output(#[from] TableError),
}

impl Classified for WriteError {
    fn kind(&self) -> ErrorKind {
        match self {
            WriteError::Compile(error) => error.kind(),
            WriteError::Output(error) => error.kind(),
            WriteError::Unbounded { .. } | WriteError::Empty(_) | WriteError::Kernel { .. } => {
                ErrorKind::Solid
            }
            _ => ErrorKind::Value,
        }
    }
}
