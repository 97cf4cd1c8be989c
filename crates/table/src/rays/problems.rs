//! Problems of ray files, with their locations.

use super::columns::COLUMNS;
use crate::error::{RayProblem, RayProblems, TableError};
use std::io;
use std::path::Path;

/// List of problems up to the limit.
pub(super) struct ProblemList {
    pub list: RayProblems,
}

impl ProblemList {
    pub fn new(file: String) -> Self {
        Self { list: RayProblems { file, problems: Vec::new(), stopped: false } }
    }

    pub fn add(&mut self, problem: RayProblem) {
        if self.list.problems.len() < RayProblems::LIMIT {
            self.list.problems.push(problem);
        } else {
            self.list.stopped = true;
        }
    }

    pub fn is_empty(&self) -> bool {
        self.list.problems.is_empty()
    }

    /// True if the limit was exceeded.
    pub fn is_full(&self) -> bool {
        self.list.stopped
    }

    pub fn take(&mut self) -> RayProblems {
        let file = self.list.file.clone();
        std::mem::replace(&mut self.list, Self::new(file).list)
    }

    pub fn read_error(&self, error: io::Error) -> TableError {
        TableError::io("read", Path::new(&self.list.file), error)
    }
}

/// The location of a ray in its file.
#[derive(Clone, Copy)]
pub(super) struct RayLocation {
    pub line: Option<u64>,
    pub row: u64,
}

impl RayLocation {
    pub fn problem(self, column: Option<usize>, message: String) -> RayProblem {
        RayProblem {
            line: self.line,
            row: Some(self.row),
            column: column.map(|column| COLUMNS[column]),
            message,
        }
    }
}
