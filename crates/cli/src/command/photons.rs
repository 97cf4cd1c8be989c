//! `rayweave photons`: optical photons in a detector.

use super::photon_compare::PhotonCompare;
use super::photon_drawings::{HitDrawings, PhotonDraw};
use super::photon_source::SourceArguments;
use super::photon_tables::SurfaceTableArguments;
use crate::arguments::{GlobalArguments, ModelArguments, PartArguments, debug_hash, whole_number};
use crate::device::{self, DeviceArguments};
use crate::drawing;
use crate::failure::Failure;
use crate::interrupt;
use crate::outputs;
use crate::photon_report::PhotonReport;
use crate::terminal::{self, Unit};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgMatches, Args, Command, FromArgMatches};
use rayweave::Packets;
use rayweave::check::{CheckSettings, Hierarchy, protruding};
use rayweave::layout::{LayoutPlane, OpticalLayout};
use rayweave::photon::{
    DetectionRule, Detector, Histories, HistoryOptions, OpticksHits, PhotonError, RunSettings, Source,
    TimeProfile, check_start, history_schema, hit_schema, hit_table, lint, simulate_parts, step_schema,
};
use rayweave::scene::{Document, Scene};
use rayweave::table::{AtomicFile, ContentHash, Counts, Part, TableError, TableWriter};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The largest number of copies of a daughter that are searched for parts outside their mothers.
const MOST_PROTRUDING: usize = 64;

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
/// wavelength_nm, steps, sensor, and genstep for runs of --gensteps. Lengths are in mm. The table of steps has a row for the emission and for each process of each
/// photon, with the columns photon, track, step, process, x, y, z, time, dx, dy, dz, px, py, pz, wavelength_nm, volume, surface.
///
/// The summary is printed on standard output, with --quiet only if no file is written.
///
/// `rayweave photons compare A B` compares two runs, of Rayweave, Geant4 or Opticks; `rayweave photons draw MODEL HITS` draws the hits
/// of a table.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 100000 -o hits.csv
  rayweave photons detector.gdml --at 0,0,0 --towards 0,0,1 --wavelength 420 -n 1000 --json
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 1000000 --range 0:250000 -o part1.npy
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 --draw tracks.svg --map map.svg --spectra spectra.svg
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 --counts --sequences 10
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 --range 17:18 --steps photon17.csv
  rayweave photons detector.gdml --source volume --volume Target --spectrum emission.csv --time-decay 6 -o hits.csv
  rayweave photons detector.gdml --gensteps gensteps.npy --event 7 -o hits.csv
  rayweave photons detector.gdml --at 0,0,0 --wavelength 420 -n 100000 --draw tracks.svg --draw-detected --tracks 20
  rayweave photons compare histories.csv geant4.csv
  rayweave photons draw detector.gdml hits.npy --map map.svg")]
pub struct Simulation {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    source: SourceArguments,

    /// Number of photons [default: 10000, or all photons of --gensteps or --photons]
    #[arg(short = 'n', long, value_name = "N", value_parser = whole_number)]
    count: Option<u64>,

    #[command(flatten)]
    part: PartArguments,

    #[command(flatten)]
    device: DeviceArguments,

