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
mod sbom;
mod sdist;
mod wheel;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use lexopt::prelude::*;

use crate::dependencies;
use crate::outcome::{Outcome, usage};
use crate::process;
use crate::publish;
use crate::python::{Python, remove_old};
use crate::repository::Repository;
use local_paths::LocalPaths;

/// The parts of a release.
const PARTS: [&str; 4] = ["command", "wheel", "sdist", "sbom"];

/// Other values of the settings of an optimised build that take longest.
const FAST_BUILD: [(&str, &str); 3] = [
    ("CARGO_PROFILE_RELEASE_LTO", "off"),
    ("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0"),
    ("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16"),
];

/// The files of a release in the making.
struct Dist<'a> {
    repository: &'a Repository,
    /// The folder of the finished files.
    folder: PathBuf,
    /// The folder of intermediate files, with cargo's target folder of these builds.
    work: PathBuf,
    local: LocalPaths,
    python: Python,
    version: String,
    parts: Vec<String>,
    targets: Vec<String>,
    /// True if missing standard libraries are installed.
    add_targets: bool,
    /// True for a trial, without optimisation: builds take less time, and the programs are slow.
    fast: bool,
}

/// Builds and checks the parts that the command line selects.
pub fn run(repository: &Repository, mut arguments: lexopt::Parser) -> Outcome {
    let (mut parts, mut targets) = (Vec::new(), Vec::new());
    let (mut build, mut check, mut add_targets, mut fast) = (true, true, false, false);
    let text = |value: Result<std::ffi::OsString, lexopt::Error>| -> Result<String, String> {
        value.and_then(|value| value.string()).map_err(|error| usage(&error.to_string()))
    };
    while let Some(argument) = arguments.next().map_err(|error| usage(&error.to_string()))? {
        match argument {
            Long("only") => parts.push(known_part(text(arguments.value())?)?),
            Long("target") => targets.push(text(arguments.value())?),
            Long("add-targets") => add_targets = true,
            Long("fast") => fast = true,
            Long("check") => build = false,
            Long("no-check") => check = false,
            other => return Err(usage(&other.unexpected().to_string())),
        }
    }
    let mut dist = Dist { add_targets, fast, ..Dist::new(repository, parts, targets)? };
    if build {
        dist.build()?;
    }
    if check {
        check::run(&mut dist)?;
    }
    Ok(())
}

fn known_part(name: String) -> Result<String, String> {
    match PARTS.contains(&name.as_str()) {
        true => Ok(name),
        false => Err(usage(&format!("no part '{name}' of a release: the parts are {}", PARTS.join(", ")))),
    }
}

