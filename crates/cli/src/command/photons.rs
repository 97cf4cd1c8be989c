//! `rayweave photons`: optical photons in a detector.

use super::photon_source::SourceArguments;
use crate::arguments::{GlobalArguments, ModelArguments};
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal;
use clap::{Args, ValueEnum};
use rayweave::Packets;
use rayweave::photon::{
    DetectionRule, Detector, End, Hits, PhotonRun, RunSettings, check_start, hit_schema, simulate,
};
use rayweave::table::TableWriter;
use serde_json::{Value, json};
use std::ops::Range;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Simulate optical photons in a detector and report how they end
///
/// The optical properties are those of a GDML file: material properties such as RINDEX and ABSLENGTH, border and skin surfaces,
/// and sensitive volumes (auxiliary tag SensDet). The physics is that of Geant4: absorption, Rayleigh and Mie scattering,
/// wavelength shifting and the optical boundary process. The geometry is exact.
///
/// A photon's history depends on the model, the seed, the event and its number alone: the same photons end in the same way with any
/// number of threads, and --range simulates a part of a run.
///
/// The table has a row for each detected photon with the columns event, photon, x, y, z (mm), time (ns), dx, dy, dz, px, py, pz,
/// wavelength_nm, steps, sensor. Lengths are in mm.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 100000 -o hits.csv
  rayweave photons detector.gdml --at 0,0,0 --towards 0,0,1 --wavelength 420 -n 1000 --json
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 1000000 --range 0:250000 -o part1.npy
  rayweave photons detector.gdml --source volume --volume Target --spectrum emission.csv --time-decay 6 -o hits.csv
  rayweave photons detector.gdml --gensteps gensteps.npy --event 7 -o hits.csv")]
pub struct Photons {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    source: SourceArguments,

    /// Number of photons [default: 10000, or all photons of --gensteps or --photons]
    #[arg(short = 'n', long, value_name = "N")]
    count: Option<u64>,

    /// Simulate only the photons numbered A to B - 1 of the run
    #[arg(long, value_name = "A:B", value_parser = range)]
    range: Option<Range<u64>>,

    /// Number of the event: photons of different events have different random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    event: u32,

    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Rule of detection: absorption at a surface with the probability EFFICIENCY, entering a sensitive volume, or both
    #[arg(long, value_name = "RULE", default_value = "both")]
    detect: Rule,

    /// Maximum number of steps of a photon
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    max_steps: u32,

    /// Maximum time of a photon, in ns
    #[arg(long, value_name = "NS", default_value_t = f64::INFINITY)]
    max_time: f64,

    /// Table of hits: .csv, .npy (with a table of names) or .parquet (if built in); - writes CSV to standard output
    #[arg(short, long, value_name = "TABLE")]
    out: Option<PathBuf>,

    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// Names of [`DetectionRule`].
#[derive(Clone, Copy, ValueEnum)]
enum Rule {
    Efficiency,
    Volume,
    Both,
}

impl Rule {
    fn rule(self) -> (DetectionRule, &'static str) {
        match self {
            Rule::Efficiency => (DetectionRule::Efficiency, "efficiency"),
            Rule::Volume => (DetectionRule::Volume, "volume"),
            Rule::Both => (DetectionRule::Both, "both"),
        }
    }
}

impl Photons {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let is_piped = self.out.as_deref() == Some("-".as_ref());
        if is_piped && self.json {
            let text = "--json and `-o -` both write to standard output: write one of them to a file.";
            return Err(Failure::Usage(text.to_owned()));
        }
        if let Some(path) = self.out.as_deref().filter(|_| !is_piped) {
            // a path that cannot be written is reported before the run, not after it; the unfinished file is removed
            TableWriter::create(path, &hit_schema(&Hits::default())?)?;
        }
        let (document, scene) = self.model.load_document()?;
        let detector = Detector::new(&scene, &document)?;
        let note = |text: &str| {
            if !global.quiet {
                terminal::note(text);
            }
        };
        detector.notes().iter().for_each(|text| note(text));
        let evaluator = Packets::new(detector.program().clone());
        let source = self.source.source(&detector, &evaluator, note)?;
        let range = self.numbers(source.limit())?;
        let settings = RunSettings {
            seed: self.seed,
            event: self.event,
            detection: self.detect.rule().0,
            max_steps: self.max_steps,
            max_time: self.max_time,
            threads: global.threads,
            cancel: interrupt::token()?,
            ..RunSettings::new(range)
        };
        if let Some(text) = check_start(&detector, &evaluator, &source, &settings)? {
            note(&text);
        }
        let start = Instant::now();
        let run = simulate(&detector, &evaluator, &source, &settings);
        let (run, duration) = (run?, start.elapsed());
        if let Some(path) = &self.out {
            let mut table = TableWriter::create(path, &hit_schema(&run.hits)?)?;
            table.write(&run.hits.to_rows()?)?;
            table.finish()?;
        }
        match () {
            () if self.json => terminal::print(&format!("{:#}\n", self.json(&run, duration))),
            () if is_piped || global.quiet => Ok(()),
            () => terminal::print(&self.text(&run, duration)),
        }
    }

