//! `cargo xtask dist`: the files of a release in `dist/`, and a check of each as its user: installed in a clean environment, it runs
//! the examples of the README.
//!
//! The same call works on Linux, macOS and Windows and makes the files for that system. On Linux it also makes those for the other
//! processor: the wheels with zig as the linker, which knows the symbols of old versions of glibc, the commands with the linker and
//! the C library (musl) that come with Rust.

mod check;
mod command;
mod elf;
mod local_paths;
mod release;
mod sbom;
mod sdist;
mod wheel;

use lexopt::prelude::*;

use crate::dependencies;
use crate::outcome::{Outcome, usage};
use crate::process;
use crate::python::remove_old;
use crate::repository::Repository;
use release::{Dist, make, write};

/// The parts of a release.
const PARTS: [&str; 4] = ["command", "wheel", "sdist", "sbom"];

/// Builds and checks the parts that the command line selects.
pub fn run(repository: &Repository, mut arguments: lexopt::Parser) -> Outcome {
    let (mut parts, mut targets) = (Vec::new(), Vec::new());
    let (mut builds, mut checks, mut add_targets, mut fast) = (true, true, false, false);
    let text = |value: Result<std::ffi::OsString, lexopt::Error>| -> Result<String, String> {
        value.and_then(|value| value.string()).map_err(|error| usage(&error.to_string()))
    };
    while let Some(argument) = arguments.next().map_err(|error| usage(&error.to_string()))? {
        match argument {
            Long("only") => parts.push(known_part(text(arguments.value())?)?),
            Long("target") => targets.push(text(arguments.value())?),
            Long("add-targets") => add_targets = true,
            Long("fast") => fast = true,
            Long("check") => builds = false,
            Long("no-check") => checks = false,
            other => return Err(usage(&other.unexpected().to_string())),
        }
    }
    let mut dist = Dist { add_targets, fast, ..Dist::new(repository, parts, targets)? };
    if builds {
        build(&mut dist)?;
    }
    if checks {
        check::run(&mut dist)?;
    }
    Ok(())
}

fn build(dist: &mut Dist<'_>) -> Outcome {
    if dist.parts.is_empty() && dist.targets.is_empty() {
        remove_old(&dist.folder)?;
    }
    make(&dist.for_python())?;
    if dist.has("sbom") {
        write_sboms(dist)?;
    }
    if dist.has("command") {
        for target in dist.targets(command::targets()) {
            command::build(dist, &target)?;
        }
    }
    if dist.has("wheel") {
        for target in dist.targets(wheel::targets()) {
            wheel::build(dist, &target)?;
        }
    }
    if dist.has("sdist") {
        sdist::build(dist)?;
    }
    let (folder, sums) = (dist.folder.clone(), dist.checksums());
    process::run(dist.script("archive.py")?.arg("sums").args([folder, sums]))
}

/// The lists of the crates in the command and in the Python package.
fn write_sboms(dist: &Dist<'_>) -> Outcome {
    let root = &dist.repository.root;
    let metadata = dependencies::metadata(root)?;
    let lock = dist.repository.source("Cargo.lock")?.ok_or("Cargo.lock is not text.")?.text;
    for (package, name) in [("rayweave-cli", "command"), ("rayweave-python", "python")] {
        let path = dist.folder.join(format!("rayweave-{}-{name}.cdx.json", dist.version));
        let list = sbom::write(&metadata, &dependencies::compiled(root, &[package])?, &lock, package)?;
        write(&path, &(serde_json::to_string_pretty(&list).map_err(|error| error.to_string())? + "\n"))?;
    }
    Ok(())
}

fn known_part(name: String) -> Result<String, String> {
    match PARTS.contains(&name.as_str()) {
        true => Ok(name),
        false => Err(usage(&format!("no part '{name}' of a release: the parts are {}", PARTS.join(", ")))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_parts_are_rejected_with_the_known_ones() {
        assert_eq!(known_part("wheel".to_owned()).unwrap(), "wheel");
        assert!(known_part("wheels".to_owned()).unwrap_err().contains("command, wheel, sdist, sbom"));
    }
}
