//! `rayweave diff`: comparison of two models.

use crate::arguments::{GlobalArguments, ModelArguments, OnlyArguments, WithinArguments};
use crate::failure::Failure;
use crate::terminal::{self, Sampling};
use crate::{drawing, interrupt, interval};
use clap::{Args, ValueEnum};
use rayweave::diff::{
    DiffProgress, DiffReport, DiffSettings, Difference, DifferencePlace, Match, ThickestSpot, diff_section,
    diff_with_progress,
};
use rayweave::measure;
use rayweave::scene::Scene;
use rayweave::section::{SectionPlane, section_svg};
use rayweave::{AnyEvaluator, Compiled};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const AFTER_HELP: &str = "\
Exit codes:
  0    no difference that matters was found
  1    the models differ
  2    error: a model cannot be read or compared, or the command line is invalid
  130  cancelled by Ctrl-C";

/// Compare two models: report whether they are the same solid and where they differ
///
/// Rays search for parts that belong to one model only. Each connected place of a difference is listed with its volume and centre,
/// estimated by a grid of rays, the largest first. Differences thinner than a distance (by default the size of rounding
/// errors) are ignored; thickness is measured perpendicular to the surface. Several regions are compared by name. Lengths of the
/// second model are converted to the unit of the first. With --solid, a second model with a single solid, such as an STL file, is
/// compared as a whole, whatever the name of its solid. -D sets parameters of the first model only; the second one keeps its values.
#[derive(Args)]
#[command(after_help = AFTER_HELP)]
pub struct Diff {
    #[command(flatten)]
    model: ModelArguments,

    /// The second model, in any of the formats
    other: PathBuf,

    /// Format of the second model [default: by the file extension]
    #[arg(long, value_name = "NAME", value_parser = rayweave::formats::Format::NAMES)]
    other_format: Option<String>,

    /// Unit of lengths of the second model, if its file has none [default: mm]
    #[arg(long, value_name = "UNIT", value_parser = rayweave::scene::Unit::ALL.map(|(_, symbol, _)| symbol))]
    other_unit: Option<String>,

    #[command(flatten)]
    only: OnlyArguments,

    /// Parts to compare [default: everything if one of the models has a single region, else regions by name]
    #[arg(long, value_name = "WHAT")]
    by: Option<By>,

    /// Compare the union of all regions; the same as --by whole
    #[arg(long, conflicts_with = "by")]
    whole: bool,

    /// Ignore differences up to this thickness, in the unit of the first model [default: 1e-9 of its diagonal]
    #[arg(long, value_name = "LENGTH")]
    distance: Option<f64>,

    #[command(flatten)]
    within: WithinArguments,

    /// Cells along each edge of a cross-section; each cell gets one ray
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = crate::arguments::count::<u32, 2, 4096>)]
    cells: u32,

    /// Relative half-width of the volumes' confidence intervals to reach
    #[arg(long, value_name = "P", default_value_t = 1e-2)]
    precision: f64,

    /// Confidence level of the intervals
    #[arg(long, value_name = "C", default_value_t = 0.99)]
    confidence: f64,

    /// Trace at most this many rays for a volume [default: 2^20, fewer if all rays would reach more than 2^23 shapes]
    #[arg(long, value_name = "N", value_parser = crate::arguments::any_count::<u64>)]
    rays: Option<u64>,

    /// Seed of random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = crate::arguments::any_count::<u64>)]
    seed: u64,

    /// Picture of the thickest difference, cut open: .svg, .pdf, .png or .jpg
    #[arg(short, long, value_name = "OUT")]
    out: Option<PathBuf>,

    /// Plane of the picture, such as z=0.5 [default: the plane across x, y or z through the thickest difference that shows the longest outlines of differences]
    #[arg(long, value_name = "PLANE", value_parser = super::section::plane, requires = "out")]
    plane: Option<SectionPlane>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum By {
    /// Regions with the same name
    Region,
    /// All regions with the same medium
    Medium,
    /// The union of all regions
    Whole,
}

