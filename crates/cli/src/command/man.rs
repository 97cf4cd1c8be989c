//! `rayweave man`: the manual pages.

use crate::arguments::GlobalArguments;
use crate::failure::Failure;
use crate::terminal;
use clap::{Args, Command};
use std::path::PathBuf;

/// Write the manual pages of the command and of its sub-commands
#[derive(Args)]
pub struct Man {
    /// Output folder; created if necessary
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
}

impl Man {
    /// Writes the pages of a command.
    pub fn run(&self, mut command: Command, global: &GlobalArguments) -> Result<(), Failure> {
        command.build();
        std::fs::create_dir_all(&self.out)
            .and_then(|()| clap_mangen::generate_to(command, &self.out))
            .map_err(|error| {
                let folder = self.out.display();
                Failure::Run(format!("cannot write the manual pages to {folder}: {error}."))
            })?;
        match global.quiet {
            true => Ok(()),
            false => terminal::print(&format!("{}\n", self.out.join("rayweave.1").display())),
        }
    }
}
