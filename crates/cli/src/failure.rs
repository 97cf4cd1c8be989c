//! Failures of the command: messages and exit codes.

use rayweave::scene::{nearby_sentence, reason};
use rayweave::{Error, ErrorKind};
use std::io;
use std::path::Path;

/// The reason why a run ended early.
pub enum Failure {
    /// An error of the library.
    Library(Error),
    /// The command line is invalid.
    Usage(String),
    /// The command does not apply to the model.
    Input(String),
    /// The run failed.
    Run(String),
    /// The result is negative: exit code 1, without a message.
    Answer,
    /// Any failure of `diff`, with exit code 2 like diff(1).
    Trouble(Box<Failure>),
    /// The reader of the output has closed it; this is not an error.
    BrokenPipe,
    /// Ctrl-C.
    Cancelled,
}

impl Failure {
    /// The exit code, as listed in the help text.
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

/// The failure of a file that cannot be read, with files of similar names if there is no such file.
pub fn unreadable(path: &Path, error: &io::Error) -> Failure {
    let (name, hint) = (path.display(), nearby_sentence(path));
    Failure::Input(format!("cannot read {name}: {}.{hint}", reason(error)))
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

/// The failure of a `--strict` run that cannot write the whole model.
pub fn lossy(out: &Path) -> Failure {
    let text = format!(
        "{} is not written: the format cannot hold the whole model, and --strict is given.",
        out.display()
    );
    Failure::Input(text)
}

/// Converts an error of writing to standard output.
pub fn stdout_failure(error: &io::Error) -> Failure {
    match error.kind() {
        io::ErrorKind::BrokenPipe => Failure::BrokenPipe,
        _ => Failure::Run(format!("cannot write to standard output: {error}.")),
    }
}
