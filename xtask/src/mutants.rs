//! `cargo xtask mutants`: breaks the physics of photons on purpose, and sees which tests fail.
//!
//! The mutants are the expressions in `crates/photon/tests/mutants.txt`. All of them are compiled at once into a copy of the
//! crates: each expression becomes a choice between itself and its replacement, which an environment variable makes. A mutant that
//! fails no test survives, and is an error.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::outcome::Outcome;
use crate::process;
use crate::report::Counts;
use crate::repository::Repository;

/// The list of mutants.
const LIST: &str = "crates/photon/tests/mutants.txt";

/// The crate that is tested.
const CRATE: &str = "crates/photon";

/// The environment variable with the number of the mutant.
const VARIABLE: &str = "RAYWEAVE_MUTANT";

/// The marks around the expression that is replaced.
const MARKS: [&str; 2] = ["@[", "]@"];

/// A test program that takes longer has failed: some mutants repeat a loop for ever.
const PATIENCE: Duration = Duration::from_secs(600);

/// An expression of the sources, and its replacement.
#[derive(Debug, PartialEq)]
struct Mutant {
    name: String,
    file: String,
    /// The text before the expression, the expression, and the text behind it, which occur once in the file.
    before: String,
    old: String,
    after: String,
    new: String,
}

/// Runs all mutants, or those whose names contain one of some texts.
pub fn run(repository: &Repository, wanted: &[String], counts: &mut Counts) -> Outcome {
    let path = repository.root.join(LIST);
    let list = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mutants = parse(&list)?;
    let programs = build(repository, &mutants)?;
    let folder = copy_root(repository).join(CRATE);
    if let Some(failed) = failure(&programs, &folder, None)? {
        return Err(format!("without a mutant {failed}: correct that first."));
    }
    let is_wanted =
        |mutant: &Mutant| wanted.is_empty() || wanted.iter().any(|text| mutant.name.contains(text.as_str()));
    let mut survivors = Vec::new();
    for (number, mutant) in (1..).zip(&mutants).filter(|(_, mutant)| is_wanted(mutant)) {
        match failure(&programs, &folder, Some(number))? {
            Some(test) => {
                println!("found      {}: {test}", mutant.name);
                counts.passed += 1;
            }
            None => {
                println!("SURVIVED   {}", mutant.name);
                counts.failed += 1;
                survivors.push(mutant.name.as_str());
            }
        }
    }
    match survivors.is_empty() {
        true => Ok(()),
        false => Err(format!("{LIST}: no test fails with: {}. Add a test.", survivors.join("; "))),
    }
}

/// Reads the list: blocks of a name, a file, the expression between marks after `- `, and its replacement after `+ `.
fn parse(text: &str) -> Result<Vec<Mutant>, String> {
    let mut lines =
        text.lines().zip(1..).filter(|(line, _)| !line.starts_with('#') && !line.trim().is_empty());
    let mut mutants = Vec::new();
    while let Some((name, number)) = lines.next() {
        let bad = |what: &str| format!("{LIST}:{number}: mutant `{name}` has no {what}.");
        let file = lines.next().ok_or_else(|| bad("file"))?.0;
        let old = lines.next().and_then(|(line, _)| line.strip_prefix("- "));
        let (before, rest) =
            old.and_then(|line| line.split_once(MARKS[0])).ok_or_else(|| bad("expression"))?;
        let (old, after) = rest.split_once(MARKS[1]).ok_or_else(|| bad("end of its expression"))?;
        let new = lines.next().and_then(|(line, _)| line.strip_prefix("+ "));
        let new = new.ok_or_else(|| bad("replacement"))?;
        let [name, file, before, old, after, new] = [name, file, before, old, after, new].map(str::to_owned);
        mutants.push(Mutant { name, file, before, old, after, new });
    }
    Ok(mutants)
}

/// The sources with all mutants: the text of each file that has some.
fn mutate(
    mutants: &[Mutant],
    read: impl Fn(&str) -> Result<String, String>,
) -> Result<BTreeMap<String, String>, String> {
    let mut texts = BTreeMap::new();
    for (number, Mutant { name, file, before, old, after, new }) in (1..).zip(mutants) {
        if !texts.contains_key(file) {
            texts.insert(file.clone(), read(file)?);
        }
        let Some(text) = texts.get_mut(file) else { continue };
        let whole = format!("{before}{old}{after}");
        let times = text.matches(&whole).count();
        if times != 1 {
            return Err(format!(
                "{LIST}: mutant `{name}`: `{whole}` occurs {times} times in {file}, not once."
            ));
        }
        let choice = format!("{before}(if crate::mutants::is({number}) {{ {new} }} else {{ {old} }}){after}");
        *text = text.replacen(&whole, &choice, 1);
    }
    Ok(texts)
}

/// The module that chooses the mutant.
fn chooser() -> String {
    format!(
        "//! The mutant of this process.\n\npub(crate) fn is(number: u32) -> bool {{\n    static CHOSEN: std::sync::LazyLock<Option<u32>> =\n        \
         std::sync::LazyLock::new(|| std::env::var(\"{VARIABLE}\").ok()?.parse().ok());\n    *CHOSEN == Some(number)\n}}\n"
    )
}

fn copy_root(repository: &Repository) -> PathBuf {
    repository.target().join("mutants")
}

