//! The files that a command reads and writes: no output may be an input or another output.

use crate::failure::Failure;
use clap::ArgMatches;
use rayweave::table::{FileStamp, Part, record_opened};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The arguments that name files to write, and their names in messages. `pictures` and the `out` of `man` are folders.
const OUTPUTS: [(&str, &str); 14] = [
    ("out", "--out"),
    ("steps", "--steps"),
    ("histories", "--histories"),
    ("draw", "--draw"),
    ("map", "--map"),
    ("spectra", "--spectra"),
    ("svg", "--svg"),
    ("layout", "--layout"),
    ("drawing", "--drawing"),
    ("spot", "--spot"),
    ("paths", "--paths"),
    ("timeline", "--timeline"),
    ("pictures", "--pictures"),
    ("file", "FILE"),
];

/// The arguments that name files or folders to read, and their names in messages.
const INPUTS: [(&str, &str); 16] = [
    ("model", "the model"),
    ("other", "the second model"),
    ("a", "the first run"),
    ("b", "the second run"),
    ("parts", "a part"),
    ("rays", "the input --rays"),
    ("spectrum", "the input --spectrum"),
    ("gensteps", "the input --gensteps"),
    ("photons", "the input --photons"),
    ("hits", "the table of hits"),
    ("surface_tables", "the input --surface-tables"),
    ("dichroic", "the input --dichroic"),
    ("sums", "the input --sums"),
    ("searches", "the input --searches"),
    ("fonts", "the input --font"),
    ("allow", "the input --allow-path"),
];

/// A file of the command line.
#[derive(Debug)]
struct Named {
    /// The argument, as in messages.
    argument: &'static str,
    /// The path as given.
    path: PathBuf,
    identity: Identity,
}

/// The files of the command line, and those that its models have read.
#[derive(Debug)]
struct Files {
    inputs: Vec<Named>,
    outputs: Vec<Named>,
    read: Vec<FileStamp>,
}

static FILES: Mutex<Files> = Mutex::new(Files { inputs: Vec::new(), outputs: Vec::new(), read: Vec::new() });

fn lock() -> MutexGuard<'static, Files> {
    // no invariant spans several fields
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Identity of a file, equal for all names of it.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Identity {
    /// The path without symbolic links.
    path: PathBuf,
    /// Device and number of an existing file, which hard links share.
    #[cfg(unix)]
    number: Option<(u64, u64)>,
}

impl Identity {
    /// The identity of a file that exists or can be created. There is none for standard output, folders, devices and pipes, which
    /// several outputs may share, nor for a path that cannot be written anyway.
    fn of(path: &Path) -> Option<Identity> {
        if path == Path::new("-") {
            return None;
        }
        match fs::metadata(path) {
            Ok(data) if !data.is_file() => None,
            #[cfg(unix)]
            Ok(data) => {
                use std::os::unix::fs::MetadataExt;
                Some(Identity { path: path.canonicalize().ok()?, number: Some((data.dev(), data.ino())) })
            }
            #[cfg(not(unix))]
            Ok(_) => Some(Identity { path: path.canonicalize().ok()? }),
            Err(_) => {
                // a link to a missing file creates that file
                let target = fs::read_link(path).map_or(path.to_owned(), |link| folder(path).join(link));
                let path = folder(&target).canonicalize().ok()?.join(target.file_name()?);
                Some(Identity {
                    path,
                    #[cfg(unix)]
                    number: None,
                })
            }
        }
    }

    fn is_same(&self, other: &Identity) -> bool {
        #[cfg(unix)]
        if self.number.is_some() && self.number == other.number {
            return true;
        }
        self.path == other.path
    }
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The files of these arguments.
fn named(
    matches: &ArgMatches,
    arguments: &[(&'static str, &'static str)],
) -> impl Iterator<Item = (&'static str, PathBuf)> {
    let paths = arguments.iter().flat_map(|&(id, argument)| {
        // an argument of this name that is missing, or is no path, has no values of this type
        let values = matches.try_get_many::<PathBuf>(id).ok().flatten().into_iter().flatten();
        values.map(move |path| (argument, path.clone()))
    });
    paths.collect::<Vec<_>>().into_iter()
}

/// Rejects a command line with an output file that is also an input, or another output.
pub fn check(matches: &ArgMatches) -> Result<(), Failure> {
    let mut matches = matches;
    while let Some((_, inner)) = matches.subcommand() {
        matches = inner;
    }
    let inputs = named(matches, &INPUTS).filter_map(|(argument, path)| {
        Identity::of(&path).map(|identity| Named { argument, path, identity })
    });
    lock().inputs.extend(inputs);
    let is_part = matches.try_contains_id("range").is_ok_and(|is_known| is_known);
    for (argument, path) in named(matches, &OUTPUTS) {
        declare(argument, &path)?;
        // the other files that a table consists of
        let names = path.extension().is_some_and(|own| own.eq_ignore_ascii_case("npy"));
        let others = [
            names.then(|| path.with_extension("names.json")),
            (is_part && path != Path::new("-")).then(|| Part::path(&path)),
        ];
        others.iter().flatten().try_for_each(|path| declare(argument, path))?;
    }
    Ok(())
}

/// Adds an output file; rejects one that is also an input or another output.
fn declare(argument: &'static str, path: &Path) -> Result<(), Failure> {
    let Some(identity) = Identity::of(path) else { return Ok(()) };
    let mut files = lock();
    if let Some(input) = files.inputs.iter().find(|input| input.identity.is_same(&identity)) {
        return Err(overwritten(path, input.argument));
    }
    if let Some(other) = files.outputs.iter().find(|other| other.identity.is_same(&identity)) {
        let path = path.display();
        return Err(Failure::Usage(match other.argument == argument {
            true => format!("{path}: {argument} names the same file twice."),
            false => format!("{path}: {} and {argument} name the same file.", other.argument),
        }));
    }
    files.outputs.push(Named { argument, path: path.to_owned(), identity });
    Ok(())
}

/// Whether standard output carries one of these files instead of the report of a command; at most one result can go there.
pub fn is_piped<'a>(files: impl Iterator<Item = &'a PathBuf>, is_json: bool) -> Result<bool, Failure> {
    let piped = files.filter(|path| path.as_path() == Path::new("-")).count();
    match piped + usize::from(is_json) {
        0 | 1 => Ok(piped > 0),
        _ => {
            let problem = "several results go to standard output";
            let reason = "`-` is given more than once, or with --json";
            Err(Failure::Usage(format!("{problem}: {reason}. Write the others to files.")))
        }
    }
}

