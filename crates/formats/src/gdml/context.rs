//! State of the reader: files, problems, warnings and losses.

use super::trouble::Trouble;
use super::xml::Files;
use crate::{LossKind, Report};
use rayweave_scene::Diagnostic;

/// Maximum number of reported problems. More indicate a loop, or a file in a different format.
const MAX_PROBLEMS: usize = 200;

/// Number of faces and of volumes in volumes that files of any length may describe.
const MOST: usize = 300_000;

/// State while files are read.
#[derive(Debug, Default)]
pub struct Context {
    pub files: Files,
    pub problems: Vec<Diagnostic>,
    pub warnings: Vec<Diagnostic>,
    pub report: Report,
    /// Stack of the files being read, each included by the previous one.
    pub open: Vec<std::path::PathBuf>,
    /// Number of faces of the solids so far that have many of them for their text.
    pub faces: usize,
}

impl Context {
    /// The number of faces, or of volumes in volumes, that the files may describe: each takes one to two kilobytes of memory and
    /// up to ten microseconds.
    pub fn most(&self) -> usize {
        MOST.max(self.files.bytes() / 3)
    }

    /// Adds an error.
    pub fn error(&mut self, trouble: Trouble) {
        if self.problems.len() < MAX_PROBLEMS {
            self.problems.push(self.files.locate(Diagnostic::error(trouble.message), trouble.place));
        }
    }

    /// Adds a warning without a loss.
    pub fn warn(&mut self, trouble: Trouble) {
        if self.warnings.len() < MAX_PROBLEMS {
            self.warnings.push(self.files.locate(Diagnostic::warning(trouble.message), trouble.place));
        }
    }

    /// Adds a loss.
    pub fn lose(&mut self, kind: LossKind, what: &str, trouble: Trouble) {
        self.report.add(kind, what, self.files.locate(Diagnostic::warning(trouble.message), trouble.place));
    }
}
