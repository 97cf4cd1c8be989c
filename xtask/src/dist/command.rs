//! The command as an archive with its licences, manual pages and completions.

use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;

use super::elf;
use super::release::{Dist, copy, make, runs_here, write};
use crate::outcome::Outcome;
use crate::process;
use crate::python::remove_old;

/// Files of the repository that the archive contains.
const FILES: [&str; 5] = [
    "README.md",
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "bindings/python/THIRD-PARTY-LICENSES.txt",
];

/// Shells, with the names of their completion scripts.
const COMPLETIONS: [(&str, &str); 4] = [
    ("bash", "rayweave.bash"),
    ("zsh", "_rayweave"),
    ("fish", "rayweave.fish"),
    ("powershell", "rayweave.ps1"),
];

/// The targets of this system: on Linux, static programs for both processors, the own one first.
pub fn targets() -> Vec<String> {
    let arch = env::consts::ARCH;
    let other = if arch == "x86_64" { "aarch64" } else { "x86_64" };
    match env::consts::OS {
        "linux" => vec![format!("{arch}-unknown-linux-musl"), format!("{other}-unknown-linux-musl")],
        "macos" => vec!["aarch64-apple-darwin".to_owned(), "x86_64-apple-darwin".to_owned()],
        _ => vec![format!("{arch}-pc-windows-msvc")],
    }
}

/// The name of the archive, without its ending.
fn name(dist: &Dist<'_>, target: &str) -> String {
    format!("rayweave-{}-{target}", dist.version)
}

pub fn build(dist: &mut Dist<'_>, target: &str) -> Outcome {
    dist.need_target(target)?;
    let mut cargo = Command::new("cargo");
    cargo.current_dir(&dist.repository.root);
    cargo.args(["build", "--release", "--locked", "--package", "rayweave-cli", "--target", target]);
    if target.ends_with("-linux-musl") && !runs_here(target) {
        // the linker that comes with Rust: the one of this system is for its own processor
        let variable = format!("CARGO_TARGET_{}_LINKER", target.to_uppercase().replace('-', "_"));
        cargo.env(variable, "rust-lld");
    }
    process::run(dist.configure(&mut cargo))?;
    let file = if target.contains("windows") { "rayweave.exe" } else { "rayweave" };
    let program = dist.work.join(target).join("release").join(file);
    dist.local.check(&program)?;
    let bytes = fs::read(&program).map_err(|error| format!("{}: {error}.", program.display()))?;
    if target.ends_with("-linux-musl") && elf::is_static(&bytes) != Some(true) {
        return Err(format!("{}: it is not static.", program.display()));
    }
    let stage = dist.work.join("stage").join(name(dist, target));
    remove_old(&stage)?;
    make(&stage)?;
    copy(&program, &stage.join(file))?;
    for path in FILES {
        let short = Path::new(path).file_name().unwrap_or_default();
        copy(&dist.repository.root.join(path), &stage.join(short))?;
    }
    if runs_here(target) {
        pages(&stage, &program)?;
    } else if let Some(own) = targets().iter().find(|other| runs_here(other)) {
        // the texts are the same for all processors
        let own = dist.work.join("stage").join(name(dist, own));
        for folder in ["man", "completions"].iter().filter(|folder| own.join(folder).is_dir()) {
            copy_folder(&own.join(folder), &stage.join(folder))?;
        }
    }
    let ending = if target.contains("windows") { "zip" } else { "tar.gz" };
    let archive = dist.folder.join(format!("{}.{ending}", name(dist, target)));
    process::run(dist.script("archive.py")?.arg("pack").args([stage, archive]))
}

/// Writes the manual pages and completions.
fn pages(stage: &Path, program: &Path) -> Outcome {
    make(&stage.join("completions"))?;
    process::output(Command::new(program).args(["man", "--out"]).arg(stage.join("man")))?;
    for (shell, file) in COMPLETIONS {
        let script = process::output(Command::new(program).args(["completions", shell]))?;
        write(&stage.join("completions").join(file), &script)?;
    }
    Ok(())
}

fn copy_folder(from: &Path, to: &Path) -> Outcome {
    make(to)?;
    let unreadable = |error: std::io::Error| format!("{}: {error}.", from.display());
    for entry in fs::read_dir(from).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}
