//! `cargo xtask golden`: compares the pictures of models and pages with those that somebody has looked at, or accepts them.

use std::process::Command;

use lexopt::prelude::*;

use crate::repository::Repository;
use crate::{Outcome, process, usage};

/// The variable that makes the test write pictures instead of comparing them.
const ACCEPT: &str = "RAYWEAVE_ACCEPT_GOLDEN";

/// Runs the test of golden pictures; with `--accept` it writes them.
pub fn run(repository: &Repository, mut arguments: lexopt::Parser) -> Outcome {
    let mut accept = false;
    while let Some(argument) = arguments.next().map_err(|error| usage(&error.to_string()))? {
        match argument {
            Long("accept") => accept = true,
            other => return Err(usage(&other.unexpected().to_string())),
        }
    }
    let mut cargo = Command::new("cargo");
    // pictures are drawn several times faster by the release build, which is to give the same bits
    cargo.current_dir(&repository.root).args(["test", "--package", "rayweave", "--test", "golden"]);
    cargo.args(["--test", "concepts"]);
    cargo.arg("--release").env_remove(ACCEPT);
    if accept {
        cargo.env(ACCEPT, "1");
    }
    process::run(&mut cargo)?;
    if accept {
        println!("accepted: look at what 'git status' lists under models/, tests/golden/ and docs/");
    }
    Ok(())
}
