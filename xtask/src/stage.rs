//! The stages of `cargo xtask test`, in order.

mod cargo;
mod command;
mod examples;
mod package;
mod primitive;

use crate::outcome::Outcome;
use crate::report::Counts;
use crate::workshop::Workshop;
use crate::{features, layers, lean, licences, mutants, platforms, tidy, workflows};

pub use primitive::alone;

/// One stage.
pub struct Stage {
    /// The name in `--only` and `--skip`.
    pub name: &'static str,
    /// A description in one line.
    pub what: &'static str,
    /// True if the stage runs only with `--long`.
    pub long: bool,
    /// The function that runs it. A stage without tests of its own counts as one test.
    pub run: fn(&mut Workshop<'_>, &mut Counts) -> Outcome,
}

/// All stages: cheap ones first, and stages that share build products next to each other.
pub const STAGES: &[Stage] = &[
    stage("fmt", "the code is formatted", cargo::fmt),
    stage("tidy", "the text of all files", |workshop, _| tidy::run(workshop.repository)),
    stage("workflows", "the workflows of continuous integration", |workshop, counts| {
        workflows::run(workshop.repository, counts)
    }),
    stage("layers", "the crates' dependencies", |workshop, _| {
        layers::run(workshop.repository)?;
        lean::run(workshop.repository)?;
        features::run(workshop.repository)
    }),
    stage("deny", "licences and sources of all dependencies", cargo::deny),
    stage("advisories", "no dependency has a known vulnerability", cargo::advisories),
    stage("licences", "the licence files of the Python package", |workshop, _| {
        licences::check(workshop.repository, false)
    }),
    stage("clippy", "the linter reports nothing", cargo::clippy),
    stage("docs", "the documentation builds without warnings", cargo::docs),
    stage("rust", "unit tests, integration tests and documentation tests of all crates", cargo::tests),
    stage(
        "gpu",
        "the crate for graphics cards and the command with them, where a Vulkan driver is installed",
        cargo::gpu,
    ),
    stage("primitive", "a new primitive, added as CONTRIBUTING.md says, compiles and works", primitive::run),
    Stage { name: "long", what: "the ignored tests of the long mode", long: true, run: cargo::long_tests },
    Stage {
        name: "platforms",
        what: "the code compiles for Windows and macOS",
        long: true,
        run: |workshop, counts| platforms::run(workshop.repository, counts),
    },
    Stage {
        name: "mutants",
        what: "each process of photons, broken on purpose, fails a test",
        long: true,
        run: |workshop, counts| mutants::run(workshop.repository, &[], counts),
    },
    stage("command", "the command, on real models", command::run),
    stage(
        "python",
        "the Python package, built, installed in a fresh environment, tested and typed",
        package::run,
    ),
    Stage {
        name: "gpu-python",
        what: "the argument `device` of the Python package, built for graphics cards, where a Vulkan driver is installed",
        long: true,
        run: package::gpu,
    },
    stage("examples", "every example runs to its end", examples::run),
];

/// A stage of the standard mode.
const fn stage(
    name: &'static str,
    what: &'static str,
    run: fn(&mut Workshop<'_>, &mut Counts) -> Outcome,
) -> Stage {
    Stage { name, what, long: false, run }
}
