//! State of the reader: files, problems, warnings and losses.

use super::overrides::Overrides;
use super::problem::{Place, Problem};
use super::xml::Files;
use crate::{LossKind, Report};
use rayweave_scene::Diagnostic;
use std::collections::HashMap;

/// Maximum number of reported errors, and of reported warnings. More indicate a file in a different format.
const MAX_PROBLEMS: usize = 200;

/// Limit, for short files, of the faces of solids with many of them and of the summed nesting depth of volumes.
const MIN_LIMIT: usize = 300_000;

/// Problems in order of occurrence. A loop repeats a problem at the same position: it is listed once, with a count.
#[derive(Debug, Default)]
pub struct Problems {
    list: Vec<(Diagnostic, Repeats)>,
    /// Index of each problem by position and message; the messages of iterations differ in numbers.
    known: HashMap<(Place, String), usize>,
}

/// The occurrences of a problem.
#[derive(Debug)]
struct Repeats {
    count: usize,
    /// True if the messages differ.
    differ: bool,
}

impl Problems {
    /// Adds a problem; `locate` makes the diagnostic of a new one.
    fn add(&mut self, problem: Problem, locate: impl FnOnce(Problem) -> Diagnostic) {
        let constant = problem.message.chars().filter(|c| !c.is_ascii_digit() && !matches!(c, '.' | '-'));
        let key = (problem.place, constant.collect());
        if let Some(&index) = self.known.get(&key) {
            let (first, repeats) = &mut self.list[index];
            repeats.count += 1;
            repeats.differ |= first.message() != problem.message;
        } else if self.list.len() < MAX_PROBLEMS {
            self.known.insert(key, self.list.len());
            self.list.push((locate(problem), Repeats { count: 1, differ: false }));
        }
    }

    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The problems, those of loops with their counts.
    pub fn finish(self) -> Vec<Diagnostic> {
        let counted = |(first, repeats): (Diagnostic, Repeats)| {
            let numbers = if repeats.differ { " with different numbers" } else { "" };
            let text = format!("it occurs {} times{numbers}, first here", repeats.count);
            match repeats.count {
                1 => first,
                _ if first.message().ends_with(['.', '?']) => first.suggest(Some(text)),
                _ => first.why(text),
            }
        };
        self.list.into_iter().map(counted).collect()
    }
}

/// State while files are read.
#[derive(Debug, Default)]
pub struct Context {
    pub files: Files,
    pub problems: Problems,
    pub warnings: Problems,
    pub report: Report,
    /// Stack of the files being read, each included by the previous one.
    pub open: Vec<std::path::PathBuf>,
    /// Numbers that the caller sets in place of those of the file.
    pub overrides: Overrides,
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
        let files = &self.files;
        self.problems.add(problem, |problem| files.locate(Diagnostic::error(problem.message), problem.place));
    }

    /// Adds an error with its own source.
    pub fn error_in_override(&mut self, error: Diagnostic) {
        self.problems.add(Problem::new(error.message(), Place::default()), |_| error);
    }

    /// Adds a warning without a loss.
    pub fn warn(&mut self, problem: Problem) {
        let files = &self.files;
        self.warnings
            .add(problem, |problem| files.locate(Diagnostic::warning(problem.message), problem.place));
    }

    /// Adds a loss.
    pub fn lose(&mut self, kind: LossKind, what: &str, problem: Problem) {
        self.report.add(kind, what, self.files.locate(Diagnostic::warning(problem.message), problem.place));
    }
}
