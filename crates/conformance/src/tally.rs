//! Counts of checks and failures.

use std::fmt::Display;

/// The number of checks and of failures, with messages for the first few failures.
#[derive(Debug)]
pub struct Tally {
    what: &'static str,
    checked: u64,
    failed: u64,
    first: Vec<String>,
}

impl Tally {
    /// A tally without checks.
    pub fn new(what: &'static str) -> Tally {
        Tally { what, checked: 0, failed: 0, first: Vec::new() }
    }

    /// Counts one check; the message is made for the first few failures only.
    pub fn check<M: Display>(&mut self, right: bool, message: impl FnOnce() -> M) {
        self.checked += 1;
        if !right {
            self.failed += 1;
            if self.first.len() < 3 {
                self.first.push(message().to_string());
            }
        }
    }

    /// The number of checks.
    pub fn checked(&self) -> u64 {
        self.checked
    }

    /// Panics if there is any failure, with the rate and the first messages, or if there were fewer than
    /// `least` checks.
    pub fn finish(self, least: u64) {
        let Tally { what, checked, failed, first } = self;
        assert!(failed == 0, "{what}: {failed} of {checked} wrong\n{}", first.join("\n---\n"));
        assert!(checked >= least, "{what}: only {checked} checks, at least {least} expected");
        println!("{what}: 0 of {checked} wrong");
    }
}
