//! Rules and the places where they are broken.

use std::fmt;

use crate::repository::Source;

/// A rule: its name in the list of exceptions, and why it is there.
pub struct Rule {
    pub name: &'static str,
    pub why: &'static str,
}

/// One place where a rule is broken.
pub struct Violation {
    pub rule: &'static Rule,
    pub path: String,
    pub line: usize,
    /// The function or other item, where the rule is about one; else empty.
    pub item: String,
    pub problem: String,
    pub suggestion: String,
    pub severity: Severity,
}

/// Whether a violation fails the check.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    Warning,
    Error,
}

impl Violation {
    /// An error at a line of a file, the first line being 1.
    pub fn new(
        rule: &'static Rule,
        source: &Source,
        line: usize,
        problem: String,
        suggestion: &str,
    ) -> Violation {
        let (path, item, suggestion) = (source.path.clone(), String::new(), suggestion.to_owned());
        Violation { rule, path, line, item, problem, suggestion, severity: Severity::Error }
    }

    /// The same about one item of the file.
    pub fn about(mut self, item: &str) -> Violation {
        item.clone_into(&mut self.item);
        self
    }

    /// The same, but only a warning.
    pub fn mild(mut self) -> Violation {
        self.severity = Severity::Warning;
        self
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Violation { rule, path, line, problem, suggestion, severity, .. } = self;
        let mild = if *severity == Severity::Warning { "warning: " } else { "" };
        write!(formatter, "{path}:{line}: {mild}{problem} ({}) {suggestion}", rule.why)
    }
}
