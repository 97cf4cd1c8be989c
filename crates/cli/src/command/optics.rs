//! `rayweave optics`: light through the solids of a model.

use crate::arguments::{Cli, ModelArguments};
use crate::drawing;
use crate::failure::Failure;
use crate::interrupt;
use crate::lens_file::{self, Bench};
use crate::terminal::{self, Unit, short};
use clap::{Args, ValueEnum};
use rayweave::Packets;
use rayweave::detector::{IrradianceMap, SpotDiagram};
use rayweave::files::{self, LightSummary, SegmentFile, trace_light};
use rayweave::layout::{Layout, RayColour, ViewPlane, Wishes};
use rayweave::optics::file::{OpticalScene, optics_of};
use rayweave::optics::{Balance, Branches, Paths, Segments, System, Tracer};
use rayweave::scene::{Diagnostic, Diagnostics, Document};
use rayweave::{Affine, Vec3};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Trace light through a model and tell where its power goes
///
/// The model may be a sequential lens file of Zemax (.zmx): its lenses and mirrors become solids, with stop and image as sheets, and
/// each of its fields shines with 331 rays of each wavelength through its entrance pupil, of power 1 together; ghosts are followed down to a
/// millionth of a ray.
///
/// The [optics] tables of any other model say what shines, what the media are, what faces and sheets do to light, and how it is
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
  rayweave optics doublet.toml -D R3=120 --branches both --out segments.csv
  rayweave optics doublet.toml --layout doublet.svg
  rayweave optics doublet.toml --layout doublet.png --plane xz --rays 21 --colour source
  rayweave optics doublet.toml --spot spot.svg --map map.png --detector screen
  rayweave optics doublet.toml --branches both --paths ghosts.csv
  rayweave optics cooke-triplet.zmx --layout triplet.png --spot spot.png")]
pub struct Optics {
    #[command(flatten)]
    model: ModelArguments,

    /// The table of segments, .csv, .npy (with the names beside it) or .parquet if built so; - is CSV to standard output
    #[arg(short, long, value_name = "TABLE")]
    out: Option<PathBuf>,

    /// Two more columns, phase_s and phase_p: the phase where the path ends, in degrees, of light across the plane of incidence and in it, with the jumps of reflections and coatings (each event is looked at again, which takes time)
    #[arg(long, requires = "out")]
    phases: bool,

    /// A drawing of the system, .svg or .png: a true section of the solids, filled by medium, with rays that are the fainter the less power they have
    #[arg(long, value_name = "DRAWING")]
    layout: Option<PathBuf>,

    /// The plane of the section: yz, xz, xy, or a place along an axis, as x=2.5 [default: that which holds most of the light]
    #[arg(long, value_name = "PLANE", requires = "layout")]
    plane: Option<ViewPlane>,

    /// About how many rays the drawing has
    #[arg(long, value_name = "N", requires = "layout", default_value_t = Wishes::default().rays)]
    rays: usize,

    /// What the colours of the rays say
    #[arg(long, value_name = "WHAT", requires = "layout", default_value = "wavelength")]
    colour: Colours,

    /// A spot diagram, .svg or .png: the points at which light meets a sheet
    #[arg(long, value_name = "DRAWING")]
    spot: Option<PathBuf>,

    /// A map of irradiance, .svg or .png: power per area on a sheet, with a colour bar
    #[arg(long, value_name = "DRAWING")]
    map: Option<PathBuf>,

    /// The sheet that --spot and --map are about [default: the image of a lens file, else the one at which most power ends]
    #[arg(long, value_name = "SHEET")]
    detector: Option<String>,

    /// At most so many cells along each side of the map
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = clap::value_parser!(u16).range(1..=512))]
    bins: u16,

    /// The ways that light took, as a table: which elements it met, where it was thrown back (ghosts), how many rays, with which power
    #[arg(long, value_name = "TABLE")]
    paths: Option<PathBuf>,

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

/// The names of [`RayColour`].
#[derive(Clone, Copy, ValueEnum)]
enum Colours {
    /// The colour that eyes see
    Wavelength,
    /// A colour for each source
    Source,
}

