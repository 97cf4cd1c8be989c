//! The command-line program `rayweave`: rendering, measurement and checking of solid models, and ray and
//! light tracing.

mod arguments;
mod cli;
mod command;
mod device;
mod drawing;
mod failure;
mod interrupt;
mod interval;
mod lens_data;
mod lens_drawing;
mod lens_file;
mod photon_report;
mod terminal;

use clap::{CommandFactory, FromArgMatches};
use cli::Cli;
use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    // a negative number is parsed as the value of the preceding option, which validates it
    let command = Cli::command().mut_subcommands(|command| command.allow_negative_numbers(true));
    let parsed = command.try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(error) => return print(&error),
    };
    match interrupt::watch(move || cli::run(&cli)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => terminal::report(&failure),
    }
}

/// Prints an error of the command line to standard error; help and version, which the parser also returns as errors, go to
/// standard output.
fn print(error: &clap::Error) -> ExitCode {
    match error.print().and_then(|()| std::io::stdout().flush()) {
        Err(problem) if !error.use_stderr() => terminal::report(&failure::stdout_failure(&problem)),
        _ => ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)),
    }
}
