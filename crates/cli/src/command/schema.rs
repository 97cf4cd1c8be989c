//! `rayweave schema`: the JSON schema of model files.

use crate::failure::Failure;
use crate::terminal;
use clap::Args;

/// Print the JSON schema of model files, for completion and validation in editors
#[derive(Args)]
pub struct Schema {}

impl Schema {
    pub fn run(&self) -> Result<(), Failure> {
        terminal::print(&format!("{:#}\n", rayweave::scene::schema()))
    }
}
