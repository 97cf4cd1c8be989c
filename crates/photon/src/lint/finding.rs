//! Findings of the lint.

use rayweave_error::Message;
use std::fmt;

/// A probable mistake in the optical part of a detector.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LintFinding {
    /// The place of the element or property, as `file:line:column`, if it is known.
    pub place: Option<String>,
    /// True for input without an effect: no process uses it.
    pub is_unused: bool,
    /// The problem, its reason and a suggestion.
    pub message: Message,
}

impl fmt::Display for LintFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => self.message.fmt(f),
        }
    }
}
