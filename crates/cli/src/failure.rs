//! Failures of the command: messages and exit codes.

use rayweave::{Error, ErrorKind};
use std::io;

/// Why a run ended early.
pub enum Failure {
    /// The library says so.
    Library(Error),
    /// The command line is invalid.
    Usage(String),
    /// The question does not apply to the model.
    Input(String),
    /// The run failed.
    Run(String),
    /// The answer was given, and is no: exit code 1, without a word more.
    Answer,
    /// Whatever it is, the exit code is 2, as that of diff(1).
    Trouble(Box<Failure>),
    /// Whoever read our output has gone: nothing to complain about.
    BrokenPipe,
    /// Ctrl-C.
    Cancelled,
}

impl Failure {
    /// The exit code, as the help text lists them.
    pub fn code(&self) -> u8 {
        match self {
            Failure::Library(error) => match error.kind() {
                ErrorKind::ModelFile
                | ErrorKind::Compile
                | ErrorKind::Shape
                | ErrorKind::Solid
                | ErrorKind::Optics
                | ErrorKind::Input => 3,
                ErrorKind::Name | ErrorKind::Value | ErrorKind::Format => 2,
                ErrorKind::Cancelled => 130,
                _ => 1,
            },
            Failure::Usage(_) => 2,
            Failure::Input(_) => 3,
            Failure::Run(_) | Failure::Answer => 1,
            Failure::Trouble(_) => 2,
            Failure::BrokenPipe => 0,
            Failure::Cancelled => 130,
        }
    }
}

impl<E: Into<Error>> From<E> for Failure {
    fn from(error: E) -> Failure {
        let error = error.into();
        match () {
            () if error.is_broken_pipe() => Failure::BrokenPipe,
            () if error.is_cancelled() => Failure::Cancelled,
            () => Failure::Library(error),
        }
    }
}

/// A failure to write to standard output.
pub fn stdout_failure(error: &io::Error) -> Failure {
    match error.kind() {
        io::ErrorKind::BrokenPipe => Failure::BrokenPipe,
        _ => Failure::Run(format!("cannot write to standard output: {error}.")),
    }
}