    /// Number of the event: photons of different events have different random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = crate::arguments::any_count::<u32>)]
    event: u32,

    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = crate::arguments::any_count::<u64>)]
    seed: u64,

    /// Rule of detection: absorption at a surface with the probability EFFICIENCY, entering a sensitive volume, or both
    #[arg(long, value_name = "RULE", default_value = "both", value_parser = detection_rule())]
    detect: DetectionRule,

    #[command(flatten)]
    tables: SurfaceTableArguments,

    /// Maximum number of steps of a photon
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = crate::arguments::any_count::<u32>)]
    max_steps: u32,

    /// Maximum time of a photon, in ns
    #[arg(long, value_name = "NS", default_value_t = f64::INFINITY)]
    max_time: f64,

    /// Times of wavelength shifters: always the time constant (Geant4's default), or exponential with the time constant as the mean
    #[arg(long, value_name = "PROFILE", default_value = "delta", value_parser = time_profile())]
    wls_time_profile: TimeProfile,

    /// Table of hits: .csv, .npy (with a table of names) or .parquet (if built in); - writes CSV to standard output. It is written
    /// during the run: memory does not grow with the number of photons, unless hits are drawn
    #[arg(short, long, value_name = "TABLE")]
    out: Option<PathBuf>,

    /// Layout of the hits: a table, or Opticks' array (n, 4, 4) of float32 numbers in a .npy file
    ///
    /// The array is that of Opticks' hit.npy (sphoton.h). Its mask has the flags of all steps of a photon in runs that record histories, such
    /// as those with --counts, and else SURFACE_DETECT alone. Its numbers of sensors, plus 1, are those of an NPY table. `merge` does not join
    /// such arrays: join those of several ranges by numpy.concatenate.
    #[arg(long, value_name = "LAYOUT", requires = "out", default_value = "table", value_parser = layout())]
    layout: HitLayout,

    /// Table of steps of all photons: .csv, .npy (with a table of names) or .parquet (if built in). It is written during the run: memory does not grow with the number of photons
    #[arg(long, value_name = "TABLE")]
    steps: Option<PathBuf>,

    /// Table of histories, with a row for each photon: the names of its processes, and volume, position, time and wavelength at its
    /// end. The endings are those of --steps. `rayweave photons compare` compares two of them
    #[arg(long, value_name = "TABLE")]
    histories: Option<PathBuf>,

    /// Drawing of tracks, .svg, .pdf, .png or .jpg: a section of the detector with the tracks of photons from the whole run, coloured by wavelength
    #[arg(long, value_name = "DRAWING")]
    draw: Option<PathBuf>,

    /// Plane of the section: yz, xz, xy, or a position along an axis, as x=2.5 [default: the plane nearest to the points of the tracks]
    #[arg(long, value_name = "PLANE", requires = "draw")]
    plane: Option<LayoutPlane>,

    /// Draw tracks of detected photons alone, evenly spread over the hits; if there are no hits, those of all photons
    #[arg(long, requires = "draw")]
    draw_detected: bool,

    /// Number of photons in the drawing of tracks, evenly spread over the run
    #[arg(long, value_name = "N", requires = "draw", default_value_t = 100, value_parser = crate::arguments::any_count::<u64>)]
    tracks: u64,

    #[command(flatten)]
    hit_drawings: HitDrawings,

    /// Report the number of processes, in total and by optical surface
    #[arg(long)]
    counts: bool,

    /// Report the N most frequent histories as sequences of Opticks' flags, such as TO BT SD
    ///
    /// A sequence holds 32 flags; a longer history ends with "...". CK Cerenkov, SI scintillation, TO other source, RE re-emission,
    /// SC scattering, BT refraction, BR and SR reflection (dielectric, mirror), DR diffuse reflection; ends: AB absorption in a
    /// volume, SA at a surface, SD detection, MI leaves the model, NA and EX (flags of Opticks that only files have).
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "20", value_parser = crate::arguments::any_count::<usize>)]
    sequences: Option<usize>,

    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// Reads the name of a rule of detection.
fn detection_rule() -> impl TypedValueParser<Value = DetectionRule> {
    let names = PossibleValuesParser::new(DetectionRule::ALL.map(DetectionRule::name));
    names.map(|name| DetectionRule::from_name(&name).unwrap_or_default())
}

/// Reads the name of a distribution of times.
fn time_profile() -> impl TypedValueParser<Value = TimeProfile> {
    let names = PossibleValuesParser::new(TimeProfile::ALL.map(TimeProfile::name));
    names.map(|name| TimeProfile::from_name(&name).unwrap_or_default())
}

/// The layout of the hits in their file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum HitLayout {
    Table,
    Opticks,
}

/// Reads the name of a layout.
fn layout() -> impl TypedValueParser<Value = HitLayout> {
    let names = PossibleValuesParser::new(["table", "opticks"]);
    names.map(|name| if name == "opticks" { HitLayout::Opticks } else { HitLayout::Table })
}