impl From<Colours> for RayColour {
    fn from(colours: Colours) -> RayColour {
        match colours {
            Colours::Wavelength => RayColour::Wavelength,
            Colours::Source => RayColour::Source,
        }
    }
}

impl Optics {
    pub fn run(&self, cli: &Cli) -> Result<(), Failure> {
        let is_piped = self.is_piped()?;
        let drawings = [&self.layout, &self.spot, &self.map];
        drawings.into_iter().flatten().try_for_each(|path| drawing::check(path))?;
        let Bench { optics, unit, image } = self.bench()?;
        let optics = self.settled(cli, optics)?;
        let system = optics.assembly.compile()?;
        let mut spots = Spots::new(&system, self.map.is_some());
        let detector = self.detector(&spots, image)?;
        let mut paths = self.paths.is_some().then(Paths::default);
        let summary = self.trace(cli, &optics, &system, unit, (&mut spots, &mut paths))?;
        self.draw_layout(&optics, &system, unit)?;
        self.draw_detector(&spots, detector, &summary.balance, unit)?;
        self.write_paths(paths.as_ref(), &system, &summary.balance)?;
        let told = Told { name: self.model.name(), unit, system: &system, summary, spots };
        match self.json {
            true => terminal::print(&format!("{:#}\n", told.as_json())),
            false if cli.quiet || is_piped => Ok(()),
            false => terminal::print(&told.as_text()),
        }
    }

    /// What the model or lens file puts up.
    fn bench(&self) -> Result<Bench, Failure> {
        if self.model.format.is_none() && lens_file::is_one(&self.model.model) {
            return lens_file::load(&self.model);
        }
        let (document, scene) = self.model.load_document()?;
        let optics = optics_of(&document, &scene)?;
        if optics.sources.count() == 0 {
            return Err(no_source(&document).into());
        }
        Ok(Bench { optics, unit: scene.unit.symbol(), image: None })
    }

