//! `rayweave trace`: a table of the crossings of a file of rays.

use crate::arguments::{GlobalArguments, ModelArguments, PartArguments, SubjectArguments, time};
use crate::device::DeviceArguments;
use crate::failure::{Failure, unreadable};
use crate::interrupt::{self, Interruptible};
use crate::terminal::{self, Unit};
use clap::Args;
use rayweave::hits::{TraceOptions, trace_rays};
use rayweave::model::Limit;
use rayweave::model::drive::Cancel;
use rayweave::scene::Scene;
use rayweave::table::{ContentHash, Part, RayReader, TableError, TableWriter};
use rayweave::{Compiled, Query, Window};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// Trace a file of rays and write the table of their crossings
///
/// Rays are CSV with the header ox,oy,oz,dx,dy,dz, or NPY of shape (N, 6). The table has the columns ray, crossing, t, x, y,
/// z, nx, ny, nz, enters, surface, solid, medium_before, medium_after, and occurrence with --occurrence. Both files are streamed:
/// the memory required does not grow with the number of rays. The output file appears when it is complete.
#[derive(Args)]
pub struct Trace {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    /// Rays: .csv or .npy; - reads CSV from standard input
    #[arg(long, value_name = "RAYS")]
    rays: PathBuf,

    /// Table: .csv, .npy (with a table of names) or .parquet (if built in); - writes CSV to standard output
    #[arg(short, long, value_name = "HITS")]
    out: PathBuf,

    /// Only the first crossing of each ray after --t-min, whose default is then 0
    #[arg(long)]
    nearest: bool,

    /// Only crossings after this time, in units of the ray's direction [default: -inf]
    #[arg(long, value_name = "T", value_parser = time, allow_hyphen_values = true)]
    t_min: Option<f64>,

    /// Only crossings before this time [default: inf]
    #[arg(long, value_name = "T", value_parser = time, allow_hyphen_values = true)]
    t_max: Option<f64>,

    /// Add the column occurrence: which copy of which shape was hit, such as tower[3]/brick[12]/hole
    #[arg(long)]
    occurrence: bool,

    #[command(flatten)]
    device: DeviceArguments,

    #[command(flatten)]
    part: PartArguments,
}

impl Trace {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let query = self.query()?;
        if self.part.range.is_some() {
            TableWriter::check_part(&self.out)?;
        }
        let scene = self.model.load_for(self.subject.solid.as_deref())?;
        let part = self.part(&scene)?;
        if self.part.is_done(part.iter().map(|part| (self.out.as_path(), part)), global.quiet) {
            return Ok(());
        }
        let compiled = Compiled::named(&scene, self.subject.solid.as_deref())?;
        let (evaluator, program) = (self.subject.evaluator.as_deref(), compiled.program.clone());
        let chosen = self.device.choose(evaluator, program, global.quiet)?;
        let cancel = interrupt::token();
        let rays = open(&self.rays, &cancel).map_err(|error| input_failure(error, &cancel))?;
        let options = TraceOptions {
            query,
            threads: global.threads,
            occurrences: self.occurrence,
            cancel: cancel.clone(),
            part,
        };
        let bar = terminal::progress_bar(rays.progress().total, Unit::Bytes, global.quiet);
        let evaluator = chosen.evaluator.evaluator();
        let traced = trace_rays(&compiled, evaluator, rays, &self.out, &options, |progress| {
            bar.set_position(progress.done);
            if chosen.evaluator.finish().is_err() {
                // the table does not appear
                cancel.cancel();
            }
        });
        bar.finish_and_clear();
        chosen.finish()?;
        let summary = match traced {
            Err(_) if cancel.is_cancelled() => return Err(Failure::Cancelled),
            traced => traced?,
        };
        if global.quiet || self.out == Path::new("-") {
            return Ok(());
        }
        let (rays, crossings) = (summary.rays, summary.crossings);
        let out = self.out.display();
        let rays = terminal::count(rays, "ray");
        terminal::print(&format!("{out}: {crossings} crossings of {rays}\n{}", chosen.summary()))
    }

    /// The part to trace, if a range is given.
    fn part(&self, scene: &Scene) -> Result<Option<Part>, Failure> {
        if self.part.range.is_none() {
            return Ok(None);
        }
        // a file that is missing is reported like any other input
        if self.rays.as_os_str() == "-" || (self.rays.exists() && !self.rays.is_file()) {
            let text = "--range needs a file of rays: the other rays of a stream are not known.";
            return Err(Failure::Usage(text.to_owned()));
        }
        let mut rays = ContentHash::new();
        rays.file(&self.rays).map_err(|error| unreadable(&self.rays, &error))?;
        let bound = |t: Option<f64>| t.map_or_else(|| "default".to_owned(), |t| t.to_string());
        let settings = [
            ("model", scene.content_hash()),
            ("solid", self.subject.solid.clone().unwrap_or_default()),
            ("rays", rays.finish()),
            ("nearest", self.nearest.to_string()),
            ("t_min", bound(self.t_min)),
            ("t_max", bound(self.t_max)),
            ("occurrence", self.occurrence.to_string()),
        ];
        // the total is known when the rays have been read
        Ok(self.part.part("trace", settings, 0))
    }

    fn query(&self) -> Result<Query<'static>, Failure> {
        let (start, limit) = match self.nearest {
            true => (0.0, Limit::First),
            false => (f64::NEG_INFINITY, Limit::All),
        };
        let window = Window::new(self.t_min.unwrap_or(start), self.t_max.unwrap_or(f64::INFINITY))?;
        Ok(Query { window, limit, starts: None })
    }
}

/// Opens the ray file such that reading from a pipe can be cancelled.
fn open(path: &Path, cancel: &Cancel) -> Result<RayReader, TableError> {
    if path == Path::new("-") {
        let stdin = Interruptible::new(|| Ok(io::stdin()), cancel.clone());
        return RayReader::from_csv(stdin, "stdin");
    }
    let is_pipe = std::fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir());
    let is_csv = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    if is_pipe && is_csv {
        let own = path.to_owned();
        let pipe = Interruptible::new(move || File::open(own), cancel.clone());
        return RayReader::from_csv(pipe, path.display().to_string());
    }
    RayReader::open(path)
}

fn input_failure(error: TableError, cancel: &Cancel) -> Failure {
    match cancel.is_cancelled() {
        true => Failure::Cancelled,
        false => rayweave::Error::from(error).into(),
    }
}
