//! Errors in a piece of text whose position in the file is not yet known.

use crate::diagnostic::Diagnostic;
use crate::source::{Source, Span};
use std::sync::Arc;

/// An error at a position in a piece of text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    pub span: Span,
    pub problem: String,
    pub reason: String,
    pub suggestion: Option<String>,
}

impl Fault {
    pub fn new(span: Span, problem: impl Into<String>, reason: impl Into<String>) -> Fault {
        Fault { span, problem: problem.into(), reason: reason.into(), suggestion: None }
    }

    pub fn suggest(mut self, suggestion: Option<String>) -> Fault {
        self.suggestion = suggestion;
        self
    }

    /// The diagnostic of a fault in a text, which is the string value at `span` of a source.
    pub fn located(self, source: &Arc<Source>, text: &str, span: Span) -> Diagnostic {
        Diagnostic::error(self.problem)
            .why(self.reason)
            .suggest(self.suggestion)
            .at(source, place_in(source, text, span, self.span))
    }
}

/// The span in the file of a part of a string value; the whole value if it is written with escapes.
pub(crate) fn place_in(source: &Source, text: &str, value: Span, part: Span) -> Span {
    // the text follows no quotation mark, one, three, or three and a line end; searching would take linear time for each fault
    let begins = |at: &usize| source.slice(value).get(*at..).is_some_and(|rest| rest.starts_with(text));
    match [0, 1, 3, 4, 5].into_iter().find(begins) {
        Some(at) if !text.is_empty() => part.shifted(value.start() + at),
        _ => value,
    }
}
