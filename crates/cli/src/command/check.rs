//! `rayweave check`: probable mistakes of a model.

use super::photon_tables::SurfaceTableArguments;
use crate::arguments::{
    GlobalArguments, ModelArguments, OnlyArguments, PartArguments, WithinArguments, debug_hash,
};
use crate::failure::{Failure, unreadable};
use crate::{drawing, interrupt, interval, terminal};
use clap::Args;
use rayweave::check::{
    CheckProgress, CheckReport, CheckSettings, CheckShare, Finding, FindingKind, Hierarchy, check_share,
    check_with, finding_section,
};
use rayweave::photon::lint;
use rayweave::scene::Scene;
use rayweave::section::{section_svg, section_with_thickness};
use rayweave::table::{Part, TableWriter};
use rayweave::{AnyEvaluator, Packets};
use serde_json::{Value, json};
use std::ops::Range;
use std::path::{Path, PathBuf};

const AFTER_HELP: &str = "\
Kinds of findings:
  overlap   two regions overlap, and neither is inside the other
  outside   a daughter extends beyond its mother (GDML)
  hidden    a region is completely covered by later ones
  empty     a solid is empty
  absorbed  an operand of a boolean operator has no effect
  mesh      a mesh that is closed, but may not be as intended
  thin      a wall thinner than --wall
  gap       a gap narrower than --gap
  optical   an optical property, surface or sensor is probably wrong
  loose     a region consists of separate pieces (a note)
  cavity    one or several regions enclose a cavity (a note)
  touch     two regions touch (a note)
  unused    an optical property or surface has no effect (a note)

A file that cannot be read, for example because of an open mesh, is reported as an error with its position (exit code 3).";

/// Look for overlaps, gaps, thin walls, loose pieces, cavities, parts without effect, daughters outside their mothers, suspicious optical properties
///
/// Pairs of parts that bounding boxes cannot separate are sampled with rays. Findings are certain; their absence depends on the
/// density of rays (--cells). Each finding has a position, a size and a ray that shows it. With --fail-on, findings of the given
/// kinds cause exit code 1.
///
/// With --range, only some of the searches in pairs of parts and operands run, and their results become a part; `rayweave merge`
/// joins the parts, and --searches reports with them. The report is that of a check without parts.
#[derive(Args)]
#[command(after_help = AFTER_HELP)]
pub struct Check {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    only: OnlyArguments,

    /// Report walls thinner than this, between any two faces: up to 20 for each region, the thinnest first [default: 1e-5 of the diagonal of the model]
    #[arg(long, value_name = "LENGTH")]
    wall: Option<f64>,

    /// Report gaps narrower than this, between any two faces: up to 20 for each two regions, the narrowest first [default: 1e-5 of the diagonal of the model]
    #[arg(long, value_name = "LENGTH")]
    gap: Option<f64>,

    /// Attribute overlaps that are nowhere deeper than this to rounding [default: 1e-9 of the diagonal of the model]
    #[arg(long, value_name = "LENGTH")]
    distance: Option<f64>,

    #[command(flatten)]
    within: WithinArguments,

    /// Cells along each edge of a cross-section of the model; each cell gets one ray. Fewer where a ray reaches more than 32 shapes on average
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = crate::arguments::count::<u32, 2, 4096>)]
    cells: u32,

    /// Maximum number of pairs of parts, and of operands, to examine; fewer of them if they are large
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = crate::arguments::any_count::<usize>)]
    pairs: usize,

    #[command(flatten)]
    tables: SurfaceTableArguments,

    /// Confidence level of volumes
    #[arg(long, value_name = "C", default_value_t = 0.99)]
    confidence: f64,

    /// Seed of random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = crate::arguments::any_count::<u64>)]
    seed: u64,

    /// Exit with code 1 if there are findings of these kinds, such as overlap,thin; `all` means all kinds except notes
    #[arg(long, value_name = "KINDS", value_delimiter = ',', value_parser = kinds)]
    fail_on: Vec<Kinds>,

    /// Write a picture of each located finding into this folder, cut along its ray; those of walls and gaps show the thickness
    #[arg(long, value_name = "FOLDER")]
    pictures: Option<PathBuf>,

    #[command(flatten)]
    part: PartArguments,

    /// Output file of the results of the searches of --range
    #[arg(short, long, value_name = "OUT", requires = "range")]
    out: Option<PathBuf>,

    /// Report with the results of all searches in this file, merged from parts, instead of searching again
    #[arg(long, value_name = "FILE", conflicts_with = "range")]
    searches: Option<PathBuf>,

    /// Maximum number of findings of each kind to print; walls and gaps of one size are one finding for each pair of faces
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = crate::arguments::any_count::<usize>)]
    lines: usize,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The title of the picture of a finding; for walls and gaps, with their size and the limit.
