//! `rayweave completions`: what a shell completes.

use crate::arguments::Cli;
use crate::failure::Failure;
use crate::terminal;
use clap::{Args, CommandFactory};
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
    pub fn run(&self) -> Result<(), Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "rayweave", &mut script);
        terminal::print(&String::from_utf8_lossy(&script))
    }
}
