//! `cargo xtask test`: every check and test of the repository, stage by stage.

use std::process::ExitCode;
use std::time::Instant;

use lexopt::prelude::*;

use crate::outcome::usage;
use crate::profile::Profile;
use crate::python::Python;
use crate::report::{self, Counts, Report};
use crate::repository::Repository;
use crate::slowest::Slowest;
use crate::stage::{self, Stage};
use crate::workshop::Workshop;

/// Options of the command line.
#[derive(Debug, Default)]
pub struct Options {
    long: bool,
    fail_fast: bool,
    list: bool,
    only: Vec<String>,
    skip: Vec<String>,
}

impl Options {
    /// Parses the arguments after `test`.
    pub fn parse(mut arguments: lexopt::Parser) -> Result<Options, String> {
        let mut options = Options::default();
        while let Some(argument) = arguments.next().map_err(|error| usage(&error.to_string()))? {
            match argument {
                Long("long") => options.long = true,
                Long("fail-fast") => options.fail_fast = true,
                Long("list") => options.list = true,
                Long("only") => options.only.push(stage_name(&mut arguments)?),
                Long("skip") => options.skip.push(stage_name(&mut arguments)?),
                other => return Err(usage(&other.unexpected().to_string())),
            }
        }
        Ok(options)
    }

    /// True if a stage is selected.
    fn wants(&self, stage: &Stage) -> bool {
        let named = |names: &[String]| names.iter().any(|name| name == stage.name);
        let selected = named(&self.only) || (self.only.is_empty() && (self.long || !stage.long));
        selected && !named(&self.skip)
    }
}

/// The value of `--only` or `--skip`.
fn stage_name(arguments: &mut lexopt::Parser) -> Result<String, String> {
    let value = arguments.value().map_err(|error| usage(&error.to_string()))?;
    let name = value.string().map_err(|error| usage(&error.to_string()))?;
    if stage::STAGES.iter().any(|stage| stage.name == name) {
        return Ok(name);
    }
    let known: Vec<&str> = stage::STAGES.iter().map(|stage| stage.name).collect();
    Err(format!("no stage '{name}': the stages are {}.", known.join(", ")))
}

/// Runs the stages and prints the table of results; the last line counts all tests.
pub fn run(repository: &Repository, options: &Options) -> Result<ExitCode, String> {
    let wanted: Vec<&Stage> = stage::STAGES.iter().filter(|stage| options.wants(stage)).collect();
    if options.list {
        wanted.iter().for_each(|stage| println!("{:<10} {}", stage.name, stage.what));
        return Ok(ExitCode::SUCCESS);
    }
    let profile = if options.long { Profile::Release } else { Profile::Dev };
    let python = Python::new(repository, profile);
    let mut workshop = Workshop { repository, profile, python, slowest: Slowest::default() };
    let reports = run_stages(&wanted, options.fail_fast, &mut workshop);
    if !workshop.slowest.is_empty() {
        println!("\n{}", workshop.slowest);
    }
    println!("\n{}", report::table(&reports));
    let failed: Vec<&Report> = reports.iter().filter(|report| report.failure.is_some()).collect();
    for Report { name, failure, .. } in &failed {
        println!("{name}: {}", failure.as_deref().unwrap_or_default());
    }
    let ok = failed.is_empty();
    println!("{}", reports.iter().map(|report| report.counts).sum::<Counts>());
    Ok(if ok { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn run_stages(stages: &[&Stage], fail_fast: bool, workshop: &mut Workshop<'_>) -> Vec<Report> {
    let mut reports = Vec::new();
    for (index, stage) in stages.iter().enumerate() {
        println!("\n== {} ({} of {}): {}", stage.name, index + 1, stages.len(), stage.what);
        let report = run_stage(stage, workshop);
        let verdict = if report.failure.is_some() { "FAILED" } else { "ok" };
        println!("== {}: {verdict} in {:.1} s", stage.name, report.time.as_secs_f64());
        let stop = fail_fast && report.failure.is_some();
        reports.push(report);
        if stop {
            break;
        }
    }
    reports
}

fn run_stage(stage: &Stage, workshop: &mut Workshop<'_>) -> Report {
    let start = Instant::now();
    let mut counts = Counts::default();
    let failure = (stage.run)(workshop, &mut counts).err();
    if failure.is_none() && counts == Counts::default() {
        counts = Counts::ONE;
    }
    if let Some(message) = &failure {
        println!("{message}");
    }
    Report::new(stage.name, counts, start.elapsed(), failure)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::Outcome;

    fn options(arguments: &[&str]) -> Result<Options, String> {
        Options::parse(lexopt::Parser::from_args(arguments))
    }

    fn wanted(arguments: &[&str]) -> Vec<&'static str> {
        let options = options(arguments).unwrap();
        stage::STAGES.iter().filter(|stage| options.wants(stage)).map(|stage| stage.name).collect()
    }

    #[test]
    fn without_options_everything_but_the_long_mode_runs() {
        let stages = wanted(&[]);
        assert!(stages.contains(&"fmt") && stages.contains(&"python"), "{stages:?}");
        assert!(!stages.contains(&"long"));
        let long = stage::STAGES.iter().filter(|stage| stage.long).count();
        assert!(long > 0);
        assert_eq!(wanted(&["--long"]).len(), stages.len() + long);
    }

    #[test]
    fn stages_are_picked_and_left_out() {
        assert_eq!(wanted(&["--only", "tidy", "--only=fmt"]), ["fmt", "tidy"]);
        assert_eq!(wanted(&["--only", "long"]), ["long"]);
        assert!(!wanted(&["--skip", "python"]).contains(&"python"));
    }

    #[test]
    fn wrong_arguments_are_named() {
        assert!(
            options(&["--only", "nothing"])
                .unwrap_err()
                .starts_with("no stage 'nothing': the stages are fmt, ")
        );
        assert!(options(&["--only"]).unwrap_err().contains("--only"));
        assert!(options(&["--fast"]).unwrap_err().contains("--fast"));
    }

    fn fails(_: &mut Workshop<'_>, _: &mut Counts) -> Outcome {
        Err("broken".to_owned())
    }

    fn passes(_: &mut Workshop<'_>, _: &mut Counts) -> Outcome {
        Ok(())
    }

    #[test]
    fn a_failing_stage_stops_the_others_only_on_request() {
        let repository = Repository::find().unwrap();
        let mut workshop = Workshop {
            repository: &repository,
            profile: Profile::Dev,
            python: Python::new(&repository, Profile::Dev),
            slowest: Slowest::default(),
        };
        let bad = Stage { name: "bad", what: "", long: false, run: fails };
        let good = Stage { name: "good", what: "", long: false, run: passes };
        let reports = run_stages(&[&bad, &good], false, &mut workshop);
        assert_eq!(reports.iter().map(|report| report.counts.failed).collect::<Vec<_>>(), [1, 0]);
        assert_eq!(reports[0].failure.as_deref(), Some("broken"));
        assert_eq!(reports[1].counts, Counts::ONE);
        assert_eq!(run_stages(&[&bad, &good], true, &mut workshop).len(), 1);
    }
}
