//! What a file does not say as the scene did.

use std::fmt;

/// The sorts of remarks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RemarkKind {
    /// The same solid in other words.
    Changed,
    /// Something near to it.
    Approximated,
    /// Something that is no part of the geometry is gone.
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

/// Something that was written in another way, once or several times.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// What became of it.
    pub kind: RemarkKind,
    /// What it is, in words.
    pub what: String,
    /// How many there are.
    pub count: usize,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind, self.what)?;
        if self.count > 1 { write!(f, " ({} times)", self.count) } else { Ok(()) }
    }
}

/// Collects remarks, in the order in which they were first made.
#[derive(Debug, Default)]
pub(super) struct Remarks {
    all: Vec<Remark>,
}

impl Remarks {
    pub fn add(&mut self, kind: RemarkKind, what: impl Into<String>) {
        let what = what.into();
        match self.all.iter_mut().find(|remark| remark.kind == kind && remark.what == what) {
            Some(remark) => remark.count += 1,
            None => self.all.push(Remark { kind, what, count: 1 }),
        }
    }

    pub fn finish(self) -> Vec<Remark> {
        self.all
    }
}
