//! `cargo xtask licences`: the licences that the Python package carries: our own, and those of the crates that are linked into it
//! and into the command.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use lexopt::prelude::*;
use serde_json::Value;

use crate::dependencies::{self, Graph, Kind, is_external};
use crate::outcome::{Outcome, usage};
use crate::repository::Repository;

/// The folder of the Python package: packagers take licence files from there only.
const PACKAGE: &str = "bindings/python";

/// The file with the licences of linked crates, in that folder.
const THIRD_PARTY: &str = "THIRD-PARTY-LICENSES.txt";

/// Our own licence files, at the root and copied to that folder.
const OWN: [&str; 2] = ["LICENSE-APACHE", "LICENSE-MIT"];

/// The packages that are distributed as binaries.
const BINARIES: [&str; 2] = ["rayweave-cli", "rayweave-python"];

/// The prefixes of the names of licence files, in lower case.
const NAMES: [&str; 6] = ["license", "licence", "copying", "copyright", "notice", "unlicense"];

/// Compares the files with the licences of the current dependencies; with `--accept` it writes them.
pub fn run_with(repository: &Repository, mut arguments: lexopt::Parser) -> Outcome {
    let mut accept = false;
    while let Some(argument) = arguments.next().map_err(|error| usage(&error.to_string()))? {
        match argument {
            Long("accept") => accept = true,
            other => return Err(usage(&other.unexpected().to_string())),
        }
    }
    check(repository, accept)
}

/// Compares the files, or writes them.
pub fn check(repository: &Repository, accept: bool) -> Outcome {
    let folder = repository.root.join(PACKAGE);
    let mut files = vec![(folder.join(THIRD_PARTY), third_party(repository)?)];
    for name in OWN {
        files.push((folder.join(name), read(&repository.root.join(name))?));
    }
    for (path, text) in files {
        let found = fs::read_to_string(&path).unwrap_or_default();
        match (found == text, accept) {
            (true, _) => {}
            (false, true) => {
                fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?
            }
            (false, false) => {
                let advice = "`cargo xtask licences --accept` writes it";
                return Err(format!(
                    "{} is out of date: the dependencies have changed. {advice}.",
                    path.display()
                ));
            }
        }
    }
    println!(
        "licences: {} external crates are linked",
        linked(repository, &dependencies::metadata(&repository.root)?)?.len()
    );
    Ok(())
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// The external packages that are linked into the binaries, on any platform.
fn linked<'a>(repository: &Repository, metadata: &'a Value) -> Result<Vec<&'a Value>, String> {
    let compiled = dependencies::compiled(&repository.root, &BINARIES)?;
    let packages = Graph::new(metadata, &compiled)?.reachable(&BINARIES, Kind::Linked);
    Ok(packages.into_iter().filter(|package| is_external(package)).collect())
}

/// All licences, each text once with the crates that it belongs to.
fn third_party(repository: &Repository) -> Result<String, String> {
    let metadata = dependencies::metadata(&repository.root)?;
    let packages = linked(repository, &metadata)?;
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut list = String::new();
    for package in packages {
        let word = |key: &str| package[key].as_str().unwrap_or_default();
        let title = format!("{} {}", word("name"), word("version"));
        list += &format!("{title}: {}\n", word("license"));
        let folder = Path::new(word("manifest_path")).parent().unwrap_or(Path::new(""));
        for file in licence_files(folder)? {
            let text = String::from_utf8_lossy(
                &fs::read(&file).map_err(|error| format!("{}: {error}", file.display()))?,
            )
            .lines()
            .map(|line| line.trim_end().to_owned() + "\n")
            .collect::<String>();
            let text = text.trim_matches('\n').to_owned();
            texts.entry(text).or_default().push(title.clone());
        }
    }
    let mut texts: Vec<(Vec<String>, String)> = texts
        .into_iter()
        .map(|(text, mut titles)| {
            titles.dedup();
            (titles, text)
        })
        .collect();
    texts.sort();
    let line = "-".repeat(80);
    let bodies =
        texts.iter().map(|(titles, text)| format!("{line}\n{}\n{line}\n\n{text}\n\n", titles.join("\n")));
    Ok(format!(
        "The binaries of Rayweave contain these crates. Their licences follow; a text that several crates share\n\
         stands here once. Crates that are not named with a text have no licence file of their own.\n\n{list}\n{}",
        bodies.collect::<String>()
    ))
}

/// The licence files of a crate, sorted by name.
fn licence_files(folder: &Path) -> Result<Vec<std::path::PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let is_licence = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        path.is_file() && NAMES.iter().any(|start| name.starts_with(start))
    };
    let mut files: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_licence).collect();
    files.sort();
    Ok(files)
}
