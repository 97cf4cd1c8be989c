//! `rayweave merge`: the whole result from its parts.

use super::check::read_check_share;
use super::volume::read_share;
use crate::arguments::GlobalArguments;
use crate::failure::{Failure, unreadable};
use crate::terminal;
use clap::Args;
use rayweave::check::CheckShare;
use rayweave::measure::MeasureShare;
use rayweave::render::png;
use rayweave::table::{Counts, PartSet};
use serde_json::json;
use std::path::{Path, PathBuf};

const AFTER_HELP: &str = "\
Examples:
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 1000000 --range 0:500000 -o part0.npy
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 1000000 --range 500000:1000000 -o part1.npy
  rayweave merge part0.npy part1.npy -o hits.npy
  rayweave merge part*.npy -o hits.npy --json
  rayweave merge --missing 1000000 part*.npy";

/// Join parts of a result, which were computed with --range, to the whole
///
/// The order of the parts does not matter. The merged file has the bytes of the file that a single run writes. Parts of different
/// models, seeds or settings, parts that overlap, gaps between parts, and incomplete or damaged files are errors that name the files
/// or the missing ranges.
#[derive(Args)]
#[command(after_help = AFTER_HELP)]
pub struct Merge {
    /// Parts
    #[arg(value_name = "PART")]
    parts: Vec<PathBuf>,

    /// The whole, in the format of the parts
    #[arg(short, long, value_name = "WHOLE", required_unless_present = "missing")]
    out: Option<PathBuf>,

    /// Print the ranges of 0:TOTAL that no complete part covers, one per line, instead of merging; absent and damaged files count as
    /// missing
    #[arg(long, value_name = "TOTAL", conflicts_with = "out", value_parser = crate::arguments::any_count::<u64>)]
    missing: Option<u64>,

    /// Print the counts of the whole as JSON: parts, and for photons also photons, hits, steps, ends, sensors, and processes if all
    /// parts were computed with --counts
    #[arg(long, conflicts_with = "missing")]
    json: bool,
}

impl Merge {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        if let Some(total) = self.missing {
            return self.print_missing(total, global);
        }
        let set = PartSet::read(&self.parts)?;
        let Some(out) = &self.out else { return Ok(()) };
        match set.first().map(|part| part.query.as_str()) {
            Some("render") => stack(&set, out)?,
            Some("volume") => add(&set, out)?,
            Some("check") => join(&set, out)?,
            _ => set.merge_tables(out)?,
        }
        let counts = set.counts();
        if self.json {
            let mut report = counts.map_or(json!({}), |counts| counts.to_json());
            report["parts"] = set.parts().len().into();
            return terminal::print(&format!("{report:#}\n"));
        }
        if global.quiet {
            return Ok(());
        }
        let mut text = format!("{}: {}", out.display(), terminal::count(set.parts().len() as u64, "part"));
        if let Some(Counts::Group(counts)) = counts {
            for (name, number) in counts.iter().filter_map(|(name, counts)| Some((name, counts.number()?))) {
                text += &format!(", {number} {name}");
            }
        }
        terminal::print(&(text + "\n"))
    }

    fn print_missing(&self, total: u64, global: &GlobalArguments) -> Result<(), Failure> {
        let (set, errors) = PartSet::read_complete(&self.parts)?;
        if let Some(part) = set.first().filter(|part| part.total != total) {
            let text = format!("--missing is {total}: the parts are of {} items.", part.total);
            return Err(Failure::Usage(text));
        }
        if !global.quiet {
            errors.iter().for_each(|error| terminal::note(&format!("note: {error}")));
        }
        let ranges = set.missing(total);
        terminal::print(
            &ranges.iter().map(|range| format!("{}:{}\n", range.start, range.end)).collect::<String>(),
        )
    }
}

/// Joins rows of a picture.
fn stack(set: &PartSet, out: &Path) -> Result<(), Failure> {
    set.check_whole()?;
    let read = |path: &Path| std::fs::read(path).map_err(|error| unreadable(path, &error));
    let pictures: Vec<Vec<u8>> = set.parts().map(|(path, _)| read(path)).collect::<Result<_, _>>()?;
    let whole = png::stack(&pictures).map_err(|error| Failure::Input(error.to_string()))?;
    terminal::save(out, &whole)
}

/// Adds the sums of a measurement. The result is a part of its own, the whole range, which `rayweave volume --sums` reads.
fn add(set: &PartSet, out: &Path) -> Result<(), Failure> {
    set.check_whole()?;
    let mut whole: Option<MeasureShare> = None;
    for (path, _) in set.parts() {
        let share = read_share(path)?;
        match &mut whole {
            Some(whole) => whole.append(&share),
            None => whole = Some(share),
        }
    }
    let (Some(whole), Some(first)) = (whole, set.first()) else { return Ok(()) };
    let mut part = first.clone();
    part.range = 0..first.total;
    Ok(part.write(out, whole.to_text().as_bytes())?)
}

/// Joins results of searches. The result is a part of its own, which `rayweave check --searches` reads.
fn join(set: &PartSet, out: &Path) -> Result<(), Failure> {
    set.check_whole()?;
    let mut whole = CheckShare::default();
    for (path, _) in set.parts() {
        whole.append(read_check_share(path)?);
    }
    let Some(first) = set.first() else { return Ok(()) };
    let mut part = first.clone();
    part.range = 0..first.total;
    Ok(part.write(out, whole.to_text().as_bytes())?)
}
