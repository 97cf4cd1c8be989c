//! Remarks on differences between a written file and the scene.

use std::fmt;

/// Kinds of remarks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RemarkKind {
    /// The same solid, expressed differently.
    Changed,
    /// An approximation of the solid.
    Approximated,
    /// Something other than geometry is missing.
    Dropped,
}

impl fmt::Display for RemarkKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            RemarkKind::Changed => "changed",
            RemarkKind::Approximated => "approximated",
            RemarkKind::Dropped => "dropped",
        })
    }
}

/// A difference, counted over all its occurrences.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// Kind of the difference.
    pub kind: RemarkKind,
    /// Description.
    pub what: String,
    /// Number of occurrences.
    pub count: usize,
    /// True for what the request implies: triangles within the tolerance, the rounding of the format, and the absence of colours
    /// that no file stated.
    pub is_expected: bool,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind, self.what)?;
        if self.count > 1 { write!(f, " ({} times)", self.count) } else { Ok(()) }
    }
}

/// Collects remarks in order of first occurrence.
#[derive(Debug, Default)]
pub(super) struct Remarks {
    all: Vec<Remark>,
}

impl Remarks {
    pub fn add(&mut self, kind: RemarkKind, what: impl Into<String>) {
        self.add_one(kind, what.into(), false);
    }

    /// Adds a remark on what the request implies.
    pub fn add_expected(&mut self, kind: RemarkKind, what: impl Into<String>) {
        self.add_one(kind, what.into(), true);
    }

    fn add_one(&mut self, kind: RemarkKind, what: String, is_expected: bool) {
        match self.all.iter_mut().find(|remark| remark.kind == kind && remark.what == what) {
            Some(remark) => remark.count += 1,
            None => self.all.push(Remark { kind, what, count: 1, is_expected }),
        }
    }

    pub fn finish(self) -> Vec<Remark> {
        self.all
    }
}