fn title(finding: &Finding, report: &CheckReport) -> String {
    let (what, limit) = match finding.kind {
        FindingKind::Thin => ("wall", report.scope.wall),
        FindingKind::Gap => ("gap", report.scope.gap),
        _ => return finding.text.clone(),
    };
    let (size, unit) = (terminal::short3(finding.size.unwrap_or(0.0)), report.unit.symbol());
    let (names, limit) = (finding.regions.join(" and "), terminal::short3(limit));
    format!("{names}: {what} of {size} {unit}, limit {limit} {unit}")
}

/// One kind, or all kinds that are faults.
#[derive(Clone, Copy)]
enum Kinds {
    All,
    One(FindingKind),
}

fn kinds(text: &str) -> Result<Kinds, String> {
    match text.trim() {
        "all" => Ok(Kinds::All),
        name => name.parse::<FindingKind>().map(Kinds::One).map_err(|error| error.to_string()),
    }
}

impl Kinds {
    fn holds(self, kind: FindingKind) -> bool {
        match self {
            Kinds::All => !kind.is_note(),
            Kinds::One(own) => own == kind,
        }
    }
}

impl Check {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let imported = self.only.of_import(self.model.import_all()?)?;
        let scene = imported.scene;
        let settings = CheckSettings {
            wall: self.wall,
            gap: self.gap,
            distance: self.distance,
            across: self.cells,
            confidence: self.confidence,
            most_pairs: self.pairs,
            within: self.within.bounds(),
            seed: self.seed,
            threads: global.threads,
            cancel: interrupt::token(),
        };
        let places = |element, name: &str, property: &str| {
            imported.places.find(element, name, property).map(str::to_owned)
        };
        let hierarchy = imported.stated.as_ref().and_then(|document| Hierarchy::of(document, &scene));
        let run = Searches { check: self, scene: &scene, hierarchy: hierarchy.as_ref(), settings: &settings };
        if self.part.range.is_some() {
            return run.write(global);
        }
        let tables = self.tables.tables()?;
        let optical =
            imported.stated.as_ref().map(|document| lint(&scene, document, &tables, Packets::new, &places));
        let mut report = run.report(global)?;
        let stated = optical.into_iter().flatten().map(|finding| {
            let kind = if finding.is_unused { FindingKind::Unused } else { FindingKind::Optical };
            Finding::stated(kind, finding.to_string())
        });
        let undefined = imported.report.undefined().map(|loss| {
            let place = loss.place().map_or(String::new(), |place| format!("{place}: "));
            Finding::stated(FindingKind::Optical, format!("{place}{}", loss.first.message()))
        });
        report.findings.extend(undefined.chain(stated));
        // what is wrong with the light comes first: in a detector, volumes that touch are the usual case
        report.findings.sort_by_key(|finding| (finding.kind != FindingKind::Optical, finding.kind));
        let pictures = match &self.pictures {
            Some(folder) => self.draw(folder, &scene, &report, &settings)?,
            None => Vec::new(),
        };
        let written: String = pictures.iter().map(|path| format!("\npicture: {}", path.display())).collect();
        let end = if written.is_empty() { "" } else { "\n" };
        terminal::print(&match self.json {
            true => format!("{:#}\n", self.as_json(&report)),
            false => self.as_text(&report) + &written + end,
        })?;
        let is_bad = |finding: &Finding| self.fail_on.iter().any(|kinds| kinds.holds(finding.kind));
        if report.findings.iter().any(is_bad) { Err(Failure::Answer) } else { Ok(()) }
    }

    /// Writes a picture of each located finding, named by its number in the list and its kind; returns their paths.
    fn draw(
        &self,
        folder: &std::path::Path,
        scene: &Scene,
        report: &CheckReport,
        settings: &CheckSettings,
    ) -> Result<Vec<PathBuf>, Failure> {
        let mut written = Vec::new();
        let cannot = |error: std::io::Error| {
            Failure::Run(format!("cannot write the pictures to {}: {error}.", folder.display()))
        };
        std::fs::create_dir_all(folder).map_err(cannot)?;
        for (number, finding) in (1..).zip(&report.findings) {
            if let Some(section) = finding_section(scene, finding, AnyEvaluator::maker(None), settings)? {
                let title = title(finding, report);
                let path = folder.join(format!("{number}-{}.svg", finding.kind.name()));
                crate::outputs::check_unnamed(&path)?;
                let unit = report.unit.symbol();
                let is_thickness = matches!(finding.kind, FindingKind::Thin | FindingKind::Gap);
                let svg = match (finding.ray, finding.size) {
                    (Some(ray), Some(size)) if is_thickness => {
                        let text = format!("{} {unit}", terminal::short3(size));
                        section_with_thickness(&section, &title, unit, [ray.from, ray.to], &text)
                    }
                    _ => section_svg(&[section], &title, unit),
                };
                drawing::save(&path, &svg, &title)?;
                written.push(path);
            }
        }
        Ok(written)
    }

    fn as_text(&self, report: &CheckReport) -> String {
        let (model, unit) = (self.model.name(), report.unit.symbol());
        let of = |kind: FindingKind| report.of(kind).count();
        let counts: Vec<String> = FindingKind::ALL
            .iter()
            .filter(|(kind, _)| of(*kind) > 0)
            .map(|(kind, name)| format!("{name} {}", of(*kind)))
            .collect();
        let found = if counts.is_empty() { "nothing found".to_owned() } else { counts.join(", ") };
        let mut text = format!(
            "{model}: {found}; lengths in {}\n{}",
            terminal::unit_name(unit),
            scope(report, self.cells)
        );
        for (kind, name) in FindingKind::ALL {
            let mut printed = 0;
            for group in grouped(report.of(kind)) {
                if printed >= self.lines {
                    text += &format!("\n{name}: {} more (see --lines)\n", of(kind) - printed);
                    break;
                }
                // walls and gaps of one size are different places to be changed
                let shown = match kind {
                    FindingKind::Thin | FindingKind::Gap => group.len().min(self.lines - printed),
                    _ => 1,
                };
                let times = match group.len() {
                    1 => String::new(),
                    count if count == shown => format!(" ({count} times)"),
                    count if shown == 1 => format!(" ({count} times, for example here)"),
                    count => format!(" ({count} times, of which {shown} are shown: see --lines)"),
                };
                text += &format!("\n{name}: {}{times}\n", group[0].text);
                let facts = group[..shown].iter().map(|finding| facts(finding, unit));
                text += &facts
                    .filter(|facts| !facts.is_empty())
                    .map(|facts| format!("  {facts}\n"))
                    .collect::<String>();
                printed += if shown == 1 { group.len() } else { shown };
            }
        }
        text
    }

    fn as_json(&self, report: &CheckReport) -> Value {
        let scope = &report.scope;
        json!({
            "model": self.model.name(),
            "unit": report.unit.symbol(),
            "seed": self.seed,
            "confidence": self.confidence,
            "findings": report.findings.iter().map(finding_json).collect::<Vec<_>>(),
            "scope": {
                "rays": scope.rays,
                "cells": scope.cells,
                "cells_in_regions": scope.cells_in_regions,
                "reached": scope.reached,
                "chords": scope.chords,
                "edges": scope.edges,
                "edges_left_out": scope.edges_left_out,
                "wall": scope.wall,
                "gap": scope.gap,
                "distance": scope.distance,
                "parts": scope.parts,
                "pairs_apart": scope.apart,
                "pairs": scope.pairs,
                "pairs_left_out": scope.left_out,
                "operands": scope.operands,
                "operands_left_out": scope.operands_left_out,
                "pieces_left_out": scope.pieces_left_out,
                "cavities_left_out": scope.cavities_left_out,
                "has_hierarchy": scope.has_hierarchy,
            },
        })
    }
}

