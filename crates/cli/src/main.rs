//! The command `rayweave`: pictures, probes, traces and facts of solid models.

mod arguments;
mod command;
mod drawing;
mod failure;
mod interrupt;
mod interval;
mod terminal;

use arguments::Cli;
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    match command::run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