/// The command with its task: a comparison, drawings of hits, or else a simulation.
pub enum Photons {
    Compare(PhotonCompare),
    Draw(Box<PhotonDraw>),
    Simulate(Box<Simulation>),
}

impl Photons {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        match self {
            Photons::Compare(compare) => compare.run(),
            Photons::Draw(draw) => draw.run(),
            Photons::Simulate(simulation) => simulation.run(global),
        }
    }
}

/// By hand: the model and the source are required unless there is a sub-command, which the derive macro cannot express.
impl FromArgMatches for Photons {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Photons, clap::Error> {
        match matches.subcommand() {
            Some((COMPARE, own)) => PhotonCompare::from_arg_matches(own).map(Photons::Compare),
            Some((_, own)) => PhotonDraw::from_arg_matches(own).map(|own| Photons::Draw(Box::new(own))),
            None => Simulation::from_arg_matches(matches).map(|own| Photons::Simulate(Box::new(own))),
        }
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Photons::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Photons {
    fn augment_args(command: Command) -> Command {
        let compare = PhotonCompare::augment_args(Command::new(COMPARE)).allow_negative_numbers(true);
        let draw = PhotonDraw::augment_args(Command::new(DRAW)).allow_negative_numbers(true);
        Simulation::augment_args(command)
            .args_conflicts_with_subcommands(true)
            .subcommand_negates_reqs(true)
            .disable_help_subcommand(true)
            .subcommand(compare)
            .subcommand(draw)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Photons::augment_args(command)
    }
}

/// The number of photons of a torch without -n.
const DEFAULT_COUNT: u64 = 10_000;

/// The names of the sub-commands.
const COMPARE: &str = "compare";
const DRAW: &str = "draw";

impl Simulation {
    fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let tables = [&self.out, &self.steps, &self.histories].into_iter().flatten();
        let is_piped = outputs::is_piped(tables.chain(self.drawings()), self.json)?;
        self.drawings().try_for_each(|path| drawing::check(path))?;
        if self.part.range.is_some() {
            self.tables()
                .filter(|(_, path)| *path != Path::new("-"))
                .try_for_each(|(_, path)| TableWriter::check_part(path))?;
        }
        // a path that cannot be written is reported before the detector is read; the unfinished file is removed
        match (self.layout, self.out.as_deref()) {
            (HitLayout::Opticks, Some(path)) => {
                check_array(path)?;
                AtomicFile::create(path)?;
            }
            (HitLayout::Table, Some(path)) if !is_piped => {
                drop(TableWriter::create(path, &hit_schema(false)?)?)
            }
            _ => {}
        }
        let (document, scene, undefined) = self.model.load_optical_document()?;
        let tables = self.tables.tables()?;
        let detector = Detector::with_tables(&scene, &document, &tables)?;
        let note = |text: &str| {
            if !global.quiet {
                terminal::note(text);
            }
        };
        detector.warnings().iter().for_each(|text| terminal::caution(text));
        detector.notes().iter().for_each(|text| note(text));
        if !global.quiet {
            self.protruding(&scene, &document, global).iter().for_each(|text| note(text));
        }
        let evaluator = Packets::new(detector.program().clone());
        let source = self.source.source(&detector, &evaluator, note)?;
        let range = self.numbers(source.limit())?;
        self.of_yields().iter().for_each(|text| note(text));
        let settings = RunSettings {
            seed: self.seed,
            event: self.event,
            detection: self.detect,
            max_steps: self.max_steps,
            max_time: self.max_time,
            wls_time_profile: self.wls_time_profile,
            threads: global.threads,
            cancel: interrupt::token(),
            ..RunSettings::new(range)
        };
        let parts = self.parts((&scene, &document), &detector, &source, &settings);
        if !parts.is_empty()
            && self.part.is_done(parts.iter().map(|(path, part)| (*path, part)), global.quiet)
        {
            return Ok(());
        }
        if let Some(text) = check_start(&detector, &evaluator, &source, &settings)? {
            note(&text);
        }
        let mut report = self.simulate(global, (&detector, &source), &settings, &parts)?;
        let mistakes = || {
            let found = lint(&scene, &document, &tables, Packets::new, &|_, _, _| None);
            undefined + found.iter().filter(|finding| !finding.is_unused).count()
        };
        if !global.quiet {
            report.remarks(&self.model.name(), mistakes).iter().for_each(|text| note(text));
        }
        if self.hit_drawings.needs_all_sensors() {
            report.run.hits.number_by(&detector);
        }
        self.draw_tracks(&detector, &source, &settings, report.detected.numbers(self.tracks))?;
        self.hit_drawings.draw(&report.run.hits, &detector, &self.model.name())?;
        match () {
            () if self.json => terminal::print(&format!("{:#}\n", report.as_json())),
            // without files the report is the result
            () if is_piped || global.quiet && self.writes_files() => Ok(()),
            () => terminal::print(&report.as_text()),
        }
    }

