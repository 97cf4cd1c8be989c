//! The state of the evaluation of a document.

use crate::diagnostic::Diagnostic;
use crate::document::Document;
use crate::source::Span;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// The document, and the list of problems.
pub(crate) struct Context<'d> {
    pub document: &'d Document,
    pub problems: Vec<Diagnostic>,
    /// Names in the file whose definitions are invalid.
    pub unreadable: &'d HashSet<String>,
    /// The number of copies that short text and repeated names of files describe.
    copies: u64,
    /// The files of placements so far.
    files: HashSet<PathBuf>,
}

/// The maximum number of copies of all placements that are not listed one by one. A copy takes 400 bytes until the model is compiled,
/// so that a short file cannot take more than a gigabyte.
pub(super) const MAX_COPIES: u32 = 1 << 21;

/// The name of the medium around everything.
pub const WORLD: &str = "world";

impl<'d> Context<'d> {
    /// The state before the evaluation, with the problems so far.
    pub fn new(document: &'d Document, problems: Vec<Diagnostic>, unreadable: &'d HashSet<String>) -> Self {
        Context { document, problems, unreadable, copies: 0, files: HashSet::new() }
    }

    /// Counts copies before they are made. False if the document has too many, which is reported once.
    pub fn count_copies(&mut self, copies: u64, span: Span) -> bool {
        let is_first = self.has_copies_left();
        self.copies = self.copies.saturating_add(copies);
        if !self.has_copies_left() && is_first {
            let problem = format!("the placements up to here have more than {MAX_COPIES} copies");
            let reason = "grids, rings and repeated files may describe that many in all";
            self.push(Diagnostic::error(problem).why(reason), span);
        }
        self.has_copies_left()
    }

    /// False if the document has too many copies.
    pub fn has_copies_left(&self) -> bool {
        self.copies <= u64::from(MAX_COPIES)
    }

    /// True if a file of placements is named for the first time. Its copies are then not counted, as they are listed one by one.
    pub fn is_new_file(&mut self, path: &Path) -> bool {
        // a path that leads nowhere is reported when it is read
        self.files.insert(path.canonicalize().unwrap_or_default())
    }

    /// Reports a problem at a position in the document.
    pub fn push(&mut self, problem: Diagnostic, span: Span) {
        self.problems.push(problem.at(&self.document.source, span));
    }

    /// True for a name in the file whose definition is invalid.
    pub fn is_unreadable(&self, name: &str) -> bool {
        self.unreadable.contains(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grids, rings and files that are named repeatedly share one limit, and its excess is one error.
    #[test]
    fn copies_have_one_limit() {
        let (document, _) = crate::parse("rayweave = 1").expect("an empty document");
        let unreadable = HashSet::new();
        let mut context = Context::new(&document, Vec::new(), &unreadable);
        let span = Span::default();
        assert!(context.count_copies(u64::from(MAX_COPIES), span) && context.problems.is_empty());
        assert!(!context.count_copies(1, span) && !context.count_copies(u64::MAX, span));
        assert!(!context.has_copies_left());
        let message = format!("{:?}", context.problems);
        assert!(context.problems.len() == 1 && message.contains("more than 2097152 copies"), "{message}");
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
        let [first, same] = ["Cargo.toml", "src/../Cargo.toml"].map(|name| manifest.join(name));
        assert!(context.is_new_file(&first) && !context.is_new_file(&same));
    }
}
