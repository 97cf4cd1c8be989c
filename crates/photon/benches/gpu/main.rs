//! Correctness and speed of a graphics card beside the CPU on all cores, in the same run, as tables: rays through models, and photons in
//! detectors.
//!
//! ```text
//! cargo bench -p rayweave-photon --features gpu --bench gpu -- [--rays N] [--photons N] [--models die,lens,water,...]
//!     [--in-flight N] [--adapter K] [--out FOLDER]
//! ```
//!
//! With `--out` it writes `gpu.md` and `gpu.json` to the folder; a relative one is within `crates/photon`, where Cargo runs benchmarks.
//! Every row compares the answers of the card with those of the CPU bit for bit. The exit status is 1 if any differs. `--rays 0` and
//! `--photons 0` leave out a table. `--in-flight` is the number of batches of photons in flight, by default 2.

mod detectors;
mod models;
mod photons;
mod rays;

use detectors::DETECTORS;
use models::SCENES;
use rayweave_gpu::{Adapter, Gpu};
use rayweave_model::drive::thread_count;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;

type Failure = Box<dyn std::error::Error>;

struct Options {
    rays: usize,
    photons: u64,
    models: Vec<String>,
    adapter: usize,
    in_flight: NonZeroUsize,
    out: Option<PathBuf>,
}

impl Options {
    fn new() -> Result<Options, Failure> {
        let mut options = Options {
            rays: 1 << 22,
            photons: 1 << 20,
            models: Vec::new(),
            adapter: 0,
            in_flight: NonZeroUsize::MIN.saturating_add(1),
            out: None,
        };
        // Cargo passes `--bench`
        let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
        while let Some(name) = arguments.next() {
            let value = arguments.next().ok_or_else(|| format!("{name} needs a value"))?;
            match name.as_str() {
                "--rays" => options.rays = value.parse()?,
                "--photons" => options.photons = value.parse()?,
                "--models" => options.models = value.split(',').map(str::to_owned).collect(),
                "--in-flight" => options.in_flight = value.parse()?,
                "--adapter" => options.adapter = value.parse()?,
                "--out" => options.out = Some(value.into()),
                _ => return Err(format!("unknown option {name}").into()),
            }
        }
        if let Some(folder) = &options.out {
            std::fs::create_dir_all(folder)?;
        }
        Ok(options)
    }

    fn selects(&self, name: &str) -> bool {
        self.models.is_empty() || self.models.iter().any(|wanted| wanted == name)
    }
}

/// The rows so far, and the models and detectors that have none, each with the reason.
#[derive(Default)]
struct Results {
    rays: Vec<rays::Row>,
    photons: Vec<photons::Row>,
    missing: Vec<String>,
    is_wrong: bool,
}

fn main() -> Result<ExitCode, Failure> {
    let options = Options::new()?;
    let gpu = Gpu::new();
    let adapter = gpu.adapter(options.adapter)?;
    let mut results = Results::default();
    for (name, make) in SCENES.iter().filter(|(name, _)| options.rays > 0 && options.selects(name)) {
        match rays::measure(&make()?, adapter, options.rays) {
            Ok(row) => {
                eprintln!("{}", rays::line(&row));
                results.rays.push(row);
            }
            Err(problem) => results.missing(name, &*problem, true),
        }
        results.write(adapter, &options)?;
    }
    for (name, make) in DETECTORS.iter().filter(|(name, _)| options.photons > 0 && options.selects(name)) {
        match photons::measure(&make()?, adapter, (options.photons, options.in_flight)) {
            Ok(row) => {
                eprintln!("{}", photons::line(&row));
                results.photons.push(row);
            }
            // some detectors are larger than the device can hold
            Err(problem) => {
                let is_too_large =
                    matches!(problem.downcast_ref(), Some(rayweave_gpu::GpuError::Unsupported(_)));
                results.missing(name, &*problem, !is_too_large);
            }
        }
        results.write(adapter, &options)?;
    }
    println!("{}", results.page(adapter));
    Ok(if results.is_right() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

impl Results {
    fn missing(&mut self, name: &str, problem: &dyn std::error::Error, is_wrong: bool) {
        self.missing.push(format!("{name}: {problem}"));
        self.is_wrong |= is_wrong;
    }

    fn is_right(&self) -> bool {
        !self.is_wrong
            && self.rays.iter().all(rays::Row::is_right)
            && self.photons.iter().all(photons::Row::is_right)
    }

    /// Writes the files. They are complete after every row, so that a run that is cut off leaves what it measured.
    fn write(&self, adapter: &Adapter, options: &Options) -> Result<(), Failure> {
        let Some(folder) = &options.out else { return Ok(()) };
        std::fs::write(folder.join("gpu.md"), self.page(adapter))?;
        std::fs::write(folder.join("gpu.json"), self.json(adapter))?;
        Ok(())
    }

    fn page(&self, adapter: &Adapter) -> String {
        let mut text = format!(
            "# A graphics card beside the CPU\n\nadapter `{}` ({:?}), driver `{}`; CPU: {} threads\n",
            adapter.name(),
            adapter.kind(),
            adapter.driver(),
            thread_count(None),
        );
        if !self.rays.is_empty() {
            text += &(rays::HEAD.to_owned() + &joined(self.rays.iter().map(rays::line), "\n"));
        }
        if !self.photons.is_empty() {
            text += &(photons::HEAD.to_owned() + &joined(self.photons.iter().map(photons::line), "\n"));
        }
        if !self.missing.is_empty() {
            text += &format!("\nNot measured:\n\n- {}\n", self.missing.join("\n- "));
        }
        text
    }

    fn json(&self, adapter: &Adapter) -> String {
        format!(
            "{{\"adapter\": {:?}, \"driver\": {:?}, \"threads\": {}, \"rows\": [\n{}], \"photons\": [\n{}]}}\n",
            adapter.name(),
            adapter.driver(),
            thread_count(None),
            joined(self.rays.iter().map(rays::json), ",\n").trim_end_matches(",\n"),
            joined(self.photons.iter().map(photons::json), ",\n").trim_end_matches(",\n"),
        )
    }
}

/// Lines, each with an ending.
fn joined(lines: impl Iterator<Item = String>, ending: &str) -> String {
    lines.map(|line| line + ending).collect()
}