/// Findings with the same text and the same size to six digits, such as the walls beside equal holes, in one group. Those without a
/// size stay apart.
fn grouped<'a>(findings: impl Iterator<Item = &'a Finding>) -> Vec<Vec<&'a Finding>> {
    let mut groups: Vec<Vec<&Finding>> = Vec::new();
    let size = |finding: &Finding| finding.size.map(|size| terminal::rounded(size, 6));
    for finding in findings {
        let is_like =
            |known: &&mut Vec<&Finding>| known[0].text == finding.text && size(known[0]) == size(finding);
        match groups.iter_mut().find(is_like).filter(|_| finding.size.is_some()) {
            Some(group) => group.push(finding),
            None => groups.push(vec![finding]),
        }
    }
    groups
}

/// The searches of a check: run here, or read from a file.
struct Searches<'a> {
    check: &'a Check,
    scene: &'a Scene,
    hierarchy: Option<&'a Hierarchy>,
    settings: &'a CheckSettings,
}

impl Searches<'_> {
    fn report(&self, global: &GlobalArguments) -> Result<CheckReport, Failure> {
        let known = match &self.check.searches {
            Some(path) => {
                let share = read_check_share(path)?;
                // a file of all searches has as many lines as there are searches
                let part = self.part(0..share.len() as u64, share.len() as u64);
                if !part.is_in(path) {
                    let path = path.display();
                    let text = format!(
                        "{path} has other searches: it is not the complete result for this model, seed and settings. \
                         Merge all parts."
                    );
                    return Err(Failure::Input(text));
                }
                share
            }
            None => CheckShare::default(),
        };
        let bar = terminal::Searching::new(global.quiet);
        let make = AnyEvaluator::maker(None);
        let mut progress = |now: CheckProgress| bar.show(now.rays, [now.done, now.total]);
        let report = check_with(self.scene, self.hierarchy, make, self.settings, &known, &mut progress);
        bar.finish();
        Ok(report?)
    }

    /// Runs the searches of the range and writes their results.
    fn write(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let (Some(range), Some(out)) = (&self.check.part.range, &self.check.out) else {
            let text = "--range writes the results of its searches to a file: give --out.";
            return Err(Failure::Usage(text.to_owned()));
        };
        TableWriter::check_part(out)?;
        let part = self.part(range.clone(), range.end);
        if self.check.part.is_done([(out.as_path(), &part)].into_iter(), global.quiet) {
            return Ok(());
        }
        let bar = terminal::Searching::new(global.quiet);
        let make = AnyEvaluator::maker(None);
        let mut progress = |now: CheckProgress| bar.show(now.rays, [now.done, now.total]);
        let share =
            check_share(self.scene, self.hierarchy, make, self.settings, range.clone(), &mut progress);
        bar.finish();
        let (share, total) = share?;
        self.part(range.clone(), total).write(out, share.to_text().as_bytes())?;
        match global.quiet {
            true => Ok(()),
            false => terminal::print(&format!("{}: {} of {total} searches\n", out.display(), share.len())),
        }
    }

    fn part(&self, range: Range<u64>, total: u64) -> Part {
        let CheckSettings { distance, seed, most_pairs, .. } = self.settings;
        let own = [
            ("model", self.scene.content_hash()),
            ("hierarchy", debug_hash(&self.hierarchy)),
            ("seed", seed.to_string()),
            ("distance", format!("{distance:?}")),
            ("pairs", most_pairs.to_string()),
            ("within", format!("{:?}", self.check.within.within)),
        ];
        Part::new("check", own.map(|(name, value)| (name.to_owned(), value)), range, total)
    }
}