/// Rejects an output file that the command line does not name, such as one in a folder of outputs, if it is an input, another output or
/// a file that a model has read.
pub fn check_unnamed(path: &Path) -> Result<(), Failure> {
    let Some(identity) = Identity::of(path) else { return Ok(()) };
    let files = lock();
    if let Some(other) = files.inputs.iter().chain(&files.outputs).find(|own| own.identity.is_same(&identity))
    {
        return Err(overwritten(path, other.argument));
    }
    let is_read = |file: &FileStamp| Identity::of(&file.path).is_some_and(|read| read.is_same(&identity));
    if files.read.iter().any(is_read) {
        return Err(overwritten(path, "a file that the model reads"));
    }
    Ok(())
}

fn overwritten(path: &Path, what: &str) -> Failure {
    Failure::Usage(format!(
        "{}: it is also {what}, which would be overwritten. Choose another name.",
        path.display()
    ))
}

/// Runs a function that reads files of a model; rejects the command line if one of them is an output.
pub fn reading<T>(read: impl FnOnce() -> T) -> Result<T, Failure> {
    let (value, opened) = record_opened(read);
    let mut files = lock();
    for file in &opened {
        let Some(identity) = Identity::of(&file.path) else { continue };
        if let Some(output) = files.outputs.iter().find(|output| output.identity.is_same(&identity)) {
            return Err(overwritten(&output.path, "a file that the model reads"));
        }
    }
    files.read.extend(opened);
    Ok(value)
}

/// Removes and returns the files that [`reading`] has recorded.
pub fn take_read() -> Vec<FileStamp> {
    std::mem::take(&mut lock().read)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Command, CommandFactory};
    use std::any::TypeId;

    /// A new option with a file name must be added to one of the lists.
    #[test]
    fn every_path_is_an_input_or_an_output() {
        fn visit(command: &Command) {
            for argument in command.get_arguments() {
                if argument.get_value_parser().type_id() == TypeId::of::<PathBuf>() {
                    let id = argument.get_id().as_str();
                    let count = OUTPUTS.iter().chain(&INPUTS).filter(|(own, _)| *own == id).count();
                    assert_eq!(count, 1, "{id} of {}: add it to INPUTS or OUTPUTS", command.get_name());
                }
            }
            command.get_subcommands().for_each(visit);
        }
        visit(&crate::cli::Cli::command());
    }

    #[test]
    fn names_of_one_file() {
        let folder = std::env::temp_dir().join(format!("rayweave-outputs-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let of = |name: &str| Identity::of(&folder.join(name));
        let same = |a: &str, b: &str| of(a).unwrap().is_same(&of(b).unwrap());
        fs::write(folder.join("a"), "a").unwrap();
        fs::write(folder.join("b"), "a").unwrap();
        assert!(same("a", "./a") && same("new", "./new"));
        assert!(!same("a", "b") && !same("a", "new") && !same("new", "other"));
        #[cfg(unix)]
        {
            fs::hard_link(folder.join("a"), folder.join("hard")).unwrap();
            std::os::unix::fs::symlink("a", folder.join("soft")).unwrap();
            std::os::unix::fs::symlink("new", folder.join("dangling")).unwrap();
            assert!(same("a", "hard") && same("a", "soft") && same("new", "dangling"));
            assert!(!same("b", "hard") && !same("b", "soft"));
        }
        assert_eq!(of("."), None);
        assert_eq!(Identity::of(Path::new("-")), None);
        fs::remove_dir_all(&folder).unwrap();
    }
}
