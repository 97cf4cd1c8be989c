//! Problems of contour files.

use rayweave_error::{Classified, ErrorKind};
use std::fmt;

/// The problems of a file of contours, at least one, with line numbers where they apply.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourProblems {
    pub(super) file: String,
    pub(super) problems: Vec<(Option<usize>, String)>,
}

impl fmt::Display for ContourProblems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, (line, problem)) in self.problems.iter().enumerate() {
            let end_of_last = if k == 0 { "" } else { "\n" };
            let place = line.map(|line| format!("{line}: ")).unwrap_or_else(|| " ".to_owned());
            write!(f, "{end_of_last}{}:{place}{problem}", self.file)?;
        }
        Ok(())
    }
}

impl std::error::Error for ContourProblems {}

impl Classified for ContourProblems {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}
