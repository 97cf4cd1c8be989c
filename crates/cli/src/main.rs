//! The command line program `rayweave`: rendering, measurement, ray and light tracing of solid
//! models.

mod arguments;
mod cli;
mod command;
mod drawing;
mod failure;
mod interrupt;
mod interval;
mod lens_file;
mod terminal;

use clap::{CommandFactory, FromArgMatches};
use cli::Cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    // a negative number is parsed as the value of the option before it, which validates it
    let command = Cli::command().mut_subcommands(|command| command.allow_negative_numbers(true));
    let cli = match Cli::from_arg_matches(&command.get_matches()) {
        Ok(cli) => cli,
        Err(error) => error.exit(),
    };
    match cli::run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => terminal::report(&failure),
    }
}
