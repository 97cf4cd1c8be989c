//! `rayweave completions`: completion scripts for shells.

use crate::failure::Failure;
use crate::terminal;
use clap::{Args, Command};
use clap_complete::Shell;

/// Print a completion script for a shell
///
/// For bash: rayweave completions bash > ~/.local/share/bash-completion/completions/rayweave
#[derive(Args)]
pub struct Completions {
    /// The shell
    shell: Shell,
}

impl Completions {
    /// Prints the script for a command.
    pub fn run(&self, command: &mut Command) -> Result<(), Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, command, "rayweave", &mut script);
        terminal::print(&String::from_utf8_lossy(&script))
    }
}
