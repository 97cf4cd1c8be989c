//! A run of the benchmark, from its options to its output files.

use crate::arguments::Arguments;
use crate::ceiling::Ceilings;
use crate::exemplar::{self, Bench, Exemplar};
use crate::interleaved::Effort;
use crate::peers::Peers;
use crate::report::{self, Figure, Report, Section};
use crate::{instructions, level, machine};
use std::fs;
use std::path::Path;

/// Runs the benchmark. Tables go to standard output as soon as they are complete.
///
/// # Errors
/// No exemplar is selected, or a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    let exemplars = exemplar::all(arguments.large);
    let wanted: Vec<&dyn Exemplar> =
        exemplars.iter().map(AsRef::as_ref).filter(|exemplar| arguments.wants(exemplar.name())).collect();
    if arguments.list {
        wanted.iter().for_each(|exemplar| println!("{:24} {}", exemplar.name(), exemplar.about()));
        return Ok(());
    }
    if wanted.is_empty() {
        return Err(format!(
            "no exemplar has a name that begins with {:?}. --list prints the names.",
            arguments.only
        ));
    }
    match arguments.effort() {
        Effort::Once { .. } => wanted.iter().try_for_each(|exemplar| once(*exemplar, arguments)),
        _ => measure(&wanted, arguments),
    }
}

/// A run under a tool that counts instructions: without ceilings, peers and tables.
fn once(exemplar: &dyn Exemplar, arguments: &Arguments) -> Result<(), String> {
    let bench = Bench::new(arguments, None, Peers::default());
    exemplar.measure(&bench).map(|_| ())
}

fn measure(wanted: &[&dyn Exemplar], arguments: &Arguments) -> Result<(), String> {
    let machine = machine::description();
    let levels = level::available(arguments.level.as_deref());
    let ceilings = Ceilings::measure(&levels, arguments.thread_count(), &arguments.effort())?;
    println!("{}", report::ceilings(&ceilings));
    let peers = Peers::start(arguments.peers.as_deref(), arguments.clock(), arguments.thread_count())
        .map_err(|error| format!("peers: {error}"))?;
    let (running, missing) = (peers.running(), peers.missing.clone());
    for (name, reason) in &missing {
        println!("{name} is missing: {reason}");
    }
    let bench = Bench::new(arguments, Some(ceilings), peers);
    let mut sections = Vec::new();
    for exemplar in wanted {
        for section in exemplar_sections(*exemplar, &bench, arguments) {
            println!("\n{}: {}\n\n{}", section.name, section.about, report::section(&section));
            sections.push(section);
        }
    }
    let ceilings = bench.ceilings.ok_or("no ceilings were measured")?;
    let (date, command) = (machine::today(), command());
    write(arguments, &Report { date, command, machine, ceilings, peers: running, missing, sections })
}

/// The sections of an exemplar; if it fails, a section with the reason.
fn exemplar_sections(exemplar: &dyn Exemplar, bench: &Bench, arguments: &Arguments) -> Vec<Section> {
    let mut sections = exemplar.measure(bench).unwrap_or_else(|problem| {
        let mut section = Section::new(exemplar.name(), "ray", exemplar.about());
        section.failures.push(("all".to_owned(), problem));
        vec![section]
    });
    if arguments.instructions {
        // counting builds the model again for each candidate, so exemplars with several sections
        // are left out
        let alone = sections.iter_mut().filter(|section| section.name == exemplar.name());
        alone.for_each(|section| count_instructions(section, &bench.peers));
    }
    sections
}

/// Counts the instructions of all candidates that run in this process on one thread.
fn count_instructions(section: &mut Section, peers: &Peers) {
    let elsewhere: Vec<String> = peers.running().into_iter().map(|(name, _)| name).collect();
    let is_here = |figure: &&mut Figure| figure.threads == 1 && !elsewhere.contains(&figure.name);
    for figure in section.figures.iter_mut().filter(is_here) {
        match instructions::count(&section.name, &figure.name) {
            Ok(count) => figure.instructions = count,
            Err(problem) => section.failures.push((figure.name.clone(), problem)),
        }
    }
}

/// The command line without the folder of the program.
fn command() -> String {
    let word = |word: String| match Path::new(&word) {
        path if path.is_absolute() => {
            path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
        }
        _ => word,
    };
    std::env::args().map(word).collect::<Vec<_>>().join(" ")
}

fn write(arguments: &Arguments, report: &Report) -> Result<(), String> {
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&report::json(report)).map_err(|error| error.to_string())?;
        save(path, &(text + "\n"))?;
    }
    let plot = arguments.plot();
    if let Some(path) = &plot {
        save(path, &report::plot(report))?;
    }
    if let Some(path) = &arguments.markdown {
        let name = plot.as_ref().and_then(|plot| plot.file_name()).map(|name| name.to_string_lossy());
        save(path, &report::markdown(report, name.as_deref()))?;
    }
    Ok(())
}

/// Writes a file atomically.
fn save(path: &Path, text: &str) -> Result<(), String> {
    let beside = path.with_extension("unfinished");
    let written = fs::write(&beside, text).and_then(|()| fs::rename(&beside, path));
    written.map_err(|error| format!("cannot write {}: {error}", path.display()))
}
