//! `rayweave optics`: light through the solids of a model.

use crate::arguments::{Cli, ModelArguments};
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal::{self, Unit, short};
use clap::{Args, ValueEnum};
use rayweave::Packets;
use rayweave::files::{LightSummary, trace_light};
use rayweave::optics::file::{OpticalScene, optics_of};
use rayweave::optics::{Branches, Segments, System, Tracer};
use rayweave::scene::{Diagnostic, Diagnostics, Document};
use rayweave::{Affine, Vec3};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Trace light through a model and tell where its power goes
///
/// The [optics] tables of the model say what shines, what the media are, what faces and sheets do to light, and how it is
/// followed. The summary tells for each element how much power ended there, and for each sheet how many rays met it, where
/// their centroid lies in the sheet's own x and y, and the RMS distance from it, both weighted by power.
///
/// The table has a row for each piece of a ray between two events, with the columns id, parent, generation, source,
/// wavelength_nm, intensity, index, x0, y0, z0, x1, y1, z1, x_tilt, y_tilt, z_tilt, path, element, surface, event. It is
/// streamed: memory does not grow with the number of rays. It appears under its name when it is complete.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave optics doublet.toml
  rayweave optics doublet.toml -D R3=120 --branches both --out segments.csv")]
pub struct Optics {
    #[command(flatten)]
    model: ModelArguments,

    /// The table of segments, .csv, .npy (with the names beside it) or .parquet if built so; - is CSV to standard output
    #[arg(short, long, value_name = "TABLE")]
    out: Option<PathBuf>,

    /// Where light is both reflected and transmitted, follow the one without losses, both, or one at random [default: what the model says]
    #[arg(long, value_name = "WAY")]
    branches: Option<Ways>,

    /// Follow polarisation, whatever the model says
    #[arg(long)]
    polarised: bool,

    /// The seed of random choices [default: what the model says]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// The names of [`Branches`].
#[derive(Clone, Copy, ValueEnum)]
enum Ways {
    Ideal,
    Both,
    Random,
}

impl From<Ways> for Branches {
    fn from(ways: Ways) -> Branches {
        match ways {
            Ways::Ideal => Branches::Ideal,
            Ways::Both => Branches::Both,
            Ways::Random => Branches::Random,
        }
    }
}

impl Optics {
    pub fn run(&self, cli: &Cli) -> Result<(), Failure> {
        let is_piped = self.out.as_deref() == Some(Path::new("-"));
        if is_piped && self.json {
            let problem = "the table and the summary both go to standard output (--out - and --json)";
            return Err(Failure::Usage(format!("{problem} give the table a file?")));
        }
        let (document, scene) = self.model.load_document()?;
        let optics = self.settled(cli, optics_of(&document, &scene)?)?;
        if optics.sources.count() == 0 {
            return Err(no_source(&document).into());
        }
        let (unit, system) = (scene.unit.symbol(), optics.assembly.compile()?);
        let mut spots = Spots::new(&system);
        let summary = self.trace(cli, &optics, &system, unit, &mut spots)?;
        let told = Told { name: self.model.name(), unit, system: &system, summary, spots };
        match self.json {
            true => terminal::print(&format!("{:#}\n", told.as_json())),
            false if cli.quiet || is_piped => Ok(()),
            false => terminal::print(&told.as_text()),
        }
    }

    /// The scene with the settings of the command line.
    fn settled(&self, cli: &Cli, mut optics: OpticalScene) -> Result<OpticalScene, Failure> {
        let settings = &mut optics.settings;
        settings.branches = self.branches.map_or(settings.branches, Branches::from);
        settings.polarised |= self.polarised;
        settings.seed = self.seed.unwrap_or(settings.seed);
        settings.threads = cli.threads;
        settings.cancel = interrupt::token()?;
        Ok(optics)
    }

    fn trace(
        &self,
        cli: &Cli,
        optics: &OpticalScene,
        system: &System,
        unit: &str,
        spots: &mut Spots,
    ) -> Result<LightSummary, Failure> {
        let bar = terminal::progress_bar(Some(optics.sources.count()), Unit::Percent, cli.quiet);
        let tracer = Tracer::new(system, Packets::new);
        let out = self.out.as_deref().map(|path| (path, unit));
        let look = |segments: &Segments| {
            spots.add(segments);
            bar.set_position(segments.id.iter().max().map_or(0, |&last| last as u64 + 1));
        };
        let traced = trace_light(&tracer, system, &optics.sources, &optics.settings, out, look);
        bar.finish_and_clear();
        Ok(traced?)
    }
}

fn no_source(document: &Document) -> rayweave::Error {
    let problem =
        Diagnostic::error("the model has no [[optics.source]]").why("without one there is no light");
    let place = document.foreign("optics").map(|table| table.name.span);
    let problem = match place {
        Some(span) => problem.at(&document.source, span),
        None => problem,
    };
    Diagnostics::from(problem).into()
}

/// Where light meets the sheets of a system.
struct Spots {
    list: Vec<Spot>,
    /// For each element the number of its sheet.
    of_element: Vec<Option<usize>>,
}

impl Spots {
    fn new(system: &System) -> Spots {
        let mut spots = Spots { list: Vec::new(), of_element: Vec::new() };
        for name in system.element_names() {
            let frame = system.sheet_frame(name);
            spots.of_element.push(frame.map(|_| spots.list.len()));
            spots.list.extend(frame.map(|frame| Spot::new(name, frame)));
        }
        spots
    }

