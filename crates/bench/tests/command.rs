//! The command `rayweave-bench`: help, the list of exemplars, errors.

use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rayweave-bench")).args(arguments).output().unwrap()
}

#[test]
fn help_and_list_are_printed() {
    let help = run(&["--help"]);
    assert!(help.status.success());
    assert!(String::from_utf8_lossy(&help.stdout).contains("Usage: rayweave-bench"));
    let list = run(&["--list"]);
    assert!(list.status.success() && String::from_utf8_lossy(&list.stdout).contains("die"));
}

#[test]
fn an_unknown_exemplar_is_rejected() {
    let output = run(&["--only", "no-such-exemplar"]);
    assert!(!output.status.success());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("no-such-exemplar") && !message.contains("panicked"), "{message}");
}
