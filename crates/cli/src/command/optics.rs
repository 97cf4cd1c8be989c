//! `rayweave optics`: light through the solids of a model.

use crate::arguments::{GlobalArguments, ModelArguments, PartArguments, debug_hash};
use crate::drawing;
use crate::failure::Failure;
use crate::interrupt;
use crate::lens_data::LensData;
use crate::lens_drawing::{DrawingOptions, LensDrawing};
use crate::lens_file::{self, Bench};
use crate::lens_input;
use crate::outputs;
use crate::terminal::{self, Unit, short};
use clap::{Args, ValueEnum};
use rayweave::detector::{Detector, Detectors, SpotDiagram, irradiance_svg, spot_svg, spots_svg};
use rayweave::layout::{LayoutOptions, LayoutPlane, OpticalLayout, RayColour};
use rayweave::lens::prescription::Prescription;
use rayweave::optics::file::{OpticalScene, optics_of};
use rayweave::optics::table::{LightSummary, SegmentFile, trace_light, write_paths};
use rayweave::optics::{Balance, Branches, Paths, Segments, System, Tracer};
use rayweave::scene::{Diagnostic, Diagnostics, Document};
use rayweave::table::{ContentHash, Part, TableWriter};
use rayweave::{Message, Packets};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Trace light through a model and report where its power ends
///
/// The model may be a sequential Zemax lens file (.zmx). Its lenses and mirrors become solids, its image a sheet, and its stop
/// a sheet: a plane between lenses, or a ring on the face of a lens with a plane mount around that lens; the rim of a mirror, or of
/// the widest lens, needs none. Each field emits 880 rays of each wavelength on 20
/// rings through the entrance pupil, with a total power of 1, as weights of Gaussian quadrature over the area of the pupil:
/// RMS radii are exact to many digits for a clear pupil, and to about 1 % where half of the pupil is vignetted. Ghost
/// reflections are followed down to a millionth of a ray. The image does not absorb: light that passes through it escapes.
///
/// The report begins with the first-order data of the lens and the distortion of its outermost field; --json also has the RMS radius
/// at each wavelength. --layout draws rays of each field, evenly spaced in the pupil at the primary wavelength, up to the image;
/// with --colour wavelength, at all wavelengths.
///
/// In other models the [optics] tables describe the sources, the media, the effect of faces and sheets on light, and the tracing.
/// The summary lists the power absorbed by each element and, for each sheet, the number of rays, their centroid in the sheet's
/// own x and y, and the RMS distance from the centroid, both weighted by power. For a lens file, a second table has a row per
/// field, for the rays that meet all surfaces in order, as in the spot diagrams; others that reach the image are counted below.
///
/// The table of segments has a row for each piece of a ray between two events, with the columns id, parent, generation, source,
/// wavelength_nm, intensity, index, x0, y0, z0, x1, y1, z1, x_tilt, y_tilt, z_tilt, path, element, surface, event. It is streamed:
/// the memory required does not grow with the number of rays. The file appears when it is complete.
#[derive(Args)]
#[command(after_help = "\
Only in Python, see help(rayweave.optics.Prescription): Seidel sums, ray fans, wavefronts and
Zernike polynomials, MTF, encircled energy, through focus, field curvature, vignetting, colour,
optimisation, tolerances.

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

    /// Table of segments: .csv, .npy (with a table of names) or .parquet (if built in); - writes CSV to standard output
    #[arg(short, long, value_name = "TABLE")]
    out: Option<PathBuf>,

    /// Add the columns phase_s and phase_p: the phases at the end of the path, in degrees, of light polarised perpendicular and parallel to the plane of incidence, including the phase jumps at reflections and coatings. Slower, because each event is computed again
    #[arg(long, requires = "out")]
    phases: bool,

    /// Drawing of the system, .svg, .pdf, .png or .jpg: a section of the solids, coloured by medium, with rays; rays with little power are faint
    #[arg(long, value_name = "DRAWING")]
    layout: Option<PathBuf>,

    /// Plane of the section: yz, xz, xy, or a position along an axis, such as x=2.5 [default: the plane that contains most of the light]
    #[arg(long, value_name = "PLANE", requires = "layout")]
    plane: Option<LayoutPlane>,

    /// Approximate number of rays in the drawing [default: 5 for each field of a lens file, else 27]
    #[arg(long, value_name = "N", requires = "layout", value_parser = crate::arguments::any_count::<usize>)]
    rays: Option<usize>,

    /// Meaning of the colours of the rays [default: the source of a lens file, which is its field, else the wavelength]
    #[arg(long, value_name = "WHAT", requires = "layout")]
    colour: Option<Colours>,

    /// Drawing of one lens of a lens file, or of cemented lenses, .svg, .pdf, .png or .jpg: a section with diameter and centre thickness, and the radii, clear diameters and glass in the tabular form of ISO 10110-1
    #[arg(long, value_name = "DRAWING")]
    drawing: Option<PathBuf>,

    /// The lens of --drawing, counted from 1 in the order of the light, or cemented lenses such as 1-2
    #[arg(long, value_name = "N", requires = "drawing", default_value = "1", value_parser = lenses)]
    element: [usize; 2],

    /// Text of a field of --drawing, such as "left 3/=2(0.5)"; repeatable. The fields of a lens: thickness, diameter (tolerances), 0/, 1/, 2/, and left or right: radius (tolerance), chamfer, coating, 3/, 4/, 5/, 6/; of cemented lenses: thickness, diameter, cement, 4/, 5/, note
    #[arg(long, value_name = "FIELD=TEXT", requires = "drawing", value_parser = indication)]
    indication: Vec<(String, String)>,

    /// Spot diagram, .svg, .pdf, .png or .jpg: the points where light crosses a sheet; for a lens file, one diagram per field
    #[arg(long, value_name = "DRAWING")]
    spot: Option<PathBuf>,

    /// Irradiance map, .svg, .pdf, .png or .jpg: power per area on a sheet, with a colour bar
    #[arg(long, value_name = "DRAWING")]
    map: Option<PathBuf>,

    /// Sheet for --spot and --map [default: the image of a lens file, else the sheet that absorbs the most power]
    #[arg(long, value_name = "SHEET")]
    detector: Option<String>,

    /// Maximum number of cells along each side of the map
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = crate::arguments::count::<u16, 1, 512>)]
    bins: u16,

    /// Table of light paths: the elements along each path, reflections (ghosts) with their surfaces, number of rays and power
    #[arg(long, value_name = "TABLE")]
    paths: Option<PathBuf>,

    /// Branches to follow where light is both reflected and transmitted: the one without losses, both, or one at random [default: as in the model]
    #[arg(long, value_name = "WAY")]
    branches: Option<Ways>,

    /// Trace polarisation, even if the model does not request it
    #[arg(long)]
    polarised: bool,

    /// Seed of random choices [default: as in the model]
    #[arg(long, value_name = "N", value_parser = crate::arguments::any_count::<u64>)]
    seed: Option<u64>,

    #[command(flatten)]
    part: PartArguments,

    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// A number, or the first and the last one of a range.