    /// A note about the number of scintillation photons, if none is given.
    fn of_yields(&self) -> Option<String> {
        let is_open = self.count.is_none() && self.source.is_scintillation();
        is_open.then(|| {
            format!(
                "note: {DEFAULT_COUNT} photons are simulated: SCINTILLATIONYIELD and RESOLUTIONSCALE have no effect. -n states the \
                 number, on average SCINTILLATIONYIELD times the deposited energy."
            )
        })
    }

    /// Notes about daughters that extend beyond their mothers, as far as they are quickly found.
    fn protruding(&self, scene: &Scene, document: &Document, global: &GlobalArguments) -> Vec<String> {
        let Some(hierarchy) = Hierarchy::of(document, scene) else { return Vec::new() };
        let settings = CheckSettings {
            most_pairs: MOST_PROTRUDING,
            threads: global.threads,
            cancel: interrupt::token(),
            ..CheckSettings::default()
        };
        let make = |program| Ok::<_, PhotonError>(Packets::new(program));
        // what a check rejects, such as an unbounded model, is no reason to stop the run
        let found = protruding(scene, &hierarchy, make, &settings).unwrap_or_default();
        let text = |text: &str| {
            let name = self.model.name();
            format!(
                "note: {text}: it replaces what is there, unlike in Geant4. `rayweave check {name}` shows where."
            )
        };
        found.iter().map(|finding| text(&finding.text)).collect()
    }

    /// True if the run writes a table or a drawing.
    fn writes_files(&self) -> bool {
        self.out.is_some() || self.tables().next().is_some() || self.drawings().next().is_some()
    }

    /// The tables to write, with the name of their content.
    fn tables(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let hits = self.out.as_deref().filter(|_| self.layout == HitLayout::Table);
        let tables =
            [("hits", hits), ("steps", self.steps.as_deref()), ("histories", self.histories.as_deref())];
        tables.into_iter().filter_map(|(name, path)| Some((name, path?)))
    }

    /// The descriptions of the tables, if a range is given; none for standard output.
    fn parts(
        &self,
        (scene, document): (&Scene, &Document),
        detector: &Detector,
        source: &Source,
        settings: &RunSettings,
    ) -> Vec<(&Path, Part)> {
        if self.part.range.is_none() {
            return Vec::new();
        }
        let total = self.count.or(source.limit()).unwrap_or(DEFAULT_COUNT);
        let model = format!("{} {}", scene.content_hash(), document.tables_hash());
        // with the contents of the tables that the surfaces refer to
        let optics = debug_hash(&(detector.materials(), detector.surfaces()));
        let part = |name: &str| {
            let settings = [
                ("model", ContentHash::of_text(&format!("{model} {optics}"))),
                ("seed", settings.seed.to_string()),
                ("event", settings.event.to_string()),
                ("source", debug_hash(source)),
                ("photons", total.to_string()),
                ("detect", self.detect.name().to_owned()),
                ("max_steps", settings.max_steps.to_string()),
                ("max_time", settings.max_time.to_string()),
                ("wls_time_profile", self.wls_time_profile.name().to_owned()),
            ];
            self.part.part(&format!("photons {name}"), settings, total)
        };
        let tables = self.tables().filter(|(_, path)| *path != Path::new("-"));
        tables.filter_map(|(name, path)| Some((path, part(name)?))).collect()
    }

