//! Errors of tables, output files and ray files.

use crate::allowed::RefusedFile;
use crate::nearby::nearby_sentence;
use crate::reason::reason;
use rayweave_error::{Classified, ErrorKind, Message};
use std::fmt;
use std::io;
use std::path::Path;

/// An error of a table, an output file or a ray file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// Opening, reading, writing or renaming a file failed.
    #[error("cannot {action} {path}: {}.{}", reason(error), hint(action, path, error))]
    Io {
        /// The failed action: "read", "write", "create" or "remove".
        action: &'static str,
        /// The path as given by the caller.
        path: String,
        /// The error of the operating system.
        #[source]
        error: io::Error,
    },
    /// The file name has no known extension, or this build lacks the format.
    #[error("{path}: {message}")]
    Format {
        /// The path as given by the caller.
        path: String,
        /// The problem, its reason and a suggestion.
        message: Message,
    },
    /// A table cannot be read: the place, the reason and a suggestion.
    #[error("{path}: {message}")]
    Table {
        /// The path as given by the caller.
        path: String,
        /// The problem, its reason and a suggestion.
        message: Message,
    },
    /// Parts that cannot be merged.
    #[error("{0}")]
    Parts(Message),
    /// The model may not read the file.
    #[error("cannot read {path}: {reason}.")]
    Refused {
        /// The path as given by the caller.
        path: String,
        /// The reason.
        reason: RefusedFile,
    },
    /// The columns do not form a valid schema.
    #[error("the schema is invalid: {0}.")]
    Schema(String),
    /// The chunk does not match the schema.
    #[error("the chunk is invalid: {0}.")]
    Chunk(String),
    /// A ray file is invalid; lists the problems.
    #[error(transparent)]
    Rays(#[from] RayProblems),
}

/// Files near one that is missing.
fn hint(action: &str, path: &str, error: &io::Error) -> String {
    match action == "read" && error.kind() == io::ErrorKind::NotFound {
        true => nearby_sentence(Path::new(path)),
        false => String::new(),
    }
}

impl Classified for TableError {
    fn kind(&self) -> ErrorKind {
        match self {
            TableError::Format { .. } => ErrorKind::Format,
            TableError::Rays(_)
            | TableError::Table { .. }
            | TableError::Parts(_)
            | TableError::Refused { .. }
            | TableError::Io { action: "read", .. } => ErrorKind::Input,
            _ => ErrorKind::Output,
        }
    }
}

impl TableError {
    /// The kind of the I/O error, if it is one; `BrokenPipe`, for example, if the reader of the output has closed it.
    pub fn io_kind(&self) -> Option<io::ErrorKind> {
        match self {
            Self::Io { error, .. } => Some(error.kind()),
            _ => None,
        }
    }

    pub(crate) fn io(action: &'static str, path: &Path, error: io::Error) -> Self {
        // Windows cannot open a folder, or rename a file to one, and reports that access is denied
        let is_folder = error.kind() == io::ErrorKind::PermissionDenied && path.is_dir();
        let error = if is_folder { io::ErrorKind::IsADirectory.into() } else { error };
        Self::Io { action, path: path.display().to_string(), error }
    }

    pub(crate) fn refused(path: &Path, refused: RefusedFile) -> Self {
        match refused {
            RefusedFile::Io(error) => Self::io("read", path, error),
            reason => Self::Refused { path: path.display().to_string(), reason },
        }
    }

    pub(crate) fn table(path: &Path, message: Message) -> Self {
        Self::Table { path: path.display().to_string(), message }
    }

    pub(crate) fn format(path: &Path, message: Message) -> Self {
        Self::Format { path: path.display().to_string(), message }
    }
}

/// A problem of a ray file, with its location.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RayProblem {
    /// The line of a CSV file, from 1, including the header. `None` for NPY.
    pub line: Option<u64>,
    /// The index of the ray, from 0. `None` for problems of the header or the whole file.
    pub row: Option<u64>,
    /// The name of the column, one of [`RAY_COLUMNS`](crate::RAY_COLUMNS), if the problem concerns one column.
    pub column: Option<&'static str>,
    /// The problem, its reason and a suggestion.
    pub message: String,
}

impl RayProblem {
    /// A problem of the whole file.
    pub(crate) fn whole(message: impl Into<String>) -> Self {
        Self { line: None, row: None, column: None, message: message.into() }
    }
}

/// The problems of a ray file: at least one, at most [`RayProblems::LIMIT`].
///
/// Printed with one problem per line: `FILE:LINE: message` for CSV, `FILE: row ROW: message` for NPY.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RayProblems {
    /// The path as given by the caller; `stdin` for standard input.
    pub file: String,
    /// The problems in the order of the file.
    pub problems: Vec<RayProblem>,
    /// True if reading stopped because the limit was reached.
    pub stopped: bool,
}

impl RayProblems {
    /// The number of problems after which reading stops.
    pub const LIMIT: usize = 20;
}

impl std::error::Error for RayProblems {}

impl fmt::Display for RayProblems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.problems.iter().enumerate() {
            let end_of_last = if i == 0 { "" } else { "\n" };
            write!(f, "{end_of_last}{}", self.file)?;
            match (problem.line, problem.row) {
                (Some(line), _) => write!(f, ":{line}: {}", problem.message)?,
                (None, Some(row)) => write!(f, ": row {row}: {}", problem.message)?,
                (None, None) => write!(f, ": {}", problem.message)?,
            }
        }
        if self.stopped {
            write!(f, "\n{}: stopped after {} problems", self.file, Self::LIMIT)?;
        }
        Ok(())
    }
}
