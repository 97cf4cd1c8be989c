//! A document while it is resolved.

use crate::diagnostic::Diagnostic;
use crate::document::Document;
use crate::source::Span;
use std::collections::HashSet;

/// The document, and where problems are collected.
pub(crate) struct Context<'d> {
    pub document: &'d Document,
    pub problems: Vec<Diagnostic>,
    /// Names that stand in the file but could not be read.
    pub unreadable: &'d HashSet<String>,
}

impl Context<'_> {
    /// Reports a problem at a place of the document.
    pub fn push(&mut self, problem: Diagnostic, span: Span) {
        self.problems.push(problem.at(&self.document.source, span));
    }

    /// True for a name that stands in the file but could not be read.
    pub fn is_unreadable(&self, name: &str) -> bool {
        self.unreadable.contains(name)
    }
}