impl Diff {
    /// Exit codes of diff(1): 0 for equal models, 1 for different ones, 2 for errors.
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let is_same = self.compare(global).map_err(|failure| match failure {
            Failure::Cancelled | Failure::BrokenPipe => failure,
            other => Failure::Trouble(Box::new(other)),
        })?;
        if is_same { Ok(()) } else { Err(Failure::Answer) }
    }

    fn compare(&self, global: &GlobalArguments) -> Result<bool, Failure> {
        self.out.as_deref().map_or(Ok(()), drawing::check)?;
        let (format, unit) = (self.other_format.as_deref(), self.other_unit.as_deref());
        let (a, b) = (self.model.load()?, self.model.load_other(&self.other, format, unit)?);
        let (a, b) = (self.only.of(a)?, self.only.of_other(b)?);
        let settings = self.settings(global)?;
        let bar = Sampling::new(settings.measure.precision, global.quiet);
        let mut progress = |now: DiffProgress| bar.show_pair(now.rays, now.precision, [now.done, now.pairs]);
        let report = diff_with_progress(&a, &b, AnyEvaluator::maker(None), &settings, &mut progress);
        bar.finish();
        let report = report?;
        self.out.as_ref().map_or(Ok(()), |path| self.draw(path, [&a, &b], &report, &settings))?;
        terminal::print(&match self.json {
            true => format!("{:#}\n", self.as_json(&report)),
            false => self.as_text(&report),
        })?;
        self.note_short_numbers(&a, &report)?;
        Ok(report.is_same())
    }

    /// Prints a note if the differences may be those of numbers that a file states with six digits.
    fn note_short_numbers(&self, scene: &Scene, report: &DiffReport) -> Result<(), Failure> {
        let is_csg = |path: &Path| path.extension().is_some_and(|own| own.eq_ignore_ascii_case("csg"));
        if report.is_same() || !(is_csg(&self.model.model) || is_csg(&self.other)) {
            return Ok(());
        }
        let bounds = Compiled::new(scene)?.program.bounds();
        let largest = bounds.lo.abs().max(bounds.hi.abs()).max_element();
        let spots = report.pairs.iter().filter(|pair| !pair.is_same);
        // a part that only one model has has no thickness
        let thickest =
            spots.map(|pair| pair.spot.map_or(f64::INFINITY, |spot| spot.thickness)).fold(0.0, f64::max);
        // several coordinates, each wrong by half a unit of the sixth digit
        if thickest < 1e-5 * largest {
            let enough = libm::pow(10.0, libm::ceil(libm::log10(thickest)));
            terminal::note(&format!(
                "note: numbers in .csg files have six digits, and the differences are no larger than their rounding. \
                 --distance {} ignores them.",
                terminal::short(enough)
            ));
        }
        Ok(())
    }

    fn settings(&self, global: &GlobalArguments) -> Result<DiffSettings, Failure> {
        let by = match (self.by, self.whole) {
            (Some(By::Whole), _) | (_, true) => Match::Whole,
            (Some(By::Region), _) => Match::Region,
            (Some(By::Medium), _) => Match::Medium,
            (None, false) => Match::Auto,
        };
        Ok(DiffSettings {
            by,
            distance: self.distance,
            across: self.cells,
            measure: measure::MeasureSettings {
                precision: self.precision,
                confidence: self.confidence,
                within: self.within.bounds(),
                seed: self.seed,
                threads: global.threads,
                cancel: interrupt::token(),
                ..DiffSettings::default().measure
            }
            .with_most_rays(self.rays),
        })
    }

    fn draw(
        &self,
        path: &std::path::Path,
        [a, b]: [&Scene; 2],
        report: &DiffReport,
        settings: &DiffSettings,
    ) -> Result<(), Failure> {
        let section = diff_section(a, b, report, AnyEvaluator::maker(None), settings, self.plane)?;
        let title = format!("A {}, B {}", self.first(), self.other.display());
        drawing::save(path, &section_svg(&[section], &title, report.unit.symbol()), &title)
    }

    /// The name of the first model, with the parameters that -D sets.
    fn first(&self) -> String {
        let defined = self.model.definitions.iter().map(|(name, value)| format!(" -D {name}={value}"));
        self.model.name() + &defined.collect::<String>()
    }

    fn as_text(&self, report: &DiffReport) -> String {
        let (a, b, unit) = (self.first(), self.other.display(), report.unit.symbol());
        let distance = terminal::short3(report.distance);
        let verdict = match report.is_same() {
            true => format!("the same solid: no difference thicker than {distance} {unit}"),
            false => "different".to_owned(),
        };
        let rays = report.rays;
        let mut text =
            format!("A {a}\nB {b}\n{verdict}: {rays} rays, lengths in {}.\n\n", terminal::unit_name(unit));
        let rows = report.pairs.iter().map(|pair| {
            let volume = interval::text;
            let verdict = verdict_of(pair);
            let thickness = pair.spot.map_or_else(String::new, |spot| terminal::short3(spot.thickness));
            // no ray found a difference: the interval around 0 states the density of the rays only
            let difference =
                |own: &measure::Estimate| if own.value == 0.0 { "0".to_owned() } else { volume(own) };
            let volumes = [volume(&pair.both), difference(&pair.a_only), difference(&pair.b_only)];
            [vec![pair.name.clone(), verdict.to_owned()], volumes.into(), vec![thickness]].concat()
        });
        let what = match report.by {
            Match::Medium => "medium",
            Match::Region => "region",
            Match::Whole | Match::Auto => "part",
        };
        let header = [what, "verdict", "both", "A only", "B only", "thickest"];
        text += &terminal::table(&header, &rows.collect::<Vec<_>>(), &[false; 6]);
        text += &format!("volumes in {unit}^3, ± half the width of their confidence interval\n");
        for pair in report.pairs.iter().filter(|pair| !pair.is_same) {
            text += &example(pair);
            text += &places(pair, unit);
        }
        text
    }

    fn as_json(&self, report: &DiffReport) -> Value {
        json!({
            "a": self.model.name(),
            "b": self.other.display().to_string(),
            "unit": report.unit.symbol(),
            "is_same": report.is_same(),
            "distance": report.distance,
            "confidence": self.confidence,
            "rays": report.rays,
            "pairs": report.pairs.iter().map(pair_json).collect::<Vec<_>>(),
        })
    }
}

