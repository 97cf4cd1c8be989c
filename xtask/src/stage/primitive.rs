//! The stage that adds a new primitive to a copy of the workspace, by the steps of CONTRIBUTING.md.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::new_primitive::{self, FOLDER};
use crate::outcome::Outcome;
use crate::process;
use crate::report::Counts;
use crate::repository::Repository;
use crate::workshop::Workshop;

/// The primitive that is added.
const NAME: &str = "bead";

/// Files of the copy: the shapes and their dependencies.
const COPIED: [&str; 7] = [
    "Cargo.toml",
    "Cargo.lock",
    "crates/bvh/",
    "crates/error/",
    "crates/math/",
    "crates/mesh/",
    "crates/shape/",
];

/// The tests of the new primitive, and those that run on all primitives without naming one.
const TESTS: [&str; 4] = ["primitive::bead", "pages_tell", "arguments_build", "bounds_hold"];

pub fn run(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    let root = workshop.repository.target().join("new-primitive");
    copy(workshop.repository, &root).map_err(|error| format!("{}: {error}", root.display()))?;
    let copy = Repository { root };
    new_primitive::run(&copy, NAME)?;
    register(&copy)?;
    // a separate target folder: cargo would mistake the crates of the copy for those of the
    // workspace, and the tests of the workspace would be out of date
    let built = workshop.repository.target().join("new-primitive-target");
    let mut cargo = Command::new("cargo");
    cargo.current_dir(&copy.root).env("CARGO_TARGET_DIR", built);
    cargo.args(["test", "--package", "rayweave-shape", "--lib", "--"]).args(TESTS);
    process::run_reading(&mut cargo, |line| counts.read_cargo_line(line))?;
    match counts.passed >= TESTS.len() as u64 {
        true => Ok(()),
        false => {
            Err(format!("only {} tests ran: at least one of each of {TESTS:?} is required", counts.passed))
        }
    }
}

/// Creates a workspace of the shape crates only, without the files of an earlier run.
fn copy(repository: &Repository, root: &Path) -> Result<(), String> {
    let text = |error: std::io::Error| error.to_string();
    if root.exists() {
        fs::remove_dir_all(root).map_err(text)?;
    }
    let files = repository.files()?;
    for path in files.iter().filter(|path| COPIED.iter().any(|copied| path.starts_with(copied))) {
        let place = root.join(path);
        fs::create_dir_all(place.parent().unwrap_or(root)).map_err(text)?;
        fs::copy(repository.root.join(path), &place).map_err(text)?;
    }
    let manifest = root.join("Cargo.toml");
    let whole = fs::read_to_string(&manifest).map_err(text)?;
    fs::write(&manifest, alone(&whole)).map_err(text)
}

/// The workspace's manifest with only the copied crates as members.
pub fn alone(manifest: &str) -> String {
    let members = |line: &str| match line.split('=').next().unwrap_or_default().trim() {
        "members" => "members = [\"crates/*\"]\n".to_owned(),
        "default-members" => String::new(),
        _ => format!("{line}\n"),
    };
    manifest.lines().map(members).collect()
}

/// Inserts the two lines after the lines of the sphere.
fn register(repository: &Repository) -> Outcome {
    let path = repository.root.join(FOLDER).join("mod.rs");
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut text = text;
    for (sphere, new) in new_primitive::registration("sphere").iter().zip(new_primitive::registration(NAME)) {
        if !text.contains(sphere) {
            return Err(format!(
                "{}: no line '{sphere}': the stage inserts its lines below it.",
                path.display()
            ));
        }
        text = text.replacen(sphere, &format!("{sphere}\n{new}"), 1);
    }
    fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_copy_has_no_other_members() {
        let manifest = "[workspace]\nresolver = \"3\"\nmembers = [\"crates/*\", \"xtask\"]\ndefault-members = [\"x\"]\n[x]\n";
        assert_eq!(alone(manifest), "[workspace]\nresolver = \"3\"\nmembers = [\"crates/*\"]\n[x]\n");
    }
}