/// Reads a file of results of searches.
pub fn read_check_share(path: &Path) -> Result<CheckShare, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| unreadable(path, &error))?;
    CheckShare::from_text(&text)
        .ok_or_else(|| Failure::Input(format!("{} has no results of searches.", path.display())))
}

/// Scope of the check with a number of cells: proved and sampled parts.
fn scope(report: &CheckReport, cells: u32) -> String {
    let scope = &report.scope;
    let short = terminal::short3;
    let (rays, pairs, operands) = (scope.rays, scope.pairs, scope.operands);
    let mut text = match scope.parts {
        0 | 1 => format!("sampled with {rays} rays: one part, {operands} operands\n"),
        _ => format!(
            "proved disjoint by boxes: {} pairs of parts; sampled with {rays} rays: {pairs} pairs of parts, {operands} operands\n",
            scope.apart
        ),
    };
    text += &format!(
        "reported: overlaps deeper than {}, walls under {}, gaps under {}\n",
        short(scope.distance),
        short(scope.wall),
        short(scope.gap)
    );
    if report.of(FindingKind::Thin).next().is_none() {
        let (limit, unit) = (short(scope.wall), report.unit.symbol());
        text += &format!(
            "no wall under {limit} {unit} found among {} chords and from {} points of edges and corners; a wall at a face or edge that no \
             ray meets is not found (see --cells)\n",
            scope.chords, scope.edges
        );
    }
    if scope.cells < cells {
        let (fewer, reached) = (scope.cells, scope.reached.round());
        let single = if scope.cells_in_regions == 0 { ", and no rays through single regions" } else { "" };
        text += &format!(
            "fewer rays, since a ray reaches {reached} shapes on average: {fewer} of {cells} cells along an edge of the model{single}; \
             --within checks a part\n"
        );
    }
    if scope.left_out + scope.operands_left_out > 0 {
        let (pairs, operands) = (scope.left_out, scope.operands_left_out);
        text += &format!("not examined: {pairs} pairs of parts, {operands} operands (see --pairs)\n");
    }
    if scope.edges_left_out > 0 {
        text += &format!(
            "not searched for walls and gaps: {} faces, edges, pairs of edges or narrow places, which the rays of one check do not suffice for (--within checks a part; a model \
             file of shapes has fewer than its mesh)\n",
            scope.edges_left_out
        );
    }
    let regions = match scope.pieces_left_out {
        0 => None,
        1 => Some("separate pieces of 1 region".to_owned()),
        n => Some(format!("separate pieces of {n} regions")),
    };
    let cavities = scope.cavities_left_out.then(|| "closed cavities".to_owned());
    let unknown: Vec<String> = regions.into_iter().chain(cavities).collect();
    if !unknown.is_empty() {
        text += &format!("not searched to the end: {} (--within checks a part)\n", unknown.join(" and "));
    }
    text
}

