//! The stage that runs every example, in Rust and in Python.

use serde_json::Value;
use std::process::Command;

use super::cargo::{NOT_BY_CARGO, cargo};
use crate::outcome::Outcome;
use crate::python::BINDING;
use crate::report::Counts;
use crate::workshop::Workshop;
use crate::{layers, process};

/// Runs all scripts in one process: loading the packages takes longer than most examples.
const RUN: &str = include_str!("run_examples.py");

/// An example of a crate.
#[derive(Debug, PartialEq, Eq)]
struct Example {
    package: String,
    name: String,
    features: String,
}

impl Example {
    /// The command that runs the example: its binary, or a call of cargo if it needs its own
    /// features.
    fn command(&self, workshop: &Workshop<'_>) -> Command {
        if self.features.is_empty() {
            let mut command =
                Command::new(workshop.repository.target().join("debug/examples").join(&self.name));
            command.current_dir(&workshop.repository.root);
            return command;
        }
        let mut cargo = cargo(workshop);
        cargo.args(["run", "--quiet", "--package", &self.package, "--example", &self.name]);
        cargo.args(["--features", &self.features]);
        cargo
    }
}

pub fn run(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    let examples = read(&layers::metadata(workshop.repository)?);
    let scripts = scripts(workshop)?;
    if examples.is_empty() || scripts.is_empty() {
        return Err(format!(
            "found {} examples in Rust and {} in Python: there must be some of each.",
            examples.len(),
            scripts.len()
        ));
    }
    // the same call as for the tests: separate calls for each package would unify the features of
    // dependencies differently and build them again
    let mut all = cargo(workshop);
    process::run(all.args(["build", "--quiet", "--examples"]).args(NOT_BY_CARGO))?;
    let commands = examples.iter().map(|example| example.command(workshop));
    let mut failures: Vec<String> =
        commands.filter_map(|mut command| process::run(&mut command).err()).collect();
    workshop.python.install_package()?;
    let mut python = workshop.python.program("python")?;
    let end = process::run_reading(python.args(["-c", RUN]).args(&scripts), |line| {
        failures.extend(line.strip_prefix("example failed: ").map(|path| format!("{path} failed")));
    });
    if failures.is_empty() {
        // an end without a failed script: the interpreter crashed
        failures.extend(end.err());
    }
    counts.failed += failures.len() as u64;
    counts.passed += (examples.len() + scripts.len() - failures.len()) as u64;
    if failures.is_empty() { Ok(()) } else { Err(failures.join("\n")) }
}

/// The examples of all packages.
fn read(metadata: &Value) -> Vec<Example> {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let list = |value: &Value| value.as_array().into_iter().flatten().map(text).collect::<Vec<_>>();
    let mut examples = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let targets = package["targets"].as_array().into_iter().flatten();
        for target in targets.filter(|target| list(&target["kind"]).contains(&"example".to_owned())) {
            let features = list(&target["required-features"]).join(",");
            examples.push(Example { package: text(&package["name"]), name: text(&target["name"]), features });
        }
    }
    examples
}

/// The examples of the Python package.
fn scripts(workshop: &Workshop<'_>) -> Result<Vec<String>, String> {
    let folder = format!("{BINDING}/examples/");
    let files = workshop.repository.files()?;
    Ok(files.into_iter().filter(|path| path.starts_with(&folder) && path.ends_with(".py")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_found_with_their_features() {
        let text = r#"{"packages": [{"name": "a", "targets": [
            {"name": "a", "kind": ["lib"]},
            {"name": "lens", "kind": ["example"], "required-features": ["x", "y"]},
            {"name": "die", "kind": ["example"]}]}]}"#;
        let example = |name: &str, features: &str| Example {
            package: "a".to_owned(),
            name: name.to_owned(),
            features: features.to_owned(),
        };
        assert_eq!(read(&serde_json::from_str(text).unwrap()), [example("lens", "x,y"), example("die", "")]);
    }
}
