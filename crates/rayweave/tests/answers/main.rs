//! Regression hashes of answers: crossings, nearest hits, partitions, sections, volumes, pixels, light,
//! photons and imported files.
//!
//! `tests/answers.txt` holds one line for each case: its name and the hash of the bits of its numbers. The
//! hashes prove nothing about correctness, which other tests cover; they prove that a refactoring changed no
//! answer. After an intended change, `cargo xtask answers --accept` rewrites the file and prints the cases
//! that changed.
//!
//! Names, messages and other text are not hashed. Files outside the repository (`../shared/data`) are skipped
//! if missing.

mod curves;
mod files;
mod hash;
mod light;
mod photons;
mod pictures;
mod questions;
mod random;
mod rays;

use hash::Hash;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// The environment variable that makes the test write the hashes instead of comparing them.
const ACCEPT: &str = "RAYWEAVE_ACCEPT_ANSWERS";

/// The cases by name.
#[derive(Default)]
pub struct Answers(BTreeMap<String, String>);

impl Answers {
    /// Adds a case; its name must be new, and white space in it is replaced.
    pub fn add(&mut self, name: &str, hash: Hash) {
        let name = name.replace(char::is_whitespace, "_");
        let before = self.0.insert(name.clone(), hash.text());
        assert!(before.is_none(), "two cases have the name {name}");
    }
}

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn recorded() -> BTreeMap<String, String> {
    let text = fs::read_to_string(root().join("tests/answers.txt")).unwrap_or_default();
    let cases = text.lines().filter(|line| !line.starts_with('#'));
    cases
        .filter_map(|line| line.split_once(' '))
        .map(|(name, hash)| (name.to_owned(), hash.to_owned()))
        .collect()
}

/// The differences between recorded and computed hashes of one group of cases, a line for each.
fn differences(
    group: &str,
    recorded: &BTreeMap<String, String>,
    answers: &Answers,
    is_present: impl Fn(&str) -> bool,
) -> Vec<String> {
    let mut lines = Vec::new();
    for (name, hash) in &answers.0 {
        match recorded.get(name) {
            None => lines.push(format!("{name}: new")),
            Some(before) if before != hash => lines.push(format!("{name}: {before} is now {hash}")),
            Some(_) => {}
        }
    }
    let of_group = recorded.keys().filter(|name| name.split('/').next() == Some(group));
    let missing = of_group.filter(|name| !answers.0.contains_key(*name) && is_present(name));
    lines.extend(missing.map(|name| format!("{name}: missing")));
    lines
}

/// Replaces the recorded hashes of a group; the lines of other groups remain.
fn write(group: &str, answers: &Answers, is_present: impl Fn(&str) -> bool) {
    let mut all = recorded();
    all.retain(|name, _| name.split('/').next() != Some(group) || !is_present(name));
    all.extend(answers.0.clone());
    let mut text = "# Regression hashes of answers, written by `cargo xtask answers --accept`; see crates/rayweave/tests/answers\n".to_owned();
    for (name, hash) in &all {
        // writing to a string cannot fail
        let _ = writeln!(text, "{name} {hash}");
    }
    fs::write(root().join("tests/answers.txt"), text).unwrap();
}

/// Compares a group of cases with the recorded hashes, or records them.
fn examine(group: &str, answers: &Answers) {
    examine_present(group, answers, |_| true);
}

/// Like [`examine`], for cases of which some cannot run here.
fn examine_present(group: &str, answers: &Answers, is_present: impl Fn(&str) -> bool) {
    assert!(!answers.0.is_empty(), "{group}: no case ran");
    let lines = differences(group, &recorded(), answers, &is_present);
    if std::env::var_os(ACCEPT).is_some_and(|value| value == "1") {
        lines.iter().for_each(|line| println!("{line}"));
        write(group, answers, &is_present);
        return;
    }
    assert!(
        lines.is_empty(),
        "{} of {} answers differ from tests/answers.txt (`cargo xtask answers --accept` records intended changes):\n{}",
        lines.len(),
        answers.0.len(),
        lines.join("\n")
    );
}

#[test]
fn random_models() {
    let mut answers = Answers::default();
    random::record(&mut answers);
    examine("random", &answers);
}

#[test]
fn model_files() {
    let mut answers = Answers::default();
    let shared = files::shared();
    if shared.is_none() {
        rayweave_conformance::skipped("answers of ../shared/data, which is missing");
    }
    files::record(&mut answers, shared.as_deref());
    examine_present("file", &answers, |name| shared.is_some() || !name.starts_with("file/shared/"));
}

#[test]
fn questions_about_models() {
    let mut answers = Answers::default();
    questions::record(&mut answers);
    examine("question", &answers);
}

#[test]
fn pictures() {
    let mut answers = Answers::default();
    pictures::record(&mut answers);
    examine("picture", &answers);
}

#[test]
fn light() {
    let mut answers = Answers::default();
    light::record(&mut answers);
    examine("light", &answers);
}

#[test]
fn photons_in_detectors() {
    let mut answers = Answers::default();
    photons::record(&mut answers);
    examine("photon", &answers);
}

#[test]
fn curves() {
    let mut answers = Answers::default();
    curves::record(&mut answers);
    examine("curve", &answers);
}

#[test]
fn changes_are_reported_case_by_case() {
    let hash = |value: u64| {
        let mut hash = Hash::new();
        hash.count(value);
        hash
    };
    let mut answers = Answers::default();
    answers.add("a/kept", hash(1));
    answers.add("a/changed", hash(2));
    answers.add("a/new", hash(3));
    let recorded = [("a/kept", 1), ("a/changed", 4), ("a/gone", 5), ("b/other", 6)];
    let recorded = recorded.map(|(name, value)| (name.to_owned(), hash(value).text())).into();
    let lines = differences("a", &recorded, &answers, |_| true);
    assert_eq!(lines.len(), 3, "{lines:?}");
    assert!(lines[0].starts_with("a/changed: ") && lines[1] == "a/new: new" && lines[2] == "a/gone: missing");
}