fn lenses(text: &str) -> Result<[usize; 2], String> {
    let number = |part: &str| {
        let problem = |_| "expected a number such as 2, or a range such as 1-2".to_owned();
        part.parse::<usize>().map_err(problem)
    };
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    Ok([number(first)?, number(last)?])
}

/// A field and its text.
fn indication(text: &str) -> Result<(String, String), String> {
    let (field, text) = text.split_once('=').ok_or_else(|| "expected FIELD=TEXT".to_owned())?;
    Ok((field.trim().to_owned(), text.trim().to_owned()))
}

/// Command-line names of [`Branches`].
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

/// Command-line names of [`RayColour`].
#[derive(Clone, Copy, ValueEnum)]
enum Colours {
    /// The visible colour of the wavelength
    Wavelength,
    /// A colour for each source: for each field of a lens file
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
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let is_piped = outputs::is_piped(self.outputs(), self.json)?;
        let drawings = [&self.layout, &self.drawing, &self.spot, &self.map];
        drawings.into_iter().flatten().try_for_each(|path| drawing::check(path))?;
        let Bench { identity, optics, unit, image, sequence, fields, lens } = self.bench()?;
        let lens = lens.as_deref();
        let data = lens.map(|lens| LensData::new(lens, &fields, unit)).transpose();
        let data = data.map_err(|error| lens_input::wrong(&self.model.model, &error))?;
        let optics = self.resolved(global, optics)?;
        let system = optics.assembly.compile()?;
        let part = self.part(&identity, &optics)?;
        let done = self.out.as_deref().zip(part.as_ref());
        if self.part.is_done(done.into_iter(), global.quiet) {
            return Ok(());
        }
        let mut detectors =
            Detectors::new(&system, self.map.is_some()).by_source(fields.len()).in_sequence(&sequence);
        let detector = self.detector(&detectors, image)?;
        let lines = lens.filter(|_| self.json).map_or(&[][..], |lens| &lens.lines);
        let mut by_line: Vec<(f64, Detectors)> = lines
            .iter()
            .map(|line| (line.wavelength_nm, detectors.clone().of_wavelength(line.wavelength_nm)))
            .collect();
        let mut paths = self.paths.is_some().then(Paths::default);
        let add = |segments: &Segments| {
            detectors.add(segments);
            by_line.iter_mut().for_each(|(_, own)| own.add(segments));
            if let Some(paths) = &mut paths {
                paths.add(segments);
            }
        };
        self.draw_element(lens)?;
        let summary = self.trace(global, (&optics, part.as_ref()), &system, unit, add)?;
        match lens {
            Some(lens) => self.draw_lens(&optics, lens, unit)?,
            None => self.draw_layout(&optics, &system, unit)?,
        }
        let drawn = self.drawn(&detectors, detector, &summary.balance)?;
        let airy_radius = lens.and_then(|lens| data.as_ref()?.airy_radius(lens.unit_nm));
        self.draw_detector(drawn, &fields, (unit, airy_radius))?;
        self.write_paths(paths.as_ref(), &system, &summary.balance)?;
        let image = image.and_then(|name| detectors.list().iter().position(|own| own.name == name));
        let name = self.model.name();
        let report = Report { name, unit, system: &system, summary, detectors, by_line, fields, image, data };
        match self.json {
            true => terminal::print(&format!("{:#}\n", report.as_json())),
            // without files the report is the result
            false if is_piped || (global.quiet && self.outputs().next().is_some()) => Ok(()),
            false => terminal::print(&report.as_text()),
        }
    }

    /// Reads the optical system of a model or lens file.
    fn bench(&self) -> Result<Bench, Failure> {
        if self.model.is_lens() {
            return lens_file::load(&self.model);
        }
        let (document, scene) = self.model.load_document()?;
        let optics = outputs::reading(|| optics_of(&document, &scene))??;
        if optics.sources.count() == 0 {
            return Err(no_source(&document).into());
        }
        let identity = ContentHash::of_text(&format!("{} {}", scene.content_hash(), document.tables_hash()));
        let (unit, sequence, fields) = (scene.unit.symbol(), Vec::new(), Vec::new());
        Ok(Bench { identity, optics, unit, image: None, sequence, fields, lens: None })
    }

    /// The files that are written.
    fn outputs(&self) -> impl Iterator<Item = &PathBuf> {
        [&self.out, &self.layout, &self.drawing, &self.spot, &self.map, &self.paths].into_iter().flatten()
    }

    /// Applies the settings of the command line to the scene.
    fn resolved(&self, global: &GlobalArguments, mut optics: OpticalScene) -> Result<OpticalScene, Failure> {
        let settings = &mut optics.settings;
        settings.branches = self.branches.map_or(settings.branches, Branches::from);
        settings.polarised |= self.polarised;
        settings.seed = self.seed.unwrap_or(settings.seed);
        settings.rays = self.part.range.as_ref().map(|range| range.start as usize..range.end as usize);
        settings.threads = global.threads;
        settings.cancel = interrupt::token();
        Ok(optics)
    }

    /// The part that is traced, if a range is given.
    fn part(&self, identity: &str, optics: &OpticalScene) -> Result<Option<Part>, Failure> {
        if self.part.range.is_none() {
            return Ok(None);
        }
        let Some(out) = &self.out else {
            let text = "--range writes a part of the table of segments: give it a name with --out.";
            return Err(Failure::Usage(text.to_owned()));
        };
        TableWriter::check_part(out)?;
        let own = &optics.settings;
        let settings = [
            ("model", identity.to_owned()),
            // with the rays of files that the model names
            ("sources", debug_hash(&optics.sources)),
            ("seed", own.seed.to_string()),
            ("branches", format!("{:?}", own.branches).to_lowercase()),
            ("polarised", own.polarised.to_string()),
            ("generation_limit", own.generation_limit.to_string()),
            ("threshold", own.threshold.to_string()),
            ("keep", format!("{:?}", own.keep).to_lowercase()),
            ("keep_escaped", own.keep_escaped.to_string()),
            ("phases", self.phases.to_string()),
        ];
        Ok(self.part.part("optics segments", settings, optics.sources.count()))
    }

    /// Draws one lens of a lens file.
    fn draw_element(&self, lens: Option<&Prescription>) -> Result<(), Failure> {
        let Some(path) = &self.drawing else { return Ok(()) };
        let Some(lens) = lens else {
            let text = "--drawing needs a lens file: a model has no radii and glasses of lenses. `rayweave render --view sheet --dimensions` draws any model.";
            return Err(Failure::Usage(text.to_owned()));
        };
        let title = self.model.name();
        let svg = rayweave::lens_drawing_with(lens, self.element, "", self.indication.clone())
            .map_err(|error| lens_input::wrong(&self.model.model, &error))?;
        drawing::save(path, &svg, &title)
    }

    /// Draws the layout of a model.
    fn draw_layout(&self, optics: &OpticalScene, system: &System, unit: &str) -> Result<(), Failure> {
        let Some(path) = &self.layout else { return Ok(()) };
        let defaults = LayoutOptions::default();
        let options = LayoutOptions {
            plane: self.plane,
            rays: self.rays.unwrap_or(defaults.rays),
            colour: self.colour.map_or(defaults.colour, RayColour::from),
        };
        let layout = OpticalLayout::new(system, &optics.sources, &optics.settings, &options, Packets::new)?;
        drawing::save(path, &layout.to_svg(&self.model.name(), unit), &self.model.name())
    }

    /// Draws the layout of a lens file: rays evenly spaced in the pupil that pass the surfaces in order.
    fn draw_lens(&self, optics: &OpticalScene, lens: &Prescription, unit: &str) -> Result<(), Failure> {
        let Some(path) = &self.layout else { return Ok(()) };
        let colour = self.colour.map_or(RayColour::Source, RayColour::from);
        let plane = self.plane.unwrap_or(LayoutPlane::X(0.0));
        let options = DrawingOptions {
            rays: self.rays,
            is_along_x: matches!(plane, LayoutPlane::Y(_)),
            has_all_wavelengths: colour == RayColour::Wavelength,
        };
        let drawn = LensDrawing::new(lens, options);
        let LensDrawing { system, sequence, light, stop } =
            drawn.map_err(|error| lens_input::wrong(&self.model.model, error.as_ref()))?;
        // all rays of the drawing
        let rays = usize::try_from(light.count()).unwrap_or(usize::MAX);
        let options = LayoutOptions { plane: Some(plane), rays, colour };
        let settings = &optics.settings;
        let mut layout =
            OpticalLayout::new_in_order(&system, &sequence, &light, settings, &options, Packets::new)?
                .with_source_names(
                    lens_input::field_names(lens).into_iter().map(|name| format!("field {name}")),
                );
        if let Some(&image) = sequence.last() {
            layout = layout.ending_at(image);
        }
        if !matches!(plane, LayoutPlane::Z(_)) {
            layout = layout.with_stop(stop);
        }
        drawing::save(path, &layout.to_svg(&self.model.name(), unit), &self.model.name())
    }

    /// The number of the selected sheet.
    fn detector(&self, detectors: &Detectors, image: Option<&str>) -> Result<Option<usize>, Failure> {
        let Some(name) = self.detector.as_deref().or(image) else { return Ok(None) };
        let names = || detectors.list().iter().map(|detector| detector.name.as_str());
        match names().position(|own| own == name) {
            Some(number) => Ok(Some(number)),
            None => Err(Failure::Usage(Message::unknown("sheet", name, names()).to_string())),
        }
    }

    /// The sheet to draw, if any: the selected one, or the one that absorbs the most power.
    fn drawn<'a>(
        &self,
        detectors: &'a Detectors,
        detector: Option<usize>,
        balance: &Balance,
    ) -> Result<Option<&'a Detector>, Failure> {
        if self.spot.is_none() && self.map.is_none() {
            return Ok(None);
        }
        let list = detectors.list();
        let absorbed = |number: &usize| balance.absorbed.get(list[*number].element).copied().unwrap_or(0.0);
        let dimmest_first = |a: &usize, b: &usize| {
            absorbed(a)
                .total_cmp(&absorbed(b))
                .then(list[*a].spots.power().total_cmp(&list[*b].spots.power()))
        };
        match detector.or_else(|| (0..list.len()).max_by(dimmest_first)) {
            Some(number) => Ok(Some(&list[number])),
            None => {
                let problem = "the model has no [[optics.sheet]]: --spot and --map show what arrives at one.";
                Err(Failure::Usage(problem.to_owned()))
            }
        }
    }

    /// Draws the light at a sheet; a lens has one spot per field.
    fn draw_detector(
        &self,
        drawn: Option<&Detector>,
        fields: &[String],
        (unit, airy_radius): (&str, Option<f64>),
    ) -> Result<(), Failure> {
        let Some(Detector { name, spots, by_source, irradiance, .. }) = drawn else { return Ok(()) };
        if let Some(path) = &self.spot {
            let titles: Vec<String> =
                fields.iter().enumerate().map(|(k, place)| format!("field {k} {place}")).collect();
            let named: Vec<_> = titles.iter().map(String::as_str).zip(by_source).collect();
            let drawing = match named.is_empty() {
                true => spot_svg(spots, name, unit),
                false => spots_svg(&named, name, unit, airy_radius),
            };
            drawing::save(path, &drawing, &self.model.name())?;
        }
        match &self.map {
            Some(path) => {
                let map = irradiance.clone().finish(self.bins.into());
                drawing::save(path, &irradiance_svg(&map, name, unit), name)
            }
            None => Ok(()),
        }
    }

    fn write_paths(&self, paths: Option<&Paths>, system: &System, balance: &Balance) -> Result<(), Failure> {
        if let (Some(out), Some(paths)) = (&self.paths, paths) {
            write_paths(out, paths, system, balance.emitted)?;
        }
        Ok(())
    }

    fn trace(
        &self,
        global: &GlobalArguments,
        (optics, part): (&OpticalScene, Option<&Part>),
        system: &System,
        unit: &str,
        mut add: impl FnMut(&Segments),
    ) -> Result<LightSummary, Failure> {
        let bar = terminal::progress_bar(Some(optics.sources.count()), Unit::Percent, global.quiet);
        let tracer = Tracer::new(system, Packets::new);
        let out = self.out.as_deref().map(|path| SegmentFile { path, unit, phases: self.phases, part });
        let write = |segments: &Segments| {
            add(segments);
            bar.set_position(segments.id.iter().max().map_or(0, |&last| last as u64 + 1));
        };
        let traced = trace_light(&tracer, system, &optics.sources, &optics.settings, out, write);
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

/// The number and the power of the rays at a sheet of a lens that have not met the surfaces in order.
fn stray(detector: &Detector) -> (u64, f64) {
    let in_order = |of: fn(&SpotDiagram) -> f64| detector.by_source.iter().map(of).sum::<f64>();
    let count: u64 = detector.by_source.iter().map(SpotDiagram::count).sum();
    match detector.spots.count() - count {
        // without rounding errors
        0 => (0, 0.0),
        hits => (hits, (detector.spots.power() - in_order(SpotDiagram::power)).max(0.0)),
    }
}

/// The line about stray light on the image of a lens.
fn stray_text(image: &Detector) -> String {
    let (hits, power) = stray(image);
    if hits == 0 {
        return String::new();
    }
    let share = 100.0 * power / image.spots.power();
    let rays = if hits == 1 { "1 ray".to_owned() } else { format!("{hits} rays") };
    format!(
        "- {rays} ({share:.1} % of the power) reach the image on other paths, past a lens or after reflections; they are not in the RMS\n"
    )
}

/// The line about ghosts that pass beside the image of a lens.
fn ghosts_text(image: &Detector, emitted: f64) -> String {
    let (ghosts, power) = image.ghosts_beside;
    if ghosts == 0 {
        return String::new();
    }
    let rays = if ghosts == 1 { "1 ray".to_owned() } else { format!("{ghosts} rays") };
    format!(
        "- {rays} of ghosts ({} of the emitted power) pass beside the image, which is as wide as the lens file states or as its light; state a wider one: DIAM of the last surface, image_semi_diameter in Python\n",
        short(terminal::rounded(power / emitted, 3))
    )
}

/// The results of a run, for the summary.
struct Report<'a> {
    name: String,
    unit: &'static str,
    system: &'a System,
    summary: LightSummary,
    detectors: Detectors,
    /// The light of each wavelength of a lens, for JSON.
    by_line: Vec<(f64, Detectors)>,
    /// The fields of a lens.
    fields: Vec<String>,
    /// The number of the detector at the image of a lens.
    image: Option<usize>,
    /// The first-order data of a lens.
    data: Option<LensData>,
}

