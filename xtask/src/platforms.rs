//! `cargo xtask platforms`: the code compiles for other systems. A stage of `--long`.

use std::path::Path;
use std::process::Command;

use crate::outcome::Outcome;
use crate::process;
use crate::report::Counts;
use crate::repository::Repository;

/// One target for each other system, and whether its tests are compiled, too: those of macOS depend on a crate with code in assembly
/// language (npyz, by psm), which needs a compiler for that system.
const TARGETS: [(&str, bool); 2] = [("x86_64-pc-windows-gnu", true), ("aarch64-apple-darwin", false)];

/// Packages that are left to the workflows on those systems: two contain C code, which needs a C compiler for each system, and the
/// dependencies of the third take long.
const EXCLUDED: [&str; 3] = ["rayweave-python", "rayweave-bench", "rayweave-gpu"];

/// Checks the targets whose standard library is installed. Warnings are errors: code for one system often leaves something unused on
/// the others.
pub fn run(repository: &Repository, counts: &mut Counts) -> Outcome {
    for (target, with_tests) in TARGETS {
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
        cargo.current_dir(&repository.root).args(["check", "--workspace", "--target", target]);
        cargo.args(with_tests.then_some("--all-targets"));
        cargo.args(EXCLUDED.iter().flat_map(|package| ["--exclude", package]));
        let warned = std::cell::Cell::new(false);
        process::run_reading(&mut cargo, |line| warned.set(warned.get() || line.starts_with("warning: ")))?;
        if warned.get() {
            return Err(format!("{target}: the compiler warns."));
        }
        counts.passed += 1;
    }
    Ok(())
}