    /// The numbers of the photons to simulate.
    fn numbers(&self, limit: Option<u64>) -> Result<Range<u64>, Failure> {
        let count = self.count.or(limit).unwrap_or(DEFAULT_COUNT);
        if let Some(limit) = limit.filter(|limit| *limit < count) {
            let text = format!("-n is {count}: the source has {limit} photons.");
            return Err(Failure::Usage(text));
        }
        let range = self.part.range.clone().unwrap_or(0..count);
        if range.end > count {
            let text = format!("--range ends at {}: the run has {count} photons.", range.end);
            return Err(Failure::Usage(text));
        }
        Ok(range)
    }

    fn drawings(&self) -> impl Iterator<Item = &PathBuf> {
        self.draw.iter().chain(self.hit_drawings.files())
    }

    /// Draws the tracks of some photons, spread over the run, or of `detected` ones, which are simulated once more: the same photons have
    /// the same tracks.
    fn draw_tracks(
        &self,
        detector: &Detector,
        source: &Source,
        settings: &RunSettings,
        detected: Vec<u64>,
    ) -> Result<(), Failure> {
        let Some(path) = &self.draw else { return Ok(()) };
        let options = HistoryOptions { steps: true, sequences: false };
        let evaluator = Packets::new(detector.program().clone());
        let mut histories = Histories::default();
        let numbers = match self.draw_detected && !detected.is_empty() {
            true => consecutive(detected.into_iter()),
            false => spread(&settings.photons, self.tracks),
        };
        for photons in numbers {
            let settings = RunSettings { photons, ..settings.clone() };
            simulate_parts(detector, &evaluator, source, &settings, Some(options), |part| {
                part.histories.into_iter().for_each(|own| histories.append(own));
                Ok::<(), PhotonError>(())
            })?;
        }
        let medium = |region| detector.medium(region);
        let layout = OpticalLayout::of_light(&evaluator, medium, histories.to_segments(), self.plane)?;
        let layout = layout.with_sensors(detector.sensors().map(|(region, _)| region));
        let layout = layout.with_marks("detected", histories.detections().map(|row| row.position));
        drawing::save(path, &layout.to_svg(&self.model.name(), "mm"), &self.model.name())
    }

