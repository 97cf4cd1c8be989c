//! `cargo xtask platforms`: the code, with its tests and examples, compiles for other systems. A stage of `--long`.

use std::path::Path;
use std::process::Command;

use crate::outcome::Outcome;
use crate::process;
use crate::report::Counts;
use crate::repository::Repository;

/// One target for each other system.
const TARGETS: [&str; 2] = ["x86_64-pc-windows-gnu", "aarch64-apple-darwin"];

/// Packages that contain C code, which needs a C compiler for each system: the workflows compile them there.
const WITH_C: [&str; 2] = ["rayweave-python", "rayweave-bench"];

/// Checks the targets whose standard library is installed. Warnings are errors: code for one system often leaves something unused on
/// the others.
pub fn run(repository: &Repository, counts: &mut Counts) -> Outcome {
    for target in TARGETS {
        let folder =
            process::output(Command::new("rustc").args(["--print", "target-libdir", "--target", target]))?;
        if !Path::new(folder.trim()).is_dir() {
            println!(
                "SKIPPED: the standard library of {target} is not installed. Run rustup target add {target}."
            );
            counts.skipped += 1;
            continue;
        }
        let mut cargo = Command::new("cargo");
        cargo.current_dir(&repository.root).args([
            "check",
            "--workspace",
            "--all-targets",
            "--target",
            target,
        ]);
        cargo.args(WITH_C.iter().flat_map(|package| ["--exclude", package]));
        let warned = std::cell::Cell::new(false);
        process::run_reading(&mut cargo, |line| warned.set(warned.get() || line.starts_with("warning: ")))?;
        if warned.get() {
            return Err(format!("{target}: the compiler warns."));
        }
        counts.passed += 1;
    }
    Ok(())
}
