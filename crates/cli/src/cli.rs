//! The command line and its sub-commands.

use crate::arguments::GlobalArguments;
use crate::command::{
    Check, Completions, Convert, Diff, Export, Infill, Info, Man, Merge, New, Optics, Photons, Probe, Render,
    Schema, Section, Shapes, Thickness, Trace, Volume, Watch,
};
use crate::failure::Failure;
use crate::terminal;
use clap::{CommandFactory, Parser, Subcommand};

const AFTER_HELP: &str = "\
Exit codes:
  0    done
  1    the run failed, for example because a file could not be written
  2    the command line is invalid
  3    the model or another input file is invalid or cannot be read
  130  cancelled by Ctrl-C or a termination signal; unfinished files are removed

Environment:
  RAYWEAVE_THREADS  the number of threads, unless --threads is given
  NO_COLOR          if set, messages have no colours

Examples:
  rayweave new lens.toml lens
  rayweave render lens.toml
  rayweave probe lens.toml --from -100,0,0 --to 100,0,0
  rayweave trace lens.toml --rays rays.csv -o hits.csv
  rayweave optics doublet.toml
  rayweave volume lens.toml";

/// Exact ray tracing through constructive solid geometry
///
/// A model file describes solids as boolean expressions of shapes. The command renders, measures, checks and converts
/// models, and traces rays and light through them.
#[derive(Parser)]
#[command(name = "rayweave", version, after_help = AFTER_HELP, max_term_width = 100)]
pub struct Cli {
    #[command(flatten)]
    pub global: GlobalArguments,

    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    New(New),
    Render(Render),
    Watch(Watch),
    Probe(Probe),
    Trace(Trace),
    Optics(Optics),
    Photons(Photons),
    Merge(Merge),
    Convert(Convert),
    Export(Export),
    Infill(Infill),
    Volume(Volume),
    Check(Check),
    Section(Section),
    Diff(Diff),
    Thickness(Thickness),
    Info(Info),
    #[cfg(feature = "gpu")]
    Devices(crate::command::Devices),
    #[cfg(feature = "bench")]
    Bench(crate::command::Bench),
    Shapes(Shapes),
    Schema(Schema),
    Completions(Completions),
    Man(Man),
}

/// Runs the sub-command.
pub fn run(cli: &Cli) -> Result<(), Failure> {
    let global = &cli.global;
    if global.quiet {
        terminal::silence_warnings();
    }
    match &cli.command {
        Command::New(new) => new.run(global),
        Command::Render(render) => render.run(global),
        Command::Watch(watch) => watch.run(global),
        Command::Probe(probe) => probe.run(),
        Command::Trace(trace) => trace.run(global),
        Command::Optics(optics) => optics.run(global),
        Command::Photons(photons) => photons.run(global),
        Command::Merge(merge) => merge.run(global),
        Command::Convert(convert) => convert.run(global),
        Command::Export(export) => export.run(global),
        Command::Infill(infill) => infill.run(global),
        Command::Volume(volume) => volume.run(global),
        Command::Diff(diff) => diff.run(global),
        Command::Check(check) => check.run(global),
        Command::Section(section) => section.run(global),
        Command::Thickness(thickness) => thickness.run(global),
        Command::Info(info) => info.run(),
        #[cfg(feature = "gpu")]
        Command::Devices(devices) => devices.run(),
        #[cfg(feature = "bench")]
        Command::Bench(bench) => bench.run(global),
        Command::Shapes(shapes) => shapes.run(),
        Command::Schema(schema) => schema.run(),
        Command::Completions(completions) => completions.run(&mut Cli::command()),
        Command::Man(man) => man.run(Cli::command(), global),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_description_is_consistent() {
        Cli::command().debug_assert();
    }
}