/// Sizes and positions, on one line.
fn facts(finding: &Finding, unit: &str) -> String {
    let point = |p: rayweave::Vec3| terminal::short_point(p.to_array().map(|x| terminal::rounded(x, 6)));
    let mut facts = Vec::new();
    let how = match finding.kind {
        FindingKind::Thin => "thick",
        FindingKind::Gap => "wide",
        _ => "deep",
    };
    let has_size = !matches!(finding.kind, FindingKind::Hidden);
    facts.extend(
        finding.size.filter(|_| has_size).map(|size| format!("{} {unit} {how}", terminal::short3(size))),
    );
    facts.extend(finding.volume.map(|volume| format!("volume {} {unit}^3", interval::text(&volume))));
    facts.extend(finding.area.map(|area| format!("area about {} {unit}^2", terminal::short3(area))));
    if let [from, to] = &finding.faces[..] {
        facts.push(format!("between {from} and {to}"));
    }
    // a point of the piece or cavity, which the ray passes through
    let has_point = matches!(finding.kind, FindingKind::Loose | FindingKind::Cavity) && finding.ray.is_some();
    facts.extend(finding.at.filter(|_| has_point).map(|at| format!("at {}", point(at))));
    facts.extend(match (finding.ray, finding.at) {
        (Some(ray), _) => Some(format!("ray from {} to {}", point(ray.from), point(ray.to))),
        (None, at) => at.map(|at| format!("at {}", point(at))),
    });
    facts.extend(finding.is_proved.then(|| "proved".to_owned()));
    facts.join(", ")
}

fn finding_json(finding: &Finding) -> Value {
    json!({
        "kind": finding.kind.name(),
        "regions": finding.regions,
        "text": finding.text,
        "size": finding.size,
        "volume": finding.volume.as_ref().map(interval::json),
        "area": finding.area,
        "at": finding.at.map(|at| at.to_array()),
        "ray": finding.ray.map(|ray| [ray.from.to_array(), ray.to.to_array()]),
        "faces": finding.faces,
        "is_proved": finding.is_proved,
    })
}
