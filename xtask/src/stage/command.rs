//! The stage that runs the command line program like a user.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use super::cargo::{NOT_BY_CARGO, cargo};
use crate::outcome::Outcome;
use crate::report::Counts;
use crate::workshop::Workshop;
use crate::{layers, process};

/// The first bytes of every PNG file (PNG specification, section 5.2).
const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The exit code of a panic.
const PANICKED: i32 = 101;

pub fn run(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    // the same packages as for the tests: others would unify the features of dependencies differently and build them again
    let mut build = cargo(workshop);
    build.args(["build", "--profile", workshop.profile.name(), "--bin", "rayweave"]).args(NOT_BY_CARGO);
    process::run(&mut build)?;
    is_default(&layers::metadata(workshop.repository)?)?;
    let scratch = workshop.repository.target().join("command");
    fs::create_dir_all(&scratch)
        .map_err(|error| format!("{}: cannot be made: {error}.", scratch.display()))?;
    let user = User {
        root: &workshop.repository.root,
        program: workshop.repository.target().join(workshop.profile.folder()).join("rayweave"),
    };
    let models = models(workshop)?;
    let mut failures = Vec::new();
    let mut take = |outcome: Outcome| match outcome {
        Ok(()) => counts.passed += 1,
        Err(message) => {
            println!("{message}");
            counts.failed += 1;
            failures.push(message);
        }
    };
    take(user.succeeds(&["--help"]));
    take(user.succeeds(&["--version"]));
    take(user.complains(&["info", "no-such-model.toml"], "no-such-model.toml"));
    take(user.succeeds(&["optics", "models/doublet.toml"]));
    for model in &models {
        take(user.succeeds(&["info", model]));
        take(user.renders(model, &scratch));
        take(user.succeeds(&["probe", model, "--from", "-1,0.125,0.25", "--to", "1,0.25,0.5"]));
    }
    match failures.first() {
        None => Ok(()),
        Some(first) => Err(format!("{} calls of the command failed, the first one: {first}", failures.len())),
    }
}

/// Checks that `cargo run`, as in the README, selects the command: its package is the only default member.
fn is_default(metadata: &Value) -> Outcome {
    let members: Vec<&str> = metadata["workspace_default_members"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    match members[..] {
        [member] if member.contains("/crates/cli#") => Ok(()),
        _ => Err(format!(
            "Cargo.toml: default-members selects {members:?}: `cargo run`, as in the README, must run the command. \
             Set default-members = [\"crates/cli\"]."
        )),
    }
}

/// The models of the repository; there must be at least one.
fn models(workshop: &Workshop<'_>) -> Result<Vec<String>, String> {
    let files = workshop.repository.files()?;
    let models: Vec<String> =
        files.into_iter().filter(|path| path.starts_with("models/") && path.ends_with(".toml")).collect();
    if models.is_empty() {
        Err("models/*.toml: no such file: the stage runs the command on them.".to_owned())
    } else {
        Ok(models)
    }
}

/// A user of the command at the root of the repository.
struct User<'a> {
    root: &'a Path,
    program: PathBuf,
}

impl User<'_> {
    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command.current_dir(self.root).args(arguments).stdin(Stdio::null());
        command
    }

    /// Checks that the command succeeds and prints something.
    fn succeeds(&self, arguments: &[&str]) -> Outcome {
        let output = process::output(&mut self.command(arguments))?;
        if output.trim().is_empty() {
            Err(format!("rayweave {}: nothing printed", arguments.join(" ")))
        } else {
            Ok(())
        }
    }

    /// Checks that the command fails without a panic, and that its message names the culprit.
    fn complains(&self, arguments: &[&str], culprit: &str) -> Outcome {
        let words = arguments.join(" ");
        let output =
            self.command(arguments).output().map_err(|error| format!("rayweave {words}: {error}"))?;
        let message = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(0) => Err(format!("rayweave {words}: succeeded, but should have failed")),
            Some(PANICKED) | None => Err(format!("rayweave {words}: panicked\n{message}")),
            Some(_) if !message.contains(culprit) => {
                Err(format!("rayweave {words}: does not name {culprit}\n{message}"))
            }
            Some(_) => Ok(()),
        }
    }

    /// Checks that the command writes a picture of a model.
    fn renders(&self, model: &str, scratch: &Path) -> Outcome {
        let picture = scratch.join(Path::new(model).with_extension("png").file_name().unwrap_or_default());
        let _ = fs::remove_file(&picture);
        let path = picture.to_string_lossy();
        process::output(&mut self.command(&["render", model, "--size", "64x48", "-o", &path]))?;
        let bytes = fs::read(&picture).map_err(|error| format!("{path}: cannot be read: {error}."))?;
        if bytes.starts_with(PNG_SIGNATURE) { Ok(()) } else { Err(format!("{path}: no PNG file")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell() -> User<'static> {
        User { root: Path::new("."), program: PathBuf::from("sh") }
    }

    #[test]
    fn the_command_is_the_only_default() {
        let metadata = |members: &str| {
            serde_json::from_str(&format!(r#"{{"workspace_default_members": [{members}]}}"#)).unwrap()
        };
        let cli = r#""path+file:///r/crates/cli#rayweave-cli@0.1.0""#;
        let xtask = r#""path+file:///r/xtask#0.1.0""#;
        assert_eq!(is_default(&metadata(cli)), Ok(()));
        for wrong in [String::new(), xtask.to_owned(), format!("{cli}, {xtask}")] {
            assert!(is_default(&metadata(&wrong)).unwrap_err().contains("default-members"));
        }
    }

    #[test]
    fn silence_is_no_success() {
        assert_eq!(shell().succeeds(&["-c", "echo here"]), Ok(()));
        assert!(shell().succeeds(&["-c", "true"]).unwrap_err().contains("nothing printed"));
        assert!(shell().succeeds(&["-c", "exit 2"]).unwrap_err().contains("exit status: 2"));
    }

    #[test]
    fn a_complaint_fails_and_names_its_cause() {
        let complains = |script: &str| shell().complains(&["-c", script], "lens");
        assert_eq!(complains("echo no lens >&2; exit 2"), Ok(()));
        assert!(complains("echo no lens >&2").unwrap_err().contains("should have failed"));
        assert!(complains("echo no lens >&2; exit 101").unwrap_err().contains("panicked"));
        assert!(complains("echo no >&2; exit 2").unwrap_err().contains("does not name lens"));
    }
}