impl Report<'_> {
    fn as_text(&self) -> String {
        let LightSummary { rays, segments, balance } = &self.summary;
        let mut text = format!("{}: {rays} rays, {segments} segments\n\n", self.name);
        text += &self.data.as_ref().map(|data| data.text() + "\n").unwrap_or_default();
        let elements = self.system.element_names().iter().zip(&balance.absorbed);
        let mut rows = vec![("emitted".to_owned(), balance.emitted)];
        rows.extend(elements.map(|(name, power)| (format!("absorbed by {name}"), *power)));
        rows.push(("absorbed in media".to_owned(), balance.absorbed_in_media));
        rows.push(("escaped".to_owned(), balance.escaped));
        if let Some(image) = self.image {
            // the image of a lens file transmits the light, which would be missing from the list otherwise
            let through = self.detectors.list()[image].spots.power();
            rows.push(("  of it passed through the image".to_owned(), through));
        }
        rows.push(("dropped".to_owned(), balance.dropped));
        // rounds to 1e-12 of the emitted power: smaller differences are rounding errors
        let rounded = |power: f64| short((power / balance.emitted * 1e12).round() * 1e-12 * balance.emitted);
        let mut rows: Vec<Vec<String>> =
            rows.into_iter().map(|(what, power)| vec![what, rounded(power)]).collect();
        rows.push(vec!["unaccounted for".to_owned(), format!("{:.0e}", balance.error())]);
        text += &terminal::table(&["light", "power"], &rows, &[false, true]);
        if !self.detectors.list().is_empty() {
            text += &format!("\n{}", self.sheets());
        }
        text
    }

    fn sheets(&self) -> String {
        let place = format!("centroid / {}", self.unit);
        let radius = format!("RMS radius / {}", self.unit);
        let row = |name: String, spots: &SpotDiagram, has_radius: bool| {
            let radius = if has_radius { short(spots.rms_radius()) } else { "-".to_owned() };
            let mut row = vec![name, spots.count().to_string()];
            row.extend(match spots.power() > 0.0 {
                true => [format!("({})", spots.centroid().map(short).join(", ")), radius],
                false => ["-".to_owned(), "-".to_owned()],
            });
            row
        };
        let right = [false, true, false, true];
        let sheets = self.detectors.list().iter();
        let rows: Vec<Vec<String>> =
            sheets.map(|own| row(own.name.clone(), &own.spots, self.is_one_spot(own))).collect();
        let mut text = terminal::table(&["sheet", "hits", &place, &radius], &rows, &right);
        if let Some(image) = self.image {
            let spots = self.fields.iter().zip(&self.detectors.list()[image].by_source).enumerate();
            let rows: Vec<Vec<String>> =
                spots.map(|(k, (field, spots))| row(format!("{k} {field}"), spots, true)).collect();
            let head = ["field on the image", "hits", &place, &radius];
            if self.fields.len() > 1 {
                text +=
                    "- no common radius: light of several fields arrives; the table below has one for each\n";
            }
            text += &format!("\n{}", terminal::table(&head, &rows, &right));
            text += &stray_text(&self.detectors.list()[image]);
            text += &ghosts_text(&self.detectors.list()[image], self.summary.balance.emitted);
        }
        text
    }

    /// False if light of several fields or stray light arrives, which has no common spot.
    fn is_one_spot(&self, detector: &Detector) -> bool {
        self.fields.is_empty() || self.fields.len() == 1 && stray(detector).0 == 0
    }

    fn as_json(&self) -> Value {
        let LightSummary { rays, segments, balance } = &self.summary;
        let elements = self.system.element_names().iter().zip(&balance.absorbed);
        let absorbed: Vec<Value> =
            elements.map(|(name, power)| json!({ "element": name, "power": power })).collect();
        let spot = |spots: &SpotDiagram, has_radius: bool| {
            let is_lit = spots.power() > 0.0;
            json!({
                "hits": spots.count(),
                "power": spots.power(),
                "centroid": is_lit.then_some(spots.centroid()),
                "rms_radius": (is_lit && has_radius).then(|| spots.rms_radius()),
            })
        };
        let sheet = |(number, detector): (usize, &Detector)| {
            let mut entry = spot(&detector.spots, self.is_one_spot(detector));
            entry["sheet"] = json!(detector.name);
            if !self.fields.is_empty() {
                let field = |(field, spots): (usize, &SpotDiagram)| {
                    let mut entry = spot(spots, true);
                    let line = |(nm, own): &(f64, Detectors)| {
                        let mut entry = spot(&own.list()[number].by_source[field], true);
                        entry["wavelength_nm"] = json!(nm);
                        entry
                    };
                    entry["wavelengths"] = self.by_line.iter().map(line).collect();
                    entry
                };
                entry["fields"] = detector.by_source.iter().enumerate().map(field).collect();
                let (hits, power) = stray(detector);
                entry["stray"] = json!({ "hits": hits, "power": power });
                let (rays, power) = detector.ghosts_beside;
                entry["ghosts_beside"] = json!({ "rays": rays, "power": power });
            }
            entry
        };
        let mut json = json!({
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
            "sheets": self.detectors.list().iter().enumerate().map(sheet).collect::<Vec<_>>(),
        });
        if let Some(data) = &self.data {
            json["first_order"] = data.json();
        }
        json
    }
}
