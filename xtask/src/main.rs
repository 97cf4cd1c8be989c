//! `cargo xtask`: the maintenance commands of the repository, listed in `HELP`.

mod accepted;
mod allow;
mod cycles;
mod dependencies;
mod dist;
mod features;
mod layers;
mod lean;
mod licences;
mod masked;
mod mutants;
mod new_primitive;
mod outcome;
mod platforms;
mod process;
mod profile;
mod publish;
mod python;
mod report;
mod repository;
mod site;
mod slowest;
mod stage;
mod stub;
mod suite;
mod tidy;
mod workflows;
mod workshop;

use std::process::ExitCode;

use lexopt::prelude::*;
use outcome::{Outcome, usage};
use repository::Repository;

const HELP: &str = "\
Usage: cargo xtask COMMAND

Commands:
  test [--long] [--fail-fast] [--only STAGE]... [--skip STAGE]... [--list]
                       run the checks and tests of the repository, stage by stage
  tidy                 check the text of all files of the repository
  layers               check dependencies, import cycles and crate features (ARCHITECTURE.md)
  new-primitive NAME   write the source file of a new primitive, as a copy of the sphere
  golden [--accept]    compare the pictures of all models with those accepted, or accept them
  answers [--accept]   compare the hashes of answers with those recorded, or record them
  generated [--accept] compare the sources generated from the registry of primitives, or write them
  stub [--accept]      compare the stub of the Python package with the sources of the binding, or write it
  mutants [TEXT]...    check that a test fails for each deliberate error in the physics of photons: for all mutants,
                       or those whose names contain a text
  licences [--accept]  compare the licence files of the Python package with the dependencies, or write them
  docs [--keep]        build the documentation site in target/site; --keep uses the Python environment of the last run again
  workflows            check the workflows of continuous integration with actionlint
  platforms            check that the code compiles for Windows and macOS
  publish [--dry-run]  publish all crates in the order of their dependencies, or try it without uploading
  semver               compare the interface of the library with that of the last release
  dist [OPTIONS]       build the files of a release in dist/, and check each as its user: it runs the examples of the README
  help                 print this text

Options of test:
  --long               also run the stages long (the ignored tests), platforms and mutants
  --fail-fast          stop at the first stage that fails
  --only STAGE         run only this stage; may be repeated
  --skip STAGE         omit this stage; may be repeated
  --list               print the selected stages and what each does, instead of running them

Options of dist:
  --only PART          build only this part: command, wheel, sdist or sbom; may be repeated
  --target TRIPLE      build the command or the wheel for this target of Rust; may be repeated
  --add-targets        install missing standard libraries of targets with rustup
  --check              only check the files that are in dist/
  --no-check           only build
  --fast               a trial without optimisation: builds take less time, and the programs are slow
";

fn main() -> ExitCode {
    match run() {
        Ok(code) => code,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Executes the command line. `test` prints its own report, and returns its exit code.
fn run() -> Result<ExitCode, String> {
    let mut arguments = lexopt::Parser::from_env();
    let command = match arguments.next().map_err(|error| error.to_string())? {
        Some(Value(name)) => name.string().map_err(|error| error.to_string())?,
        Some(Long("help") | Short('h')) | None => "help".to_owned(),
        Some(other) => return Err(usage(&other.unexpected().to_string())),
    };
    match command.as_str() {
        "test" => {
            let options = suite::Options::parse(arguments)?;
            return suite::run(&Repository::find()?, &options);
        }
        "new-primitive" => {
            let name = one_value(arguments, "NAME")?;
            new_primitive::run(&Repository::find()?, &name)?;
        }
        "golden" => accepted::run(&Repository::find()?, &accepted::GOLDEN, arguments)?,
        "answers" => accepted::run(&Repository::find()?, &accepted::ANSWERS, arguments)?,
        "generated" => accepted::run(&Repository::find()?, &accepted::GENERATED, arguments)?,
        "stub" => match accepted::accept_flag(arguments)? {
            true => stub::accept(&Repository::find()?)?,
            false => stub::compare(&Repository::find()?)?,
        },
        "mutants" => {
            let names = arguments.raw_args().map_err(|error| usage(&error.to_string()))?;
            let names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
            mutants::run(&Repository::find()?, &names, &mut report::Counts::default())?;
        }
        "licences" => licences::run_with(&Repository::find()?, arguments)?,
        "tidy" => {
            finish(arguments)?;
            tidy::run(&Repository::find()?)?;
        }
        "layers" => {
            finish(arguments)?;
            layers::run(&Repository::find()?)?;
            lean::run(&Repository::find()?)?;
            features::run(&Repository::find()?)?;
        }
        "docs" => site::run(&Repository::find()?, arguments)?,
        "dist" => dist::run(&Repository::find()?, arguments)?,
        "workflows" => {
            finish(arguments)?;
            workflows::run(&Repository::find()?, &mut report::Counts::default())?;
        }
        "platforms" => {
            finish(arguments)?;
            platforms::run(&Repository::find()?, &mut report::Counts::default())?;
        }
        "publish" => publish::run(&Repository::find()?, arguments)?,
        "semver" => {
            finish(arguments)?;
            publish::compare_interface(&Repository::find()?)?;
        }
        "help" => print!("{HELP}"),
        other => return Err(usage(&format!("no command '{other}'"))),
    }
    Ok(ExitCode::SUCCESS)
}

/// The last argument, a value; an error if it is missing or followed by another.
fn one_value(mut arguments: lexopt::Parser, name: &str) -> Result<String, String> {
    let value = arguments.value().map_err(|_| usage(&format!("{name} is missing")))?;
    finish(arguments)?;
    value.string().map_err(|error| error.to_string())
}

/// Rejects further arguments.
fn finish(mut arguments: lexopt::Parser) -> Outcome {
    match arguments.next().map_err(|error| usage(&error.to_string()))? {
        None => Ok(()),
        Some(argument) => Err(usage(&argument.unexpected().to_string())),
    }
}
