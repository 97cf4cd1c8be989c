//! Results of chores, and messages about wrong arguments.

/// The result of a command: nothing, or one line about what went wrong.
pub type Outcome = Result<(), String>;

/// A message about wrong arguments, with the way to the right ones.
pub fn usage(problem: &str) -> String {
    format!("{problem} (see 'cargo xtask help')")
}
