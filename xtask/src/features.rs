//! The check of features: the command and the Python package must enable the same features of the
//! external crates that both use, so that one target folder compiles these crates once.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use crate::Outcome;
use crate::process;
use crate::repository::Repository;

/// The two programs.
const PROGRAMS: [&str; 2] = ["rayweave-cli", "rayweave-python"];

/// The features of each crate, by name and version; a crate that is compiled both for the target
/// and for the host can have two sets.
type Features = BTreeMap<String, BTreeSet<String>>;

/// Compares the features of the crates that both programs use.
pub fn run(repository: &Repository) -> Outcome {
    let [command, package] = [features(repository, PROGRAMS[0])?, features(repository, PROGRAMS[1])?];
    let problems = differences(&command, &package);
    for problem in &problems {
        println!("{problem}");
    }
    if !problems.is_empty() {
        return Err(format!(
            "{} and {} compile {} crates twice: their features differ. Enable the same in both manifests.",
            PROGRAMS[0],
            PROGRAMS[1],
            problems.len()
        ));
    }
    let shared = command.keys().filter(|name| package.contains_key(*name)).count();
    println!("features: {shared} crates are shared by {}", PROGRAMS.join(" and "));
    Ok(())
}

/// The features of all crates that a program is built from.
fn features(repository: &Repository, program: &str) -> Result<Features, String> {
    let mut tree = Command::new("cargo");
    tree.current_dir(&repository.root).args(["tree", "--package", program, "--edges", "normal,build"]);
    tree.args(["--prefix", "none", "--format", "{p}|{f}"]);
    Ok(read(&process::output(&mut tree)?))
}

/// Reads the output of `cargo tree`.
fn read(tree: &str) -> Features {
    let mut crates = Features::new();
    for line in tree.lines() {
        if let Some((name, features)) = line.split_once('|') {
            let features = features.trim_end_matches(" (*)").to_owned();
            crates.entry(name.to_owned()).or_default().insert(features);
        }
    }
    crates
}

/// The crates of both lists whose features differ.
fn differences(first: &Features, second: &Features) -> Vec<String> {
    let shared = first.iter().filter_map(|(name, one)| Some((name, one, second.get(name)?)));
    let different = shared.filter(|(_, one, other)| one != other);
    let list = |features: &BTreeSet<String>| features.iter().cloned().collect::<Vec<_>>().join(" and ");
    different.map(|(name, one, other)| format!("{name}: {}; {}", list(one), list(other))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differing_features_of_shared_crates_are_reported() {
        let first = read("a v1.0.0|std\nb v0.1.0|default,std (*)\nc v0.2.0|\n");
        let second = read("b v0.1.0|default,std\na v1.0.0|alloc,std\nd v0.2.0|\n");
        assert_eq!(differences(&first, &second), ["a v1.0.0: std; alloc,std"]);
        assert_eq!(differences(&first, &first), [""; 0]);
    }
}