    /// The numbers of the photons to simulate.
    fn numbers(&self, limit: Option<u64>) -> Result<Range<u64>, Failure> {
        let count = self.count.or(limit).unwrap_or(10_000);
        if let Some(limit) = limit.filter(|limit| *limit < count) {
            let text = format!("-n is {count}: the source has {limit} photons.");
            return Err(Failure::Usage(text));
        }
        let range = self.range.clone().unwrap_or(0..count);
        if range.end > count {
            let text = format!("--range ends at {}: the run has {count} photons.", range.end);
            return Err(Failure::Usage(text));
        }
        Ok(range)
    }

    fn json(&self, run: &PhotonRun, duration: Duration) -> Value {
        let ends: serde_json::Map<String, Value> = End::ALL
            .iter()
            .map(|end| (end.name().to_owned(), json!(run.ends.get(end).unwrap_or(&0))))
            .collect();
        json!({
            "photons": run.photons,
            "hits": run.hits.len(),
            "steps": run.steps,
            "seconds": terminal::rounded(duration.as_secs_f64(), 6),
            "detection": self.detect.rule().1,
            "ends": ends,
        })
    }

    fn text(&self, run: &PhotonRun, duration: Duration) -> String {
        let percent = |count: u64| format!("{:.2}", 100.0 * count as f64 / run.photons.max(1) as f64);
        let row = |end: &End| {
            let count = *run.ends.get(end)?;
            Some(vec![end.name().to_owned(), count.to_string(), percent(count)])
        };
        let rows: Vec<Vec<String>> = End::ALL.iter().filter_map(row).collect();
        let seconds = duration.as_secs_f64();
        let rate = |count: u64| terminal::short3(count as f64 / seconds.max(1e-9));
        format!(
            "{}\n{} photons, {} steps in {} s: {} photons/s, {} steps/s; detection by {}\n",
            terminal::table(&["end", "photons", "%"], &rows, &[false, true, true]),
            run.photons,
            run.steps,
            terminal::short3(seconds),
            rate(run.photons),
            rate(run.steps),
            self.detect.rule().1,
        )
    }
}

/// A range of photon numbers, `A:B`.
fn range(text: &str) -> Result<Range<u64>, String> {
    let ends = text.split_once(':').and_then(|(a, b)| Some(a.trim().parse().ok()?..b.trim().parse().ok()?));
    match ends {
        Some(range) if range.start <= range.end => Ok(range),
        _ => Err("give two whole numbers as A:B, with A at most B".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges() {
        assert_eq!(range("3:10"), Ok(3..10));
        for bad in ["", "3", "10:3", "-1:2", "a:b", "1:2:3"] {
            assert!(range(bad).is_err(), "{bad}");
        }
    }
}
