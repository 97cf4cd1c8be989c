//! What can go wrong with a table, in the words that the user reads.

use std::fmt;
use std::io;
use std::path::Path;

/// An error of a table, an output file or a file of rays.
///
/// The text is complete: "place: problem (why); suggestion".
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The operating system refused to open, read, write or rename a file.
    #[error("cannot {action} {path} ({})", reason(error))]
    Io {
        /// What was tried: "read", "write", "create", ...
        action: &'static str,
        /// The file, as the caller named it.
        path: String,
        /// What the operating system answered.
        error: io::Error,
    },
    /// A file name that does not tell a format that we know, or a format that this build lacks.
    #[error("{path}: {problem}")]
    Format {
        /// The file, as the caller named it.
        path: String,
        /// What is wrong, why, and what to do.
        problem: String,
    },
    /// A schema that no file can hold.
    #[error("bad table: {0}")]
    Schema(String),
    /// A chunk that does not fit its schema.
    #[error("bad chunk: {0}")]
    Chunk(String),
    /// A file of rays that cannot be used, with all problems that were found.
    #[error(transparent)]
    Rays(#[from] RayProblems),
}

impl TableError {
    /// The kind of the operating system's error, where there is one: `BrokenPipe` tells a closed pager, for instance.
    pub fn io_kind(&self) -> Option<io::ErrorKind> {
        match self {
            Self::Io { error, .. } => Some(error.kind()),
            _ => None,
        }
    }

    pub(crate) fn io(action: &'static str, path: &Path, error: io::Error) -> Self {
        Self::Io { action, path: path.display().to_string(), error }
    }

    pub(crate) fn format(path: &Path, problem: impl Into<String>) -> Self {
        Self::Format { path: path.display().to_string(), problem: problem.into() }
    }
}

/// The operating system's answer in plain words, without its number where the kind says it all.
fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file or folder".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::IsADirectory => "it is a folder".into(),
        io::ErrorKind::NotADirectory => "a part of its path is a file, not a folder".into(),
        io::ErrorKind::StorageFull => "the disk is full".into(),
        io::ErrorKind::BrokenPipe => "the reader of the output has gone".into(),
        _ => error.to_string(),
    }
}

/// One problem of a file of rays and its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RayProblem {
    /// Line in a CSV file, from 1; the header is a line too. `None` for NPY.
    pub line: Option<u64>,
    /// Row of the array, from 0 (the ray's number). `None` for problems of the header or the whole file.
    pub row: Option<u64>,
    /// Name of the column, one of [`RAY_COLUMNS`](crate::RAY_COLUMNS), where the problem is in one column.
    pub column: Option<&'static str>,
    /// What is wrong, why, and what to do.
    pub message: String,
}

impl RayProblem {
    /// A problem of the whole file.
    pub(crate) fn whole(message: impl Into<String>) -> Self {
        Self { line: None, row: None, column: None, message: message.into() }
    }
}

/// Everything found wrong in a file of rays: at least one problem, at most [`RayProblems::LIMIT`].
///
/// Printed one problem a line: `FILE:LINE: message` for CSV, `FILE: row ROW: message` for NPY.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RayProblems {
    /// The file, as the caller named it; `stdin` for standard input.
    pub file: String,
    /// The problems in the order of the file.
    pub problems: Vec<RayProblem>,
    /// Whether reading stopped because the limit was reached.
    pub stopped: bool,
}

impl RayProblems {
    /// So many problems are collected before reading stops.
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