    /// Whether something is written to standard output instead of the summary; there is room for one thing alone.
    fn is_piped(&self) -> Result<bool, Failure> {
        let all = [&self.out, &self.layout, &self.spot, &self.map, &self.paths];
        let piped = all.into_iter().flatten().filter(|path| path.as_path() == Path::new("-")).count();
        match piped + usize::from(self.json) {
            0 | 1 => Ok(piped > 0),
            _ => {
                let problem = "several things go to standard output (one can: `-` is given more than once, or with --json)";
                Err(Failure::Usage(format!("{problem} give the others files?")))
            }
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

    fn draw_layout(&self, optics: &OpticalScene, system: &System, unit: &str) -> Result<(), Failure> {
        let Some(path) = &self.layout else { return Ok(()) };
        let wishes = Wishes { plane: self.plane, rays: self.rays, colour: self.colour.into() };
        let layout = Layout::new(system, &optics.sources, &optics.settings, &wishes)?;
        drawing::save(path, &layout.to_svg(&self.model.name(), unit))
    }

    /// The number of the sheet that is asked for.
    fn detector(&self, spots: &Spots, image: Option<&str>) -> Result<Option<usize>, Failure> {
        let Some(name) = self.detector.as_deref().or(image) else { return Ok(None) };
        let names: Vec<&str> = spots.list.iter().map(|spot| spot.name.as_str()).collect();
        match names.iter().position(|own| *own == name) {
            Some(number) => Ok(Some(number)),
            None if names.is_empty() => {
                Err(Failure::Usage(format!("no sheet is called `{name}` (there is none)")))
            }
            None => {
                Err(Failure::Usage(format!("no sheet is called `{name}` (there is {})", names.join(", "))))
            }
        }
    }

    /// Draws what arrived at a sheet: the one that is asked for, or that at which most power ended.
    fn draw_detector(
        &self,
        spots: &Spots,
        detector: Option<usize>,
        balance: &Balance,
        unit: &str,
    ) -> Result<(), Failure> {
        if self.spot.is_none() && self.map.is_none() {
            return Ok(());
        }
        let ended =
            |number: &usize| balance.absorbed.get(spots.list[*number].element).copied().unwrap_or(0.0);
        let dimmest_first = |a: &usize, b: &usize| {
            ended(a)
                .total_cmp(&ended(b))
                .then(spots.list[*a].diagram.power().total_cmp(&spots.list[*b].diagram.power()))
        };
        let Some(number) = detector.or_else(|| (0..spots.list.len()).max_by(dimmest_first)) else {
            let problem = "the model has no [[optics.sheet]] (--spot and --map show what arrives at one)";
            return Err(Failure::Usage(problem.to_owned()));
        };
        let Spot { name, diagram, map, .. } = &spots.list[number];
        if let Some(path) = &self.spot {
            drawing::save(path, &diagram.to_svg(name, unit))?;
        }
        match &self.map {
            Some(path) => drawing::save(path, &map.clone().finish(self.bins.into()).to_svg(name, unit)),
            None => Ok(()),
        }
    }

    fn write_paths(&self, paths: Option<&Paths>, system: &System, balance: &Balance) -> Result<(), Failure> {
        if let (Some(out), Some(paths)) = (&self.paths, paths) {
            files::write_paths(out, paths, system.element_names(), balance.emitted)?;
        }
        Ok(())
    }

    fn trace(
        &self,
        cli: &Cli,
        optics: &OpticalScene,
        system: &System,
        unit: &str,
        (spots, paths): (&mut Spots, &mut Option<Paths>),
    ) -> Result<LightSummary, Failure> {
        let bar = terminal::progress_bar(Some(optics.sources.count()), Unit::Percent, cli.quiet);
        let tracer = Tracer::new(system, Packets::new);
        let out = self.out.as_deref().map(|path| SegmentFile { path, unit, phases: self.phases });
        let look = |segments: &Segments| {
            spots.add(segments);
            if let Some(paths) = paths {
                paths.add(segments);
            }
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
    has_maps: bool,
}

impl Spots {
    fn new(system: &System, has_maps: bool) -> Spots {
        let mut spots = Spots { list: Vec::new(), of_element: Vec::new(), has_maps };
        for (number, name) in system.element_names().iter().enumerate() {
            let frame = system.sheet_frame(name);
            spots.of_element.push(frame.map(|_| spots.list.len()));
            spots.list.extend(frame.map(|frame| Spot::new(number, name, frame)));
        }
        spots
    }

    fn add(&mut self, segments: &Segments) {
        let [x, y, z] = &segments.end;
        for (row, &element) in segments.element.iter().enumerate() {
            let element = usize::try_from(element).ok().and_then(|number| self.of_element.get(number));
            let Some(sheet) = element.copied().flatten() else { continue };
            let (spot, power) = (&mut self.list[sheet], segments.intensity[row]);
            let place = spot.place(Vec3::new(x[row], y[row], z[row]));
            spot.diagram.add(place, segments.wavelength_nm[row], power);
            if self.has_maps {
                spot.map.add(place, power);
            }
        }
    }
}

/// The points at which light meets a sheet.
struct Spot {
    /// The number of the sheet among all elements.
    element: usize,
    name: String,
    middle: Vec3,
    /// Of unit length.
    axes: [Vec3; 2],
    diagram: SpotDiagram,
    map: IrradianceMap,
}

impl Spot {
    fn new(element: usize, name: &str, frame: &Affine) -> Spot {
        let axis = |axis: Vec3| (frame.linear * axis).normalize_or_zero();
        Spot {
            element,
            name: name.to_owned(),
            middle: frame.translation,
            axes: [axis(Vec3::X), axis(Vec3::Y)],
            diagram: SpotDiagram::default(),
            map: IrradianceMap::default(),
        }
    }

    fn place(&self, point: Vec3) -> [f64; 2] {
        self.axes.map(|axis| axis.dot(point - self.middle))
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
            let diagram = &spot.diagram;
            let mut row = vec![spot.name.clone(), diagram.count().to_string()];
            row.extend(match diagram.power() > 0.0 {
                true => {
                    [format!("({})", diagram.centroid().map(short).join(", ")), short(diagram.rms_radius())]
                }
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
            let diagram = &spot.diagram;
            let is_lit = diagram.power() > 0.0;
            json!({
                "sheet": spot.name,
                "hits": diagram.count(),
                "power": diagram.power(),
                "centroid": is_lit.then_some(diagram.centroid()),
                "rms_radius": is_lit.then(|| diagram.rms_radius()),
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
