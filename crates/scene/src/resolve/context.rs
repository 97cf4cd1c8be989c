//! The state of the evaluation of a document.

use crate::diagnostic::Diagnostic;
use crate::document::Document;
use crate::source::Span;
use std::collections::HashSet;

/// The document, and the list of problems.
pub(crate) struct Context<'d> {
    pub document: &'d Document,
    pub problems: Vec<Diagnostic>,
    /// Names in the file whose definitions are invalid.
    pub unreadable: &'d HashSet<String>,
}

impl Context<'_> {
    /// Reports a problem at a position in the document.
    pub fn push(&mut self, problem: Diagnostic, span: Span) {
        self.problems.push(problem.at(&self.document.source, span));
    }

    /// True for a name in the file whose definition is invalid.
    pub fn is_unreadable(&self, name: &str) -> bool {
        self.unreadable.contains(name)
    }
}
