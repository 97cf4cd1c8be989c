//! `cargo xtask publish`, which publishes the crates, and `cargo xtask semver`, which compares the interface of the library with that
//! of the last release.

use std::process::Command;

use lexopt::prelude::*;

use crate::layers;
use crate::outcome::{Outcome, usage};
use crate::process;
use crate::repository::Repository;

/// Publishes all crates, those first that others need. With `--dry-run` everything happens except the upload: each archive is written
/// and its contents compiled, with the archives of the other crates in place of published ones.
pub fn run(repository: &Repository, mut arguments: lexopt::Parser) -> Outcome {
    let mut dry = false;
    while let Some(argument) = arguments.next().map_err(|error| usage(&error.to_string()))? {
        match argument {
            Long("dry-run") => dry = true,
            other => return Err(usage(&other.unexpected().to_string())),
        }
    }
    let mut cargo = Command::new("cargo");
    cargo.current_dir(&repository.root).args(["publish", "--workspace", "--locked"]);
    if dry {
        return process::run(cargo.arg("--dry-run"));
    }
    let here = process::output(git(repository).args(["tag", "--points-at", "HEAD"]))?;
    released(&here, &version(repository)?)?;
    process::run(&mut cargo)
}

/// Fails if the commit with these tags is not the release of a version.
fn released(tags: &str, version: &str) -> Outcome {
    match tags.lines().any(|tag| tag == format!("v{version}")) {
        true => Ok(()),
        false => Err(format!(
            "the current commit has no tag v{version}: crates are published from the commit of their release. \
             Use --dry-run to try."
        )),
    }
}

/// Compares the public interface of the library with that of the last release by cargo-semver-checks. Only the crate `rayweave`
/// promises one.
pub fn compare_interface(repository: &Repository) -> Outcome {
    let tags = process::output(git(repository).args([
        "tag",
        "--list",
        "v*",
        "--sort",
        "version:refname",
        "--merged",
    ]))?;
    let Some(last) = last_before(&tags, &version(repository)?) else {
        println!("SKIPPED: there is no earlier release to compare with.");
        return Ok(());
    };
    if process::on_path("cargo-semver-checks").is_none() {
        return Err(
            "cargo-semver-checks: not installed. Run cargo install --locked cargo-semver-checks.".to_owned()
        );
    }
    let mut cargo = Command::new("cargo");
    cargo.current_dir(&repository.root).args([
        "semver-checks",
        "--package",
        "rayweave",
        "--baseline-rev",
        last,
    ]);
    process::run(&mut cargo)
}

/// The last of the sorted tags that is not the current version.
fn last_before<'a>(tags: &'a str, version: &str) -> Option<&'a str> {
    tags.lines().rfind(|tag| *tag != format!("v{version}"))
}

/// The version of the workspace.
pub fn version(repository: &Repository) -> Result<String, String> {
    let metadata = layers::metadata(repository)?;
    let mut packages = metadata["packages"].as_array().into_iter().flatten();
    let library = packages.find(|package| package["name"] == "rayweave");
    let version = library.and_then(|package| package["version"].as_str());
    Ok(version.ok_or("the workspace has no package rayweave.")?.to_owned())
}

fn git(repository: &Repository) -> Command {
    let mut git = Command::new("git");
    git.current_dir(&repository.root);
    git
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_commit_of_a_release_is_published() {
        assert_eq!(released("latest\nv1.2.3\n", "1.2.3"), Ok(()));
        assert!(released("v1.2.30\n", "1.2.3").unwrap_err().contains("no tag v1.2.3"));
        assert!(released("", "1.2.3").is_err());
    }

    #[test]
    fn all_files_state_the_same_version() {
        let repository = Repository::find().unwrap();
        let version = version(&repository).unwrap();
        for path in ["CITATION.cff", "packaging/conda/recipe.yaml"] {
            let text = repository.source(path).unwrap().unwrap().text;
            assert!(text.lines().any(|line| line.trim() == format!("version: {version}")), "{path}");
        }
    }

    #[test]
    fn the_release_before_this_one_is_the_baseline() {
        assert_eq!(last_before("v0.1.0\nv0.2.0\nv0.3.0\n", "0.3.0"), Some("v0.2.0"));
        assert_eq!(last_before("v0.1.0\nv0.2.0\n", "0.3.0"), Some("v0.2.0"));
        assert_eq!(last_before("v0.1.0\n", "0.1.0"), None);
        assert_eq!(last_before("", "0.1.0"), None);
    }
}
