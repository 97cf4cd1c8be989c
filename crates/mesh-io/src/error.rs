//! Errors of mesh files, with the line or byte at fault.

use rayweave_error::Message;
use rayweave_mesh::MeshError;
use rayweave_table::{RefusedFile, TableError};
use std::fmt;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// A line of a text file, from 1.
    Line(u64),
    /// A byte offset, from 0.
    Byte(u64),
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Location::Line(line) => write!(f, "line {line}"),
            Location::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Error: a mesh file cannot be read or written. The message begins with the location, if there is one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file name has no known extension.
    #[error(
        "the format of `{name}` is unknown: the known extensions are stl, obj, ply, off, 3mf, gltf and glb. \
         Rename the file."
    )]
    UnknownFormat {
        /// The file name.
        name: String,
    },
    /// The operating system reports an error.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The file cannot be created, or not be renamed when it is complete.
    #[error("{0}")]
    NotWritten(#[from] TableError),
    /// The file may not be read, or is not a regular file.
    #[error("{0}")]
    Refused(RefusedFile),
    /// The file violates its format, or uses a part of the format that is not supported.
    #[error("{location}: {message}")]
    Syntax {
        /// The place in the file.
        location: Location,
        /// The problem and its reason.
        message: Message,
    },
    /// The vertices and triangles in the file do not form a mesh.
    #[error("{location}: {error}")]
    Mesh {
        /// The place in the file.
        location: Location,
        /// The reason.
        error: MeshError,
    },
}

impl From<RefusedFile> for FileError {
    fn from(refused: RefusedFile) -> FileError {
        match refused {
            RefusedFile::Io(error) => FileError::Io(error),
            other => FileError::Refused(other),
        }
    }
}

impl FileError {
    /// A violation of the format.
    pub(crate) fn syntax(
        location: Location,
        problem: impl Into<String>,
        reason: impl Into<String>,
    ) -> FileError {
        FileError::Syntax { location, message: Message::new(problem, reason) }
    }

    /// The end of the file where more data is expected.
    pub(crate) fn truncated(location: Location, expected: &str) -> FileError {
        FileError::syntax(location, format!("the file ends before {expected}"), "it is incomplete")
    }
}
