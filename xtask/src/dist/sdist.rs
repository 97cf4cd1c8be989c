//! The source distribution of the Python package, with the sources of all crates that its build compiles, so that it builds without
//! a network.
//!
//! `cargo vendor` writes the sources of all packages in Cargo.lock, also of those for tests and optional features: 392 MB, of which
//! a build compiles a fifth. Cargo needs the manifests of the others to resolve dependencies, but not their code.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

use super::release::{Dist, make, write};
use crate::dependencies::{self, Graph, Kind, is_external, title};
use crate::outcome::Outcome;
use crate::process;
use crate::python::{BINDING, MATURIN, remove_old};

pub fn build(dist: &mut Dist<'_>) -> Outcome {
    let scratch = dist.work.join("sdist");
    remove_old(&scratch)?;
    dist.python.install(&[MATURIN])?;
    let mut maturin = dist.python.program("maturin")?;
    maturin.current_dir(dist.repository.root.join(BINDING)).args(["sdist", "--out"]).arg(&scratch);
    process::run(&mut maturin)?;
    let name = format!("rayweave-{}", dist.version);
    let packed = scratch.join(format!("{name}.tar.gz"));
    process::run(dist.script("archive.py")?.arg("unpack").args([&packed, &scratch]))?;
    let sources = scratch.join(&name);
    // before the sources of others are there, whose texts may contain anything
    dist.local.check(&sources)?;
    vendor(&sources)?;
    let configuration = configuration(&read(&dist.repository.root.join(".cargo/config.toml"))?);
    make(&sources.join(".cargo"))?;
    write(&sources.join(".cargo/config.toml"), &configuration)?;
    let archive = dist.for_python().join(format!("{name}.tar.gz"));
    process::run(dist.script("archive.py")?.arg("pack").args([sources, archive]))
}

/// Copies the sources of all crates in Cargo.lock to the folder `vendor`, and removes the code of those that the build does not compile.
fn vendor(sources: &Path) -> Outcome {
    let folder = sources.join("vendor");
    let mut cargo = Command::new("cargo");
    process::output(cargo.current_dir(sources).args(["vendor", "--quiet", "--versioned-dirs"]).arg(&folder))?;
    const PACKAGE: [&str; 1] = ["rayweave-python"];
    let metadata = dependencies::metadata(sources)?;
    let compiled = Graph::new(&metadata, &dependencies::compiled(sources, &PACKAGE)?)?;
    let compiled = compiled.reachable(&PACKAGE, Kind::Compiled);
    let compiled: BTreeSet<String> = (compiled.into_iter().filter(|package| is_external(package)))
        .map(|package| title(package).replace(' ', "-"))
        .collect();
    let mut names: BTreeSet<String> = entries(&folder)?.iter().map(|path| name(path)).collect();
    if let Some(missing) = compiled.iter().find(|name| !names.contains(*name)) {
        return Err(format!("{}: {missing} is missing: the build compiles it.", folder.display()));
    }
    names.retain(|name| !compiled.contains(name));
    for name in &names {
        hollow(&folder.join(name))?;
    }
    println!("vendor: {} crates with sources, {} manifests only", compiled.len(), names.len());
    Ok(())
}

/// Removes everything of a crate but its manifest.
fn hollow(folder: &Path) -> Outcome {
    let checksums = folder.join(".cargo-checksum.json");
    let recorded: Value = serde_json::from_str(&read(&checksums)?)
        .map_err(|error| format!("{}: {error}.", checksums.display()))?;
    for path in entries(folder)? {
        match path.is_dir() {
            true => remove_old(&path)?,
            false if ["Cargo.toml", ".cargo-checksum.json"].contains(&name(&path).as_str()) => {}
            false => fs::remove_file(&path).map_err(|error| format!("{}: {error}.", path.display()))?,
        }
    }
    // a package without any target is an error, and cargo looks for this file when the manifest names none
    make(&folder.join("src"))?;
    write(&folder.join("src/lib.rs"), "")?;
    write(&checksums, &json!({"files": {}, "package": recorded["package"]}).to_string())
}

/// The settings of the repository without the short names of commands, and where the sources are.
fn configuration(of_repository: &str) -> String {
    let tables = of_repository.split("\n\n").filter(|table| !table.starts_with("[alias]"));
    let tables = tables.collect::<Vec<_>>().join("\n\n");
    format!(
        "# The sources of all crates are in this archive: the build needs no network.\n\
         [source.crates-io]\nreplace-with = \"vendored\"\n\n[source.vendored]\ndirectory = \"vendor\"\n\n{tables}"
    )
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let unreadable = |error: std::io::Error| format!("{}: {error}.", folder.display());
    let entries = fs::read_dir(folder).map_err(unreadable)?;
    entries.map(|entry| Ok(entry.map_err(unreadable)?.path())).collect()
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}.", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flags_of_the_repository_stay() {
        let text =
            "[alias]\nxtask = \"run\"\n\n# why\n[target.'cfg(unix)']\nrustflags = [\"--cfg\", \"x\"]\n";
        let found = configuration(text);
        assert!(
            found.contains("directory = \"vendor\"\n\n# why\n[target.'cfg(unix)']\nrustflags"),
            "{found}"
        );
        assert!(!found.contains("alias") && !found.contains("xtask"), "{found}");
    }

    #[test]
    fn a_crate_that_is_not_compiled_keeps_its_manifest() {
        let folder = std::env::temp_dir().join(format!("xtask-sdist-{}", std::process::id()));
        make(&folder.join("src/inner")).unwrap();
        for (path, text) in [
            ("src/inner/code.rs", "fn f() {}"),
            ("src/lib.rs", "mod inner;"),
            ("build.rs", "fn main() {}"),
            ("Cargo.toml", "[package]"),
            (".cargo-checksum.json", "{\"files\":{\"build.rs\":\"ab\"},\"package\":\"cd\"}"),
        ] {
            write(&folder.join(path), text).unwrap();
        }
        hollow(&folder).unwrap();
        let mut left: Vec<String> = entries(&folder).unwrap().iter().map(|path| name(path)).collect();
        left.sort();
        assert_eq!(left, [".cargo-checksum.json", "Cargo.toml", "src"]);
        assert_eq!(read(&folder.join("src/lib.rs")).unwrap(), "");
        assert_eq!(entries(&folder.join("src")).unwrap().len(), 1);
        let recorded: Value =
            serde_json::from_str(&read(&folder.join(".cargo-checksum.json")).unwrap()).unwrap();
        assert_eq!(recorded, json!({"files": {}, "package": "cd"}));
        remove_old(&folder).unwrap();
    }
}
