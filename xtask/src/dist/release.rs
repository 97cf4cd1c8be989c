//! The files of a release in the making: their folders, the tools that make them, and small operations on files.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::local_paths::LocalPaths;
use crate::outcome::Outcome;
use crate::process;
use crate::publish;
use crate::python::Python;
use crate::repository::Repository;

/// Other values of the settings of an optimised build that take longest.
pub(super) const FAST_BUILD: [(&str, &str); 3] = [
    ("CARGO_PROFILE_RELEASE_LTO", "off"),
    ("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0"),
    ("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16"),
];

/// The files of a release in the making.
pub(super) struct Dist<'a> {
    pub(super) repository: &'a Repository,
    /// The folder of the finished files.
    pub(super) folder: PathBuf,
    /// The folder of intermediate files, with cargo's target folder of these builds.
    pub(super) work: PathBuf,
    pub(super) local: LocalPaths,
    pub(super) python: Python,
    pub(super) version: String,
    pub(super) parts: Vec<String>,
    pub(super) targets: Vec<String>,
    /// True if missing standard libraries are installed.
    pub(super) add_targets: bool,
    /// True for a trial, without optimisation: builds take less time, and the programs are slow.
    pub(super) fast: bool,
}

impl Dist<'_> {
    pub(super) fn new(
        repository: &Repository,
        parts: Vec<String>,
        targets: Vec<String>,
    ) -> Result<Dist<'_>, String> {
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
    pub(super) fn has(&self, part: &str) -> bool {
        self.parts.is_empty() || self.parts.iter().any(|name| name == part)
    }

    /// The selected targets, or else those of this system.
    pub(super) fn targets(&self, of_this_system: Vec<String>) -> Vec<String> {
        if self.targets.is_empty() { of_this_system } else { self.targets.clone() }
    }

    /// The file of checksums. Its name says for which system, since a release joins the files that several systems made.
    pub(super) fn checksums(&self) -> PathBuf {
        self.folder.join(format!("SHA256SUMS-{}", env::consts::OS))
    }

    /// The folder of the wheels and of the source distribution: all files that belong into an index of Python packages.
    pub(super) fn for_python(&self) -> PathBuf {
        self.folder.join("python")
    }

    /// Completes a call of cargo or maturin: paths of this machine are replaced, and a trial is not optimised.
    pub(super) fn configure<'a>(&self, cargo: &'a mut Command) -> &'a mut Command {
        if self.fast {
            cargo.envs(FAST_BUILD);
        }
        self.local.hide(cargo, &self.work)
    }

    /// A call of a Python program of this folder.
    pub(super) fn script(&mut self, name: &str) -> Result<Command, String> {
        let mut python = self.python.program("python")?;
        python.arg(self.repository.root.join("xtask/src/dist").join(name));
        Ok(python)
    }

    /// Fails with the remedy if the standard library of a target is not installed.
    pub(super) fn need_target(&self, target: &str) -> Outcome {
        if self.add_targets {
            process::run(Command::new("rustup").args(["target", "add", target]))?;
        }
        need_target(target)
    }
}

/// The files of a folder whose names end with a text, sorted.
pub(super) fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder)
        .map_err(|error| format!("{}: {error}. Run cargo xtask dist first.", folder.display()))?;
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut paths: Vec<PathBuf> = paths.filter(|path| path.to_string_lossy().ends_with(ending)).collect();
    paths.sort();
    Ok(paths)
}

pub(super) fn need_target(target: &str) -> Outcome {
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
pub(super) fn runs_here(target: &str) -> bool {
    let system = match env::consts::OS {
        "macos" => "apple-darwin",
        other => other,
    };
    target.starts_with(env::consts::ARCH) && target.contains(system)
}

pub(super) fn make(folder: &Path) -> Outcome {
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}.", folder.display()))
}

pub(super) fn write(path: &Path, text: &str) -> Outcome {
    fs::write(path, text).map_err(|error| format!("{}: {error}.", path.display()))
}

pub(super) fn copy(from: &Path, to: &Path) -> Outcome {
    fs::copy(from, to)
        .map(|_| ())
        .map_err(|error| format!("{} to {}: {error}.", from.display(), to.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

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
