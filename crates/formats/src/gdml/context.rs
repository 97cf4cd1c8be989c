//! State of the reader: files, problems, warnings and losses.

use super::problem::Problem;
use super::xml::Files;
use crate::{LossKind, Report};
use rayweave_scene::Diagnostic;

/// Maximum number of reported errors, and of reported warnings. More indicate a loop, or a file in a different format.
const MAX_PROBLEMS: usize = 200;

/// Limit, for short files, of the faces of solids with many of them and of the summed nesting depth of volumes.
const MIN_LIMIT: usize = 300_000;

/// State while files are read.
#[derive(Debug, Default)]
pub struct Context {
    pub files: Files,
    pub problems: Vec<Diagnostic>,
    pub warnings: Vec<Diagnostic>,
    pub report: Report,
    /// Stack of the files being read, each included by the previous one.
    pub open: Vec<std::path::PathBuf>,
    /// Faces so far of solids whose text is shorter than their faces.
    pub faces: usize,
}

impl Context {
    /// The limit of faces, and of the summed nesting depth of volumes: each takes one to two kilobytes of memory and
    /// up to ten microseconds.
    pub fn size_limit(&self) -> usize {
        MIN_LIMIT.max(self.files.bytes() / 3)
    }

    /// Adds an error.
    pub fn error(&mut self, problem: Problem) {
        if self.problems.len() < MAX_PROBLEMS {
            self.problems.push(self.files.locate(Diagnostic::error(problem.message), problem.place));
        }
    }

    /// Adds a warning without a loss.
    pub fn warn(&mut self, problem: Problem) {
        if self.warnings.len() < MAX_PROBLEMS {
            self.warnings.push(self.files.locate(Diagnostic::warning(problem.message), problem.place));
        }
    }

    /// Adds a loss.
    pub fn lose(&mut self, kind: LossKind, what: &str, problem: Problem) {
        self.report.add(kind, what, self.files.locate(Diagnostic::warning(problem.message), problem.place));
    }
}