    /// Runs the simulation; writes the tables of hits, steps and histories meanwhile.
    fn simulate(
        &self,
        global: &GlobalArguments,
        (detector, source): (&Detector, &Source),
        settings: &RunSettings,
        parts: &[(&Path, Part)],
    ) -> Result<PhotonReport, Failure> {
        let evaluator = Packets::new(detector.program().clone());
        let has_gensteps = matches!(source, Source::Gensteps(_));
        let create = |path: &Path| hit_table(path, detector, has_gensteps);
        let is_table = self.layout == HitLayout::Table;
        let mut hits = self.out.as_deref().filter(|_| is_table).map(create).transpose()?;
        let create = |path: &Path| OpticksHits::create(path, detector);
        let mut array = self.out.as_deref().filter(|_| !is_table).map(create).transpose()?;
        let steps = self.steps.as_deref().map(|path| TableWriter::create(path, &step_schema(detector)?));
        let mut steps = steps.transpose()?;
        let create = |path: &Path| TableWriter::create(path, &history_schema()?);
        let mut ends = self.histories.as_deref().map(create).transpose()?;
        let is_recorded = steps.is_some() || ends.is_some();
        let options = HistoryOptions { steps: is_recorded, sequences: self.sequences.is_some() };
        let histories = (options != HistoryOptions::default() || self.counts).then_some(options);
        let simulator = self.device.choose_for_photons(detector, histories.is_some(), global.quiet)?;
        let is_drawn = self.hit_drawings.files().next().is_some();
        let mut report =
            PhotonReport::new(detector, self.detect.name(), self.counts, self.sequences, is_drawn);
        let Range { start, end } = settings.photons;
        let bar = terminal::progress_bar(Some(end - start), Unit::Percent, global.quiet);
        let begin = Instant::now();
        let done = simulator.simulate_parts(detector, &evaluator, source, settings, histories, |part| {
            if let Some(table) = &mut hits {
                table.write(&part.run.hits.to_rows()?)?;
            }
            if let Some(array) = &mut array {
                let flags = part.histories.as_ref().map(|histories| &histories.hit_flags[..]);
                array.write(&part.run.hits, flags)?;
            }
            if let (Some(table), Some(histories)) = (&mut steps, &part.histories) {
                table.write(&histories.to_rows()?)?;
            }
            if let (Some(table), Some(histories)) = (&mut ends, &part.histories) {
                table.write(&histories.to_history_rows()?)?;
            }
            bar.set_position(part.photons.end - start);
            report.add(part);
            Ok::<(), PhotonError>(())
        });
        bar.finish_and_clear();
        done?;
        device::note(simulator.finish()?.as_deref(), global.quiet);
        report.duration = begin.elapsed();
        report.share = simulator.share();
        array.map_or(Ok(()), OpticksHits::finish)?;
        let counts = report.counts();
        for (table, path) in [(hits, &self.out), (steps, &self.steps), (ends, &self.histories)] {
            if let (Some(table), Some(path)) = (table, path) {
                finish(table, path, parts, &counts)?;
            }
        }
        Ok(report)
    }
}

/// Checks the name of a file of Opticks' photons.
fn check_array(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy")) {
        return Ok(());
    }
    let reason = "--layout opticks writes an NPY array. Give a file name that ends with .npy.";
    Err(Failure::Usage(format!("-o is {}: {reason}", path.display())))
}

/// Up to `count` numbers of a range, evenly spread and beginning with the first one, as ranges of consecutive numbers.
fn spread(&Range { start, end }: &Range<u64>, count: u64) -> Vec<Range<u64>> {
    let total = end.saturating_sub(start);
    let count = count.min(total);
    let number = |k: u64| start + (u128::from(k) * u128::from(total) / u128::from(count)) as u64;
    consecutive((0..count).map(number))
}

/// Ascending numbers as ranges of consecutive ones.
fn consecutive(numbers: impl Iterator<Item = u64>) -> Vec<Range<u64>> {
    let mut ranges: Vec<Range<u64>> = Vec::new();
    for number in numbers {
        match ranges.last_mut().filter(|last| last.end == number) {
            Some(last) => last.end += 1,
            None => ranges.push(number..number + 1),
        }
    }
    ranges
}

/// Completes a table, as a part with these counts if it is one.
fn finish(
    table: TableWriter,
    path: &Path,
    parts: &[(&Path, Part)],
    counts: &Counts,
) -> Result<(), TableError> {
    match parts.iter().find(|(own, _)| *own == path) {
        Some((_, part)) => {
            let part = part.clone().with_counts(counts.clone());
            table.finish_part(&part).map(|_| ())
        }
        None => table.finish().map(|_| ()),
    }
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn spread_numbers_cover_the_range() {
        let numbers = |range, count| spread(&range, count).into_iter().flatten().collect::<Vec<u64>>();
        assert_eq!(numbers(100..200, 4), [100, 125, 150, 175]);
        assert_eq!(numbers(5..12, 3), [5, 7, 9]);
        // 0, 1.25, 2.5, 3.75
        assert_eq!(numbers(0..5, 4), [0, 1, 2, 3]);
        assert_eq!(numbers(3..9, 10), [3, 4, 5, 6, 7, 8]);
        assert_eq!(spread(&(3..9), 10).len(), 1);
        assert_eq!(numbers(3..3, 10), [0; 0]);
        assert_eq!(numbers(3..9, 0), [0; 0]);
        // no overflow
        assert_eq!(numbers(0..u64::MAX, 2), [0, u64::MAX / 2]);
    }
}
