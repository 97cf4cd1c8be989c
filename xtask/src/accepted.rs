//! `cargo xtask golden`, `answers` and `generated`: tests that compare results with accepted ones, or accept new ones.

use std::process::Command;

use lexopt::prelude::*;

use crate::outcome::{Outcome, usage};
use crate::process;
use crate::repository::Repository;

/// Tests that compare results with files of the repository.
pub struct Accepted {
    /// The integration tests of the package `rayweave`.
    tests: &'static [&'static str],
    /// The environment variable that makes the tests write the files instead of comparing them.
    variable: &'static str,
    /// The next step after acceptance.
    next: &'static str,
}

/// Rendered pictures of models and of documentation pages.
pub const GOLDEN: Accepted = Accepted {
    tests: &["--test", "golden", "--test", "concepts"],
    variable: "RAYWEAVE_ACCEPT_GOLDEN",
    next: "look at every picture that 'git status' lists under models/, tests/golden/ and docs/",
};

/// Hashes of answers, for refactorings that must not change any.
pub const ANSWERS: Accepted = Accepted {
    tests: &["--test", "answers"],
    variable: "RAYWEAVE_ACCEPT_ANSWERS",
    next: "explain every line that 'git diff tests/answers.txt' shows in the commit message",
};

/// Sources and pages that are generated from the registry of primitives.
pub const GENERATED: Accepted = Accepted {
    tests: &["--test", "generated"],
    variable: "RAYWEAVE_ACCEPT_GENERATED",
    next: "review 'git diff'",
};

/// Runs the tests; with `--accept` they write their files and print what changed.
pub fn run(repository: &Repository, accepted: &Accepted, arguments: lexopt::Parser) -> Outcome {
    let accept = accept_flag(arguments)?;
    let mut cargo = Command::new("cargo");
    // the release build is several times faster and must give the same results, to the bit
    cargo.current_dir(&repository.root).args(["test", "--release", "--package", "rayweave"]);
    cargo.args(accepted.tests).env_remove(accepted.variable);
    if accept {
        // the tests write to the same file, and print the changes
        cargo.env(accepted.variable, "1").args(["--", "--nocapture", "--test-threads=1"]);
    }
    process::run(&mut cargo)?;
    if accept {
        println!("accepted: {}", accepted.next);
    }
    Ok(())
}

/// Parses the only argument, `--accept`.
pub fn accept_flag(mut arguments: lexopt::Parser) -> Result<bool, String> {
    let mut accept = false;
    while let Some(argument) = arguments.next().map_err(|error| usage(&error.to_string()))? {
        match argument {
            Long("accept") => accept = true,
            other => return Err(usage(&other.unexpected().to_string())),
        }
    }
    Ok(accept)
}
