//! The sub-commands, one file each.

mod bench;
mod check;
mod completions;
mod convert;
mod diff;
mod export;
mod infill;
mod info;
mod man;
mod optics;
mod probe;
mod render;
mod schema;
mod section;
mod shapes;
mod thickness;
mod trace;
mod tree;
mod volume;

pub use bench::Bench;
pub use check::Check;
pub use completions::Completions;
pub use convert::Convert;
pub use diff::Diff;
pub use export::Export;
pub use infill::Infill;
pub use info::Info;
pub use man::Man;
pub use optics::Optics;
pub use probe::Probe;
pub use render::Render;
pub use schema::Schema;
pub use section::Section;
pub use shapes::Shapes;
pub use thickness::Thickness;
pub use trace::Trace;
pub use volume::Volume;

use crate::arguments::{Cli, Command};
use crate::failure::Failure;

/// Runs the sub-command.
pub fn run(cli: &Cli) -> Result<(), Failure> {
    match &cli.command {
        Command::Render(render) => render.run(cli),
        Command::Probe(probe) => probe.run(),
        Command::Trace(trace) => trace.run(cli),
        Command::Optics(optics) => optics.run(cli),
        Command::Convert(convert) => convert.run(cli),
        Command::Export(export) => export.run(),
        Command::Infill(infill) => infill.run(cli),
        Command::Volume(volume) => volume.run(cli),
        Command::Diff(diff) => diff.run(cli),
        Command::Check(check) => check.run(cli),
        Command::Section(section) => section.run(cli),
        Command::Thickness(thickness) => thickness.run(cli),
        Command::Info(info) => info.run(),
        Command::Bench(bench) => bench.run(cli),
        Command::Shapes(shapes) => shapes.run(),
        Command::Schema(schema) => schema.run(),
        Command::Completions(completions) => completions.run(),
        Command::Man(man) => man.run(cli),
    }
}
