//! `rayweave photons`: optical photons in a detector.

use crate::arguments::{GlobalArguments, ModelArguments, point};
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal;
use clap::{Args, ValueEnum};
use rayweave::photon::{
    DetectionRule, Detector, End, Hits, PhotonRun, PointSource, RunSettings, Source, hit_schema, simulate,
};
use rayweave::table::TableWriter;
use rayweave::{Packets, Vec3};
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
/// A photon's history depends on the model, the seed and its number alone: the same photons end in the same way with any
/// number of threads, and --range simulates a part of a run.
///
/// The table has a row for each detected photon with the columns photon, x, y, z (mm), time (ns), dx, dy, dz, px, py, pz,
/// wavelength_nm, steps, sensor. Lengths are in mm.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 100000 -o hits.csv
  rayweave photons detector.gdml --at 0,0,0 --towards 0,0,1 --wavelength 420 -n 1000 --json
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 1000000 --range 0:250000 -o part1.npy")]
pub struct Photons {
    #[command(flatten)]
    model: ModelArguments,

    /// Kind of the source
    #[arg(long, value_name = "KIND", default_value = "point")]
    source: SourceKind,

    /// Position of the source, in mm
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    at: [f64; 3],

    /// Direction of the photons [default: all directions with equal probability]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    towards: Option<[f64; 3]>,

    /// Wavelength in vacuum, in nm
    #[arg(long, value_name = "NM")]
    wavelength: f64,

    /// Number of photons
    #[arg(short = 'n', long, value_name = "N", default_value_t = 10_000)]
    photons: u64,

    /// Simulate only the photons numbered A to B - 1 of the run
    #[arg(long, value_name = "A:B", value_parser = range)]
    range: Option<Range<u64>>,

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

/// The kinds of sources.
#[derive(Clone, Copy, ValueEnum)]
enum SourceKind {
    /// A point that emits unpolarised photons of one wavelength
    Point,
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
        let range = self.range.clone().unwrap_or(0..self.photons);
        if range.end > self.photons {
            let text = format!("--range ends at {}: the run has {} photons (-n).", range.end, self.photons);
            return Err(Failure::Usage(text));
        }
        let is_piped = self.out.as_deref() == Some("-".as_ref());
        if is_piped && self.json {
            let text = "--json and `-o -` both write to standard output: write one of them to a file.";
            return Err(Failure::Usage(text.to_owned()));
        }
        if let Some(path) = self.out.as_deref().filter(|_| !is_piped) {
            // a path that cannot be written is reported before the run, not after it; the unfinished file is removed
            TableWriter::create(path, &hit_schema(&Hits::default())?)?;
        }
        let SourceKind::Point = self.source;
        let point = PointSource::isotropic(Vec3::from_array(self.at), self.wavelength)?;
        let point = self.towards.map_or(Ok(point), |direction| point.towards(Vec3::from_array(direction)))?;
        let (document, scene) = self.model.load_document()?;
        let detector = Detector::new(&scene, &document)?;
        if !global.quiet {
            detector.notes().iter().for_each(|note| terminal::note(note));
        }
        let settings = RunSettings {
            seed: self.seed,
            detection: self.detect.rule().0,
            max_steps: self.max_steps,
            max_time: self.max_time,
            threads: global.threads,
            cancel: interrupt::token(),
            ..RunSettings::new(range)
        };
        let evaluator = Packets::new(detector.program().clone());
        let start = Instant::now();
        let run = simulate(&detector, &evaluator, &Source::Point(point), &settings);
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