/// Builds the test programs of a copy of the crates with all mutants.
fn build(repository: &Repository, mutants: &[Mutant]) -> Result<Vec<PathBuf>, String> {
    let root = copy_root(repository);
    let read = |file: &str| {
        let path = repository.root.join(file);
        fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
    };
    let mut texts = mutate(mutants, read)?;
    let library = format!("{CRATE}/src/lib.rs");
    let mut text = texts.remove(&library).map_or_else(|| read(&library), Ok)?;
    // a choice needs its parentheses in some places only
    text = format!("#![allow(unused_parens)]\n{text}\nmod mutants;\n");
    texts.insert(library, text);
    texts.insert(format!("{CRATE}/src/mutants.rs"), chooser());
    texts.insert("Cargo.toml".to_owned(), crate::stage::alone(&read("Cargo.toml")?));
    let copied = |path: &&String| path.starts_with("crates/") || *path == "Cargo.lock";
    for path in repository.files()?.iter().filter(copied).filter(|path| !texts.contains_key(*path)) {
        let bytes = fs::read(repository.root.join(path)).map_err(|error| format!("{path}: {error}"))?;
        update(&root.join(path), &bytes)?;
    }
    for (path, text) in &texts {
        update(&root.join(path), text.as_bytes())?;
    }
    let mut cargo = Command::new("cargo");
    cargo.current_dir(&root).env("CARGO_TARGET_DIR", repository.target().join("mutants-target"));
    cargo.args(["test", "--package", "rayweave-photon", "--lib", "--test", "physics", "--no-run"]);
    let mut programs = Vec::new();
    process::run_reading(&mut cargo, |line| {
        let program = line.trim().strip_prefix("Executable ").and_then(|rest| rest.split_once('('));
        programs.extend(program.map(|(_, path)| root.join(path.trim_end_matches(')'))));
    })?;
    match programs.len() {
        2 => Ok(programs),
        found => {
            Err(format!("{found} test programs are built: those of the library and `physics` are needed."))
        }
    }
}

/// Writes a file unless it has this content already, so that cargo builds what has changed.
fn update(path: &Path, bytes: &[u8]) -> Outcome {
    if fs::read(path).is_ok_and(|own| own == bytes) {
        return Ok(());
    }
    let text = |error: std::io::Error| format!("{}: {error}", path.display());
    fs::create_dir_all(path.parent().unwrap_or(path)).map_err(text)?;
    fs::write(path, bytes).map_err(text)
}

/// The first test that fails with a mutant; `None` if all pass.
fn failure(programs: &[PathBuf], folder: &Path, mutant: Option<u32>) -> Result<Option<String>, String> {
    for program in programs {
        let mut command = Command::new(program);
        // cavities take most of the time, and no process alone opens them
        command.current_dir(folder).args(["--skip", "cavities"]).env_remove(VARIABLE);
        if let Some(number) = mutant {
            command.env(VARIABLE, number.to_string());
        }
        if let Some(failed) = failed_test(&mut command)? {
            return Ok(Some(failed));
        }
    }
    Ok(None)
}

/// The first failed test of a test program; `None` if it succeeds.
fn failed_test(command: &mut Command) -> Result<Option<String>, String> {
    let text = |error: std::io::Error| format!("cannot run a test program: {error}");
    // the file beside the program takes its output
    let output = Path::new(command.get_program()).with_extension("output");
    let file = fs::File::create(&output).map_err(text)?;
    let start = Instant::now();
    let mut child = command.stdin(Stdio::null()).stdout(file).stderr(Stdio::null()).spawn().map_err(text)?;
    let status = loop {
        if let Some(status) = child.try_wait().map_err(text)? {
            break status;
        }
        if start.elapsed() > PATIENCE {
            child.kill().and_then(|()| child.wait()).map_err(text)?;
            return Ok(Some("no end".to_owned()));
        }
        std::thread::sleep(Duration::from_millis(50));
    };
    let report = fs::read_to_string(&output).unwrap_or_default();
    let failed = report.lines().find_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"));
    Ok((!status.success()).then(|| failed.unwrap_or("the program").to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# comment\n\ndouble\na.rs\n- f(@[x + 1]@);\n+ 2 * x\n";

    #[test]
    fn mutants_are_choices() {
        let mutants = parse(TEXT).unwrap();
        let texts = mutate(&mutants, |_| Ok("let y = f(x + 1);".to_owned())).unwrap();
        assert_eq!(texts["a.rs"], "let y = f((if crate::mutants::is(1) { 2 * x } else { x + 1 }));");
    }

    #[test]
    fn expressions_must_occur_once() {
        let mutants = parse(TEXT).unwrap();
        let message = mutate(&mutants, |_| Ok("f(x + 1); f(x + 1);".to_owned())).unwrap_err();
        assert!(message.contains("`double`: `f(x + 1);` occurs 2 times in a.rs"), "{message}");
    }

    /// The mutants run in the long mode only; this test reports those that a change of the sources has outdated.
    #[test]
    fn all_expressions_occur_in_the_sources() {
        let repository = Repository::find().unwrap();
        let read =
            |file: &str| fs::read_to_string(repository.root.join(file)).map_err(|error| error.to_string());
        let mutants = parse(&read(LIST).unwrap()).unwrap();
        mutate(&mutants, read).unwrap();
    }

    #[test]
    fn incomplete_mutants_are_refused() {
        let message = parse("name\nfile.rs\n- no marks\n+ x\n").unwrap_err();
        assert!(message.contains("mutants.txt:1: mutant `name` has no expression"), "{message}");
    }
}