    fn add(&mut self, segments: &Segments) {
        let [x, y, z] = &segments.end;
        for (row, &element) in segments.element.iter().enumerate() {
            let element = usize::try_from(element).ok().and_then(|number| self.of_element.get(number));
            if let Some(sheet) = element.copied().flatten() {
                self.list[sheet].add(Vec3::new(x[row], y[row], z[row]), segments.intensity[row]);
            }
        }
    }
}

/// The points at which light meets a sheet, weighted by power.
///
/// Mean and sum of squares are updated point by point, without cancellation (D. H. D. West, Communications of the ACM 22,
/// 532, 1979).
struct Spot {
    name: String,
    middle: Vec3,
    /// Of unit length.
    axes: [Vec3; 2],
    hits: u64,
    power: f64,
    centroid: [f64; 2],
    squares: f64,
}

impl Spot {
    fn new(name: &str, frame: &Affine) -> Spot {
        let axis = |axis: Vec3| (frame.linear * axis).normalize_or_zero();
        Spot {
            name: name.to_owned(),
            middle: frame.translation,
            axes: [axis(Vec3::X), axis(Vec3::Y)],
            hits: 0,
            power: 0.0,
            centroid: [0.0; 2],
            squares: 0.0,
        }
    }

    fn add(&mut self, point: Vec3, power: f64) {
        self.hits += 1;
        if power <= 0.0 {
            return;
        }
        let place = self.axes.map(|axis| axis.dot(point - self.middle));
        let (before, sum) = (self.power, self.power + power);
        for (mean, coordinate) in self.centroid.iter_mut().zip(place) {
            let away = coordinate - *mean;
            *mean += away * (power / sum);
            self.squares += away * away * (power * (before / sum));
        }
        self.power = sum;
    }

    /// The RMS distance from the centroid.
    fn radius(&self) -> f64 {
        (self.squares / self.power).sqrt()
    }
}

/// What there is to tell.
struct Told<'a> {
    name: String,
    unit: &'static str,
    system: &'a System,
    summary: LightSummary,
    spots: Spots,
}

impl Told<'_> {
    fn as_text(&self) -> String {
        let LightSummary { rays, segments, balance } = &self.summary;
        let mut text = format!("{}: {rays} rays, {segments} segments\n\n", self.name);
        let elements = self.system.element_names().iter().zip(&balance.absorbed);
        let mut rows = vec![("emitted".to_owned(), balance.emitted)];
        rows.extend(elements.map(|(name, power)| (format!("absorbed by {name}"), *power)));
        rows.push(("absorbed in media".to_owned(), balance.absorbed_in_media));
        rows.push(("escaped".to_owned(), balance.escaped));
        rows.push(("dropped".to_owned(), balance.dropped));
        // what is left of rounding says nothing about light
        let told = |power: f64| short((power / balance.emitted * 1e12).round() * 1e-12 * balance.emitted);
        let mut rows: Vec<Vec<String>> =
            rows.into_iter().map(|(what, power)| vec![what, told(power)]).collect();
        rows.push(vec!["unaccounted for".to_owned(), format!("{:.0e}", balance.error())]);
        text += &terminal::table(&["light", "power"], &rows, &[false, true]);
        if !self.spots.list.is_empty() {
            text += &format!("\n{}", self.sheets());
        }
        text
    }

    fn sheets(&self) -> String {
        let place = format!("centroid / {}", self.unit);
        let radius = format!("RMS radius / {}", self.unit);
        let row = |spot: &Spot| {
            let mut row = vec![spot.name.clone(), spot.hits.to_string()];
            row.extend(match spot.power > 0.0 {
                true => [format!("({})", spot.centroid.map(short).join(", ")), short(spot.radius())],
                false => ["-".to_owned(), "-".to_owned()],
            });
            row
        };
        let rows: Vec<Vec<String>> = self.spots.list.iter().map(row).collect();
        terminal::table(&["sheet", "hits", &place, &radius], &rows, &[false, true, false, true])
    }

    fn as_json(&self) -> Value {
        let LightSummary { rays, segments, balance } = &self.summary;
        let elements = self.system.element_names().iter().zip(&balance.absorbed);
        let absorbed: Vec<Value> =
            elements.map(|(name, power)| json!({ "element": name, "power": power })).collect();
        let sheet = |spot: &Spot| {
            let is_lit = spot.power > 0.0;
            json!({
                "sheet": spot.name,
                "hits": spot.hits,
                "power": spot.power,
                "centroid": is_lit.then_some(spot.centroid),
                "rms_radius": is_lit.then(|| spot.radius()),
            })
        };
        json!({
            "model": self.name,
            "unit": self.unit,
            "rays": rays,
            "segments": segments,
            "emitted": balance.emitted,
            "absorbed": absorbed,
            "absorbed_in_media": balance.absorbed_in_media,
            "escaped": balance.escaped,
            "dropped": balance.dropped,
            "error": balance.error(),
            "sheets": self.spots.list.iter().map(sheet).collect::<Vec<_>>(),
        })
    }
}
