//! Counting how often a promise is kept.

use std::fmt::Display;

/// How often something was asked and how often the answer was wrong, with the first few wrong ones.
#[derive(Debug)]
pub struct Tally {
    what: &'static str,
    asked: u64,
    failed: u64,
    first: Vec<String>,
}

impl Tally {
    /// Nothing asked yet.
    pub fn new(what: &'static str) -> Tally {
        Tally { what, asked: 0, failed: 0, first: Vec::new() }
    }

    /// Counts one answer; the message is made only for the first few that are wrong.
    pub fn check<M: Display>(&mut self, right: bool, message: impl FnOnce() -> M) {
        self.asked += 1;
        if !right {
            self.failed += 1;
            if self.first.len() < 3 {
                self.first.push(message().to_string());
            }
        }
    }

    /// The number of answers.
    pub fn asked(&self) -> u64 {
        self.asked
    }

    /// Panics, with the rate and the first failures, if there is any or if fewer than `least` were asked.
    pub fn finish(self, least: u64) {
        let Tally { what, asked, failed, first } = self;
        assert!(failed == 0, "{what}: {failed} of {asked} wrong\n{}", first.join("\n---\n"));
        assert!(asked >= least, "{what}: only {asked} asked, {least} meant");
        println!("{what}: 0 of {asked} wrong");
    }
}
