//! Counts of checks and failures.

use std::fmt::Display;

/// The number of checks and of failures, with messages for the first few failures.
#[derive(Debug)]
pub struct Tally {
    what: &'static str,
    asked: u64,
    failed: u64,
    first: Vec<String>,
}

impl Tally {
    /// A tally without checks.
    pub fn new(what: &'static str) -> Tally {
        Tally { what, asked: 0, failed: 0, first: Vec::new() }
    }

    /// Counts one check; the message is made for the first few failures only.
    pub fn check<M: Display>(&mut self, right: bool, message: impl FnOnce() -> M) {
        self.asked += 1;
        if !right {
            self.failed += 1;
            if self.first.len() < 3 {
                self.first.push(message().to_string());
            }
        }
    }

    /// The number of checks.
    pub fn asked(&self) -> u64 {
        self.asked
    }

    /// Panics if there is any failure, with the rate and the first messages, or if there were fewer than
    /// `least` checks.
    pub fn finish(self, least: u64) {
        let Tally { what, asked, failed, first } = self;
        assert!(failed == 0, "{what}: {failed} of {asked} wrong\n{}", first.join("\n---\n"));
        assert!(asked >= least, "{what}: only {asked} asked, {least} meant");
        println!("{what}: 0 of {asked} wrong");
    }
}