fn verdict_of(pair: &Difference) -> &'static str {
    match (pair.is_in, pair.is_same, pair.is_proved) {
        ([true, false], false, _) => "only in A",
        ([false, true], false, _) => "only in B",
        (_, false, _) => "different",
        (_, true, true) => "same (as written)",
        (_, true, false) => "same",
    }
}

/// The ray through the thickest difference.
fn example(pair: &Difference) -> String {
    let Some(ThickestSpot { chord, thickness, is_a, .. }) = pair.spot else { return String::new() };
    let point = |p: rayweave::Vec3| terminal::short_point(p.to_array());
    let whose = if is_a { "A" } else { "B" };
    let place = pair.place.map_or_else(String::new, |place| {
        format!("; differences from {} to {}", point(place.lo), point(place.hi))
    });
    format!(
        "\n{}: only in {whose}, {} thick, along the ray from {} to {}{place}",
        pair.name,
        terminal::short3(thickness),
        point(chord.from),
        point(chord.to)
    ) + "\n"
}

/// The greatest number of places in text.
const MAX_PLACES: usize = 10;

/// The connected places of differences, the largest first.
fn places(pair: &Difference, unit: &str) -> String {
    let count = pair.places.len();
    if count < 2 {
        return String::new();
    }
    let point = |p: rayweave::Vec3| terminal::short_point(p.to_array().map(|x| terminal::rounded(x, 4)));
    let row = |place: &DifferencePlace| {
        let size = place.bounds.size().to_array().map(terminal::short3).join(" x ");
        let whose = if place.is_a { "A" } else { "B" };
        vec![whose.to_owned(), format!("~{}", terminal::short3(place.volume)), point(place.centre), size]
    };
    let rows: Vec<Vec<String>> = pair.places.iter().take(MAX_PLACES).map(row).collect();
    let header = ["only in", "volume", "centre", "extent"];
    let more = match count.saturating_sub(MAX_PLACES) {
        0 => String::new(),
        more => format!("and {} (--json lists them)\n", terminal::count(more as u64, "smaller place")),
    };
    format!("{}: {count} places, the largest first, in {unit}\n", pair.name)
        + &terminal::table(&header, &rows, &[false; 4])
        + &more
}

fn pair_json(pair: &Difference) -> Value {
    let spot = pair.spot.map(|spot| {
        json!({
            "at": spot.at.to_array(),
            "thickness": spot.thickness,
            "from": spot.chord.from.to_array(),
            "to": spot.chord.to.to_array(),
            "only_in": if spot.is_a { "A" } else { "B" },
        })
    });
    json!({
        "name": pair.name,
        "is_in": pair.is_in,
        "is_same": pair.is_same,
        "is_proved": pair.is_proved,
        "both": interval::json(&pair.both),
        "a_only": interval::json(&pair.a_only),
        "b_only": interval::json(&pair.b_only),
        "spot": spot,
        "place": pair.place.map(|place| [place.lo.to_array(), place.hi.to_array()]),
        "places": pair.places.iter().map(place_json).collect::<Vec<_>>(),
    })
}

fn place_json(place: &DifferencePlace) -> Value {
    json!({
        "only_in": if place.is_a { "A" } else { "B" },
        "volume": place.volume,
        "centre": place.centre.to_array(),
        "bounds": [place.bounds.lo.to_array(), place.bounds.hi.to_array()],
    })
}
