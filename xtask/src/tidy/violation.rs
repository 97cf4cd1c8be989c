//! Rules, and the places at which they are violated.

use std::fmt;

use crate::repository::Source;

/// A rule: its name in the list of exceptions, and its reason.
pub struct Rule {
    pub name: &'static str,
    pub why: &'static str,
}

/// A violation of a rule.
pub struct Violation {
    pub rule: &'static Rule,
    pub path: String,
    pub line: usize,
    /// The function or other item of the violation; empty for the file as a whole.
    pub item: String,
    pub problem: String,
    pub suggestion: String,
    pub severity: Severity,
}

/// The severity of a violation: an error fails the check.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    Warning,
    Error,
}

impl Violation {
    /// Creates an error at a line of a file, counted from 1.
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

    /// Sets the item.
    pub fn about(mut self, item: &str) -> Violation {
        item.clone_into(&mut self.item);
        self
    }

    /// Makes it a warning.
    pub fn mild(mut self) -> Violation {
        self.severity = Severity::Warning;
        self
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Violation { rule, path, line, problem, suggestion, severity, .. } = self;
        let mild = if *severity == Severity::Warning { "warning: " } else { "" };
        let (first, rest) = suggestion.split_at(suggestion.chars().next().map_or(0, char::len_utf8));
        let suggestion = first.to_uppercase() + rest;
        write!(formatter, "{path}:{line}: {mild}{problem}: {}. {suggestion}.", rule.why)
    }
}
