//! The command-line program `rayweave`: rendering, measurement and checking of solid models, and ray and
//! light tracing.

mod arguments;
mod cli;
mod command;
mod device;
mod drawing;
mod elsewhere;
mod failure;
mod interrupt;
mod interval;
mod lens_data;
mod lens_drawing;
mod lens_file;
mod lens_input;
mod lens_model;
mod outputs;
mod photon_report;
mod terminal;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, FromArgMatches};
use cli::Cli;
use std::io::Write;
use std::num::{IntErrorKind, ParseIntError};
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    // a negative number is parsed as the value of the preceding option, which validates it
    let command = Cli::command().mut_subcommands(|command| command.allow_negative_numbers(true));
    let parsed = command.try_get_matches().and_then(|matches| {
        let cli = Cli::from_arg_matches(&matches)?;
        Ok((cli, matches))
    });
    let (cli, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => return print(&clear(elsewhere::advised(with_tip(without_misleading_tip(error))))),
    };
    if let Err(failure) = outputs::check(&matches) {
        return terminal::report(&failure);
    }
    match interrupt::watch(move || cli::run(&cli)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => terminal::report(&failure),
    }
}

/// The error without the advice to pass an unknown long option after `--`: no file name begins with two hyphens.
fn without_misleading_tip(mut error: clap::Error) -> clap::Error {
    let is_long =
        |value: &ContextValue| matches!(value, ContextValue::String(name) if name.starts_with("--"));
    if error.kind() == ErrorKind::UnknownArgument && error.get(ContextKind::InvalidArg).is_some_and(is_long) {
        error.remove(ContextKind::Suggested);
    }
    error
}

/// The error with advice about a file, or `-` for standard output, that no option takes.
fn with_tip(mut error: clap::Error) -> clap::Error {
    let argument = error.get(ContextKind::InvalidArg).map(ToString::to_string).unwrap_or_default();
    if error.kind() != ErrorKind::UnknownArgument || argument.len() > 1 && argument.starts_with('-') {
        return error;
    }
    let tip = match argument.as_str() {
        "-" => {
            "options such as --json take no value and write to standard output; where an option takes a file, - is its value: --out -"
                .to_owned()
        }
        file if Path::new(file).extension().is_some() => {
            format!("an output file is the value of an option, in most commands -o {file}")
        }
        _ => return error,
    };
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    error
}

/// The error with a message about the argument, where the parser states the reason in terms of number types.
fn clear(error: clap::Error) -> clap::Error {
    let source = std::error::Error::source(&error);
    let reason =
        match source.and_then(|source| source.downcast_ref::<ParseIntError>()).map(ParseIntError::kind) {
            Some(IntErrorKind::Zero) => "it must be at least 1",
            Some(IntErrorKind::PosOverflow) => "it is too large",
            Some(_) => "it must be a whole number from 0",
            None => return error,
        };
    let context = |kind| error.get(kind).map(ToString::to_string).unwrap_or_default();
    let (value, argument) = (context(ContextKind::InvalidValue), context(ContextKind::InvalidArg));
    let text = format!("invalid value '{value}' for '{argument}': {reason}\n");
    clap::Error::raw(error.kind(), text)
}

/// Prints an error of the command line to standard error; help and version, which the parser also returns as errors, go to
/// standard output.
fn print(error: &clap::Error) -> ExitCode {
    match error.print().and_then(|()| std::io::stdout().flush()) {
        Err(problem) if !error.use_stderr() => terminal::report(&failure::stdout_failure(&problem)),
        _ => ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)),
    }
}
