//! The work and the memory that a dump may take, together with the files that it refers to.

use rayweave_scene::Diagnostic;
use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Steps that every file may take, and more for each of its bytes. A step takes about a nanosecond in a release build.
const STEPS: u64 = 2_000_000_000;
const STEPS_PER_BYTE: u64 = 1000;

/// Points and triangles that every file may have, and the number of bytes per additional one. Each takes a few hundred
/// bytes until the scene is complete.
const ITEMS: u64 = 1_500_000;
const BYTES_PER_ITEM: u64 = 8;

/// The cost of an edge, or of a pair of edges that may cross, in a boolean operation on regions.
pub(super) const EDGE: usize = 150;
pub(super) const CROSSING: usize = 800;

/// The cost of a corner of a region in a formula of half-planes or half-spaces.
pub(super) const CORNER: usize = 1000;

/// The cost of a triangle in the solid inside a mesh, and in an operation of the mesh kernel.
pub(super) const TRIANGLE: usize = 1000;
pub(super) const KERNEL_TRIANGLE: usize = 1500;

/// Counters that all items of a file share. Work is counted, not timed, so that results do not depend on the machine.
#[derive(Debug)]
pub(super) struct Budget {
    steps: Cell<u64>,
    most_steps: Cell<u64>,
    items: Cell<u64>,
    most_items: Cell<u64>,
    /// Files that have been counted.
    files: RefCell<HashSet<PathBuf>>,
    /// The first refusal because of a limit.
    exceeded: RefCell<Option<Diagnostic>>,
}

/// The reason why an item cannot be read within the budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Exceeded {
    Steps,
    Items,
}

impl Exceeded {
    pub fn reason(self) -> &'static str {
        match self {
            Exceeded::Steps => "the items up to here would together take too long",
            Exceeded::Items => "the items up to here together have too many points and facets",
        }
    }
}

impl From<Exceeded> for String {
    fn from(exceeded: Exceeded) -> String {
        exceeded.reason().to_owned()
    }
}

impl Budget {
    /// The budget of a text with a number of bytes.
    pub fn new(bytes: usize) -> Budget {
        let budget = Budget {
            steps: Cell::new(0),
            most_steps: Cell::new(STEPS),
            items: Cell::new(0),
            most_items: Cell::new(ITEMS),
            files: RefCell::default(),
            exceeded: RefCell::default(),
        };
        budget.grow(bytes as u64);
        budget
    }

    fn grow(&self, bytes: u64) {
        self.most_steps.set(self.most_steps.get().saturating_add(bytes.saturating_mul(STEPS_PER_BYTE)));
        self.most_items.set(self.most_items.get().saturating_add(bytes / BYTES_PER_ITEM));
    }

    /// Counts the reading of another file, which also adds to the budget, once even if the dump refers to it repeatedly.
    pub fn read_file(&self, path: &Path, bytes: u64) -> Result<(), Exceeded> {
        if self.files.borrow_mut().insert(path.to_owned()) {
            self.grow(bytes);
        }
        // bytes are copied, decoded and searched for tokens
        self.spend(usize::try_from(bytes).unwrap_or(usize::MAX).saturating_mul(100))
    }

    /// The number of steps so far.
    #[cfg(test)]
    pub fn used(&self) -> u64 {
        self.steps.get()
    }

    /// Counts steps.
    pub fn spend(&self, steps: usize) -> Result<(), Exceeded> {
        self.steps.set(self.steps.get().saturating_add(steps as u64));
        match self.steps.get() > self.most_steps.get() {
            true => Err(Exceeded::Steps),
            false => Ok(()),
        }
    }

    /// Counts points or triangles before they are made.
    pub fn hold(&self, items: usize) -> Result<(), Exceeded> {
        self.items.set(self.items.get().saturating_add(items as u64));
        match self.items.get() > self.most_items.get() {
            true => Err(Exceeded::Items),
            false => Ok(()),
        }
    }

    /// Keeps the first refusal because of a limit.
    pub fn note(&self, refusal: &Diagnostic) {
        self.exceeded.borrow_mut().get_or_insert_with(|| refusal.clone());
    }

    /// The first refusal because of a limit, after which the file cannot be read.
    pub fn exceeded(&self) -> Option<Diagnostic> {
        self.exceeded.borrow().clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_counts_once_as_a_share_and_each_time_as_work() {
        let budget = Budget::new(0);
        let before = budget.most_steps.get();
        let path = Path::new("part.svg");
        for _ in 0..3 {
            assert_eq!(budget.read_file(path, 1000), Ok(()));
        }
        assert_eq!(budget.most_steps.get() - before, 1000 * STEPS_PER_BYTE);
        assert_eq!(budget.steps.get(), 3 * 100_000);
    }

    #[test]
    fn counters_do_not_overflow() {
        let budget = Budget::new(usize::MAX);
        assert_eq!(Budget::new(0).hold(usize::MAX), Err(Exceeded::Items));
        let small = Budget::new(10);
        assert_eq!(small.spend(usize::MAX), Err(Exceeded::Steps));
        assert_eq!(small.spend(usize::MAX), Err(Exceeded::Steps));
        assert_eq!(budget.spend(1), Ok(()));
    }
}
