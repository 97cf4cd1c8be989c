//! Why a file is no mesh.

use crate::MeshError;
use std::fmt;

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of text, from 1.
    Line(u64),
    /// A byte, from 0.
    Byte(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why a file cannot be read or written; the message begins with the place, where there is one.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Neither the name's ending nor anything else says what it is.
    #[error(
        "{name}: of no known format (the formats are stl, obj, ply, off, 3mf, gltf, glb) does the name end as it should?"
    )]
    UnknownFormat {
        /// The file.
        name: String,
    },
    /// The operating system says no.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The file is not as its format asks.
    #[error("{place}: {problem}")]
    Syntax {
        /// Where.
        place: Place,
        /// What is wrong.
        problem: String,
    },
    /// What the file holds is no mesh.
    #[error("{place}: {error}")]
    Mesh {
        /// Where.
        place: Place,
        /// Why not.
        error: MeshError,
    },
}

impl FileError {
    pub(crate) fn syntax(place: Place, problem: impl Into<String>) -> FileError {
        FileError::Syntax { place, problem: problem.into() }
    }

    pub(crate) fn ends(place: Place, what: &str) -> FileError {
        FileError::syntax(place, format!("the file ends before {what} (is it complete?)"))
    }
}
