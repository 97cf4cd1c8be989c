//! `docs/reference/command.md`, generated from the help of the command.
//!
//! `RAYWEAVE_ACCEPT_GENERATED=1 cargo test -p rayweave-cli --test command reference` rewrites it.

use crate::bench::Bench;
use std::fmt::Write;
use std::fs;
use std::path::Path;

const ACCEPT: &str = "RAYWEAVE_ACCEPT_GENERATED";

const HEAD: &str = "\
# The command

Generated from `rayweave COMMAND --help`. [The tutorial](../tutorials/command.md) is a first tour,
[analysing models](../guides/analysing-models.md) explains the questions, [the model
file](model-file.md) the input, and [exit codes and messages](exit-codes.md) the end of a run.

";

/// The names of the sub-commands, in the order of the help.
fn commands(help: &str) -> Vec<&str> {
    let (_, list) = help.split_once("\nCommands:\n").unwrap();
    let lines = list.lines().take_while(|line| !line.is_empty());
    let names = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help").collect()
}

#[test]
#[cfg_attr(
    any(feature = "bench", feature = "gpu"),
    ignore = "the page describes the command without additional features"
)]
fn the_page_of_the_command_is_that_of_the_help() {
    let bench = Bench::new();
    let help = bench.says(&["--help"]);
    let mut page = format!("{HEAD}```text\n{}\n```\n", help.trim_end());
    for name in commands(&help) {
        let own = bench.says(&[name, "--help"]);
        write!(page, "\n## rayweave {name}\n\n```text\n{}\n```\n", own.trim_end()).unwrap();
    }
    let lines: Vec<&str> = page.lines().map(str::trim_end).collect();
    // tests of the whole workspace enable the evaluator `spans`, which the command does not have by default
    let page = lines.join("\n").replace(", single_hit, spans]", ", single_hit]") + "\n";
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/command.md");
    if std::env::var_os(ACCEPT).is_some_and(|value| value == "1") {
        fs::write(&file, page).unwrap();
        return;
    }
    let found = fs::read_to_string(&file).unwrap_or_default();
    let different = found.lines().zip(page.lines()).position(|(found, expected)| found != expected);
    assert!(
        found == page,
        "docs/reference/command.md:{}: the page differs from the help. Run {ACCEPT}=1 cargo test -p rayweave-cli --test \
         command reference.",
        different.unwrap_or(found.lines().count().min(page.lines().count())) + 1
    );
}