impl Dist<'_> {
    fn new(repository: &Repository, parts: Vec<String>, targets: Vec<String>) -> Result<Dist<'_>, String> {
        let work = repository.target().join("dist");
        fs::create_dir_all(&work).map_err(|error| format!("{}: {error}.", work.display()))?;
        Ok(Dist {
            repository,
            folder: repository.root.join("dist"),
            local: LocalPaths::find(repository, &work)?,
            python: Python::named(repository, "dist-venv", false),
            version: publish::version(repository)?,
            work,
            parts,
            targets,
            add_targets: false,
            fast: false,
        })
    }

    /// True if a part is selected; without a selection, all are.
    fn has(&self, part: &str) -> bool {
        self.parts.is_empty() || self.parts.iter().any(|name| name == part)
    }

    /// The selected targets, or else those of this system.
    fn targets(&self, of_this_system: Vec<String>) -> Vec<String> {
        if self.targets.is_empty() { of_this_system } else { self.targets.clone() }
    }

    fn build(&mut self) -> Outcome {
        if self.parts.is_empty() && self.targets.is_empty() {
            remove_old(&self.folder)?;
        }
        make(&self.for_python())?;
        if self.has("sbom") {
            self.write_sboms()?;
        }
        if self.has("command") {
            for target in self.targets(command::targets()) {
                command::build(self, &target)?;
            }
        }
        if self.has("wheel") {
            for target in self.targets(wheel::targets()) {
                wheel::build(self, &target)?;
            }
        }
        if self.has("sdist") {
            sdist::build(self)?;
        }
        let (folder, sums) = (self.folder.clone(), self.checksums());
        process::run(self.script("archive.py")?.arg("sums").args([folder, sums]))
    }

    /// The file of checksums. Its name says for which system, since a release joins the files that several systems made.
    fn checksums(&self) -> PathBuf {
        self.folder.join(format!("SHA256SUMS-{}", env::consts::OS))
    }

    /// The folder of the wheels and of the source distribution: all files that belong into an index of Python packages.
    fn for_python(&self) -> PathBuf {
        self.folder.join("python")
    }

    /// Completes a call of cargo or maturin: paths of this machine are replaced, and a trial is not optimised.
    fn configure<'a>(&self, cargo: &'a mut Command) -> &'a mut Command {
        if self.fast {
            cargo.envs(FAST_BUILD);
        }
        self.local.hide(cargo, &self.work)
    }

    /// The lists of the crates in the command and in the Python package.
    fn write_sboms(&self) -> Outcome {
        let root = &self.repository.root;
        let metadata = dependencies::metadata(root)?;
        let lock = self.repository.source("Cargo.lock")?.ok_or("Cargo.lock is not text.")?.text;
        for (package, name) in [("rayweave-cli", "command"), ("rayweave-python", "python")] {
            let path = self.folder.join(format!("rayweave-{}-{name}.cdx.json", self.version));
            let list = sbom::write(&metadata, &dependencies::compiled(root, &[package])?, &lock, package)?;
            write(&path, &(serde_json::to_string_pretty(&list).map_err(|error| error.to_string())? + "\n"))?;
        }
        Ok(())
    }

    /// A call of a Python program of this folder.
    fn script(&mut self, name: &str) -> Result<Command, String> {
        let mut python = self.python.program("python")?;
        python.arg(self.repository.root.join("xtask/src/dist").join(name));
        Ok(python)
    }

    /// Fails with the remedy if the standard library of a target is not installed.
    fn need_target(&self, target: &str) -> Outcome {
        if self.add_targets {
            process::run(Command::new("rustup").args(["target", "add", target]))?;
        }
        need_target(target)
    }
}

/// The files of a folder whose names end with a text, sorted.
fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder)
        .map_err(|error| format!("{}: {error}. Run cargo xtask dist first.", folder.display()))?;
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut paths: Vec<PathBuf> = paths.filter(|path| path.to_string_lossy().ends_with(ending)).collect();
    paths.sort();
    Ok(paths)
}

fn need_target(target: &str) -> Outcome {
    let folder =
        process::output(Command::new("rustc").args(["--print", "target-libdir", "--target", target]))?;
    match Path::new(folder.trim()).is_dir() {
        true => Ok(()),
        false => Err(format!(
            "{target}: its standard library is not installed. Run rustup target add {target} or add the option \
             --add-targets, or select other targets with --target."
        )),
    }
}

/// True if programs of a target run on this machine.
fn runs_here(target: &str) -> bool {
    let system = match env::consts::OS {
        "macos" => "apple-darwin",
        other => other,
    };
    target.starts_with(env::consts::ARCH) && target.contains(system)
}

fn make(folder: &Path) -> Outcome {
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}.", folder.display()))
}

fn write(path: &Path, text: &str) -> Outcome {
    fs::write(path, text).map_err(|error| format!("{}: {error}.", path.display()))
}

fn copy(from: &Path, to: &Path) -> Outcome {
    fs::copy(from, to)
        .map(|_| ())
        .map_err(|error| format!("{} to {}: {error}.", from.display(), to.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_parts_are_rejected_with_the_known_ones() {
        assert_eq!(known_part("wheel".to_owned()).unwrap(), "wheel");
        assert!(known_part("wheels".to_owned()).unwrap_err().contains("command, wheel, sdist, sbom"));
    }

    #[test]
    fn programs_of_this_machine_run_here() {
        let host = process::output(Command::new("rustc").args(["--print", "host-tuple"])).unwrap();
        assert!(runs_here(host.trim()));
        assert!(!runs_here("sparc64-unknown-netbsd"));
        assert!(need_target(host.trim()).is_ok());
        let message = need_target("wasm32-unknown-unknown-no-such").unwrap_err();
        assert!(message.contains("rustc"), "{message}");
    }
}
