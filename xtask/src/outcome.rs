//! Results of commands, and messages about invalid arguments.

/// The result of a command: nothing, or one line about the error.
pub type Outcome = Result<(), String>;

/// A message about invalid arguments that refers to the help.
pub fn usage(problem: &str) -> String {
    format!("{problem}. See 'cargo xtask help'.")
}
