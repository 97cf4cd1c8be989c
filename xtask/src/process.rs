//! Child processes: start, output and exit status.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, io};

use crate::outcome::Outcome;

/// Runs a program with inherited output and waits for it; any exit status except 0 is an error.
pub fn run(command: &mut Command) -> Outcome {
    announce(command);
    let status = command.stdin(Stdio::null()).status().map_err(|error| cannot_start(command, &error))?;
    if status.success() { Ok(()) } else { Err(format!("{} ended with {status}", title(command))) }
}

/// Like [`run`], and also passes each line of the standard output and standard error to
/// `each_line`.
pub fn run_reading(command: &mut Command, mut each_line: impl FnMut(&str)) -> Outcome {
    announce(command);
    // one pipe for both, so that the lines keep their order: cargo prints the names of test
    // programs on standard error
    let (reader, writer) = io::pipe().map_err(|error| cannot_start(command, &error))?;
    let second = writer.try_clone().map_err(|error| cannot_start(command, &error))?;
    command.stdin(Stdio::null()).stdout(writer).stderr(second);
    let child = command.spawn();
    // the command holds the writing ends; after they are closed, the reader ends with the child
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = child.map_err(|error| cannot_start(command, &error))?;
    for line in BufReader::new(reader).split(b'\n').map_while(Result::ok) {
        let line = String::from_utf8_lossy(&line);
        println!("{line}");
        each_line(&line);
    }
    let status = child.wait().map_err(|error| cannot_start(command, &error))?;
    if status.success() { Ok(()) } else { Err(format!("{} ended with {status}", title(command))) }
}

/// Runs a program quietly and returns its standard output.
pub fn output(command: &mut Command) -> Result<String, String> {
    let output = command.stdin(Stdio::null()).output().map_err(|error| cannot_start(command, &error))?;
    if output.status.success() {
        return String::from_utf8(output.stdout).map_err(|error| format!("{}: {error}", title(command)));
    }
    let complaint = String::from_utf8_lossy(&output.stderr);
    Err(format!("{} ended with {}\n{}", title(command), output.status, complaint.trim_end()))
}

/// The first executable of this name on the PATH.
pub fn on_path(name: &str) -> Option<PathBuf> {
    let folders = env::var_os("PATH")?;
    let name = format!("{name}{}", env::consts::EXE_SUFFIX);
    env::split_paths(&folders).map(|folder| folder.join(&name)).find(|file| file.is_file())
}

/// The command line, without the folder of the program.
fn title(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    let mut words = vec![program.to_string_lossy().into_owned()];
    words.extend(command.get_args().map(|word| word.to_string_lossy().into_owned()));
    words.join(" ")
}

fn announce(command: &Command) {
    println!("$ {}", title(command));
    // the output of the child must come after this line
    let _ = io::stdout().flush();
}

fn cannot_start(command: &Command, error: &io::Error) -> String {
    format!("{}: cannot run: {error}. Is it installed?", title(command))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)] // for its programs
    fn exit_codes_are_judged() {
        assert_eq!(run(&mut Command::new("true")), Ok(()));
        let message = run(&mut Command::new("false")).unwrap_err();
        assert!(message.starts_with("false ended with exit status: 1"), "{message}");
    }

    #[test]
    fn a_missing_program_is_named() {
        let message = output(Command::new("no-such-program").arg("now")).unwrap_err();
        assert!(message.starts_with("no-such-program now: cannot run: "), "{message}");
    }

    #[test]
    #[cfg(unix)] // for its programs
    fn lines_are_read_even_when_the_program_fails() {
        let mut lines = Vec::new();
        let mut command = Command::new("sh");
        command.args(["-c", "echo one; echo two >&2; echo three; exit 3"]);
        let outcome = run_reading(&mut command, |line| lines.push(line.to_owned()));
        assert_eq!(lines, ["one", "two", "three"]);
        assert!(outcome.unwrap_err().contains("exit status: 3"));
    }

    #[test]
    #[cfg(unix)] // for its programs
    fn the_path_is_searched() {
        assert!(on_path("sh").is_some());
        assert!(on_path("no-such-program").is_none());
    }
}
