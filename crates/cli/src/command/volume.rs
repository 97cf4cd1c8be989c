//! `rayweave volume`: volume, mass, inertia and surface area of the regions of a model.

use crate::arguments::{
    GlobalArguments, ModelArguments, PartArguments, SamplingArguments, SubjectArguments, WithinArguments,
};
use crate::failure::{Failure, unreadable};
use crate::terminal::{self, Sampling, Unit};
use crate::{interrupt, interval};
use clap::Args;
use rayweave::AnyEvaluator;
use rayweave::measure::{
    Estimate, MeasureProgress, MeasureSettings, MeasureShare, Measured, RegionReport, SceneReport,
    cell_count, measure_scene_with_progress, report_shares, share_of_scene,
};
use rayweave::scene::Scene;
use rayweave::table::{Part, TableWriter};
use serde_json::{Value, json};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Measure volume, mass, centre, inertia, surface area and bounds of every region, with confidence intervals
///
/// Traces stratified rays until the volume of each region reaches the requested precision, or --rays rays. A region excludes the parts that later
/// regions own; --solid measures a solid alone. The mass, in grams, needs a density (in g/cm^3) in the table of the medium. The
/// JSON output also contains the intervals of the centre, and the inertia tensor about the centre for density 1.
#[derive(Args)]
pub struct Volume {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    #[command(flatten)]
    sampling: SamplingArguments,

    #[command(flatten)]
    within: WithinArguments,

    /// Trace about this many rays, one set for all regions, instead of rays until the precision is reached. They are divided into
    /// cells of two rays, at least three; --range counts cells
    #[arg(long, value_name = "N", value_parser = crate::arguments::count::<u64, 6, MAX_TOTAL>)]
    total: Option<u64>,

    #[command(flatten)]
    part: PartArguments,

    /// Write the sums of the cells of --range to this file, for `rayweave merge`
    #[arg(short, long, value_name = "SUMS", requires = "total", requires = "range")]
    out: Option<PathBuf>,

    /// Report from the sums of all cells of --total, which `rayweave merge` has written
    #[arg(long, value_name = "SUMS", requires = "total", conflicts_with = "range")]
    sums: Option<PathBuf>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The most rays of --total: sums of 2^35 cells, of two rays each, are exact.
const MAX_TOTAL: u64 = 1 << 36;

/// An estimate of the rays that reach a precision, one digit, rounded up: half-widths decrease as the power -3/4 of the number of rays.
fn needed_rays(measured: &Measured, precision: f64) -> f64 {
    let reached = measured.volume.half_width / measured.volume.value;
    let rays = measured.rays as f64 * libm::pow(reached / precision, 4.0 / 3.0);
    let digit = libm::pow(10.0, libm::floor(libm::log10(rays)));
    libm::ceil(rays / digit) * digit
}

impl Volume {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let scene = self.model.load()?;
        let settings = MeasureSettings {
            precision: self.sampling.precision,
            confidence: self.sampling.confidence,
            within: self.within.bounds(),
            seed: self.sampling.seed,
            threads: global.threads,
            cancel: interrupt::token(),
            ..MeasureSettings::default()
        }
        .with_most_rays(self.sampling.rays);
        if self.part.range.is_some() {
            return self.write_part(&scene, &settings, global);
        }
        let solid = self.subject.solid.as_deref();
        let make = AnyEvaluator::maker(self.subject.evaluator.as_deref());
        let report = match (self.total, &self.sums) {
            (Some(total), Some(sums)) => {
                let share = self.read_sums(&scene, &settings, sums, total)?;
                report_shares(&scene, solid, make, &settings, &share)
            }
            (Some(total), None) => {
                let all = 0..cell_count(total);
                let bar = terminal::progress_bar(Some(2 * cell_count(total)), Unit::Percent, global.quiet);
                let mut progress = |rays| bar.set_position(rays);
                let share = share_of_scene(&scene, solid, &make, &settings, (total, all), &mut progress);
                bar.finish_and_clear();
                share.and_then(|share| report_shares(&scene, solid, &make, &settings, &share))
            }
            _ => {
                let bar = Sampling::new(settings.precision, global.quiet);
                let mut progress = |now: MeasureProgress| bar.show(now.rays, now.precision);
                let report = measure_scene_with_progress(&scene, solid, make, &settings, &mut progress);
                bar.finish();
                report
            }
        };
        let report = report?;
        terminal::print(&match self.json {
            true => format!("{:#}\n", self.as_json(&scene, &report)),
            false => self.as_text(&scene, &report),
        })?;
        let (missed, imprecise): (Vec<_>, Vec<_>) = report
            .regions
            .iter()
            .filter(|region| !region.measured.is_reached)
            .partition(|region| region.measured.longest.is_none());
        let traced = imprecise.iter().map(|region| region.measured.rays).max().unwrap_or(0);
        let needed = imprecise.iter().map(|region| needed_rays(&region.measured, settings.precision));
        let needed = terminal::short(needed.fold(0.0, f64::max));
        let [missed, imprecise] =
            [missed, imprecise].map(|some| some.into_iter().map(name).collect::<Vec<_>>());
        if !missed.is_empty() {
            let names = listed(&missed);
            terminal::note(&format!(
                "note: {names}: no ray crossed it. Measure within a smaller box: --within."
            ));
        }
        if !imprecise.is_empty() {
            let (names, most) = (listed(&imprecise), self.total.unwrap_or(traced));
            let is_lower = self.total.is_none() && report.most_rays < settings.most_rays;
            let reason = match (is_lower, self.total) {
                (true, _) => {
                    format!("; the limit is low because many shapes overlap. About --rays {needed} reach it.")
                }
                (false, Some(_)) => format!(". About --total {needed} reach it."),
                (false, None) => format!(". About --rays {needed} reach it."),
            };
            terminal::note(&format!(
                "note: {names}: the requested precision is not reached after {most} rays{reason}"
            ));
        }
        Ok(())
    }

    /// The part that consists of a range of cells.
    fn part_of(&self, scene: &Scene, settings: &MeasureSettings, total: u64, range: Range<u64>) -> Part {
        let own = [
            ("model", scene.content_hash()),
            ("solid", self.subject.solid.clone().unwrap_or_default()),
            ("seed", settings.seed.to_string()),
            ("rays", total.to_string()),
            ("within", format!("{:?}", self.within.within)),
        ];
        Part::new("volume", own.map(|(name, value)| (name.to_owned(), value)), range, cell_count(total))
    }

    /// Traces a range of cells and writes their sums.
    fn write_part(
        &self,
        scene: &Scene,
        settings: &MeasureSettings,
        global: &GlobalArguments,
    ) -> Result<(), Failure> {
        let (Some(range), Some(total), Some(out)) = (&self.part.range, self.total, &self.out) else {
            let text =
                "--range measures a part of --total rays and writes it to a file: give --total and --out.";
            return Err(Failure::Usage(text.to_owned()));
        };
        let count = cell_count(total);
        if range.end > count {
            let text = format!("--range ends at {}: {total} rays are {count} cells.", range.end);
            return Err(Failure::Usage(text));
        }
        TableWriter::check_part(out)?;
        let part = self.part_of(scene, settings, total, range.clone());
        if self.part.is_done([(out.as_path(), &part)].into_iter(), global.quiet) {
            return Ok(());
        }
        let make = AnyEvaluator::maker(self.subject.evaluator.as_deref());
        let rays = 2 * (range.end - range.start);
        let bar = terminal::progress_bar(Some(rays), Unit::Percent, global.quiet);
        let (solid, cells) = (self.subject.solid.as_deref(), (total, range.clone()));
        let share = share_of_scene(scene, solid, make, settings, cells, &mut |rays| bar.set_position(rays));
        bar.finish_and_clear();
        Ok(part.write(out, share?.to_text().as_bytes())?)
    }

    /// Reads the sums of all cells.
    fn read_sums(
        &self,
        scene: &Scene,
        settings: &MeasureSettings,
        path: &Path,
        total: u64,
    ) -> Result<MeasureShare, Failure> {
        let part = self.part_of(scene, settings, total, 0..cell_count(total));
        if !part.is_in(path) {
            let path = path.display();
            let text = format!(
                "{path} has other sums: it is not the complete result for this model, seed and number of rays. \
                 Merge all parts of --total {total}."
            );
            return Err(Failure::Input(text));
        }
        read_share(path)
    }

    fn as_text(&self, scene: &Scene, report: &SceneReport) -> String {
        let (model, unit) = (self.model.name(), scene.unit.symbol());
        let percent = terminal::short(self.sampling.confidence * 100.0);
        let rays = report.rays;
        let mut text = format!(
            "{model}: {percent} % confidence intervals from {rays} rays, lengths in {}\n\n",
            terminal::unit_name(unit)
        );
        let has_mass = report.regions.iter().any(|region| region.mass.is_some());
        let has_formula = report.regions.iter().any(|region| region.exact_volume.is_some());
        let mut header = vec!["region", "medium", "volume"];
        header.extend(has_formula.then_some("by formula"));
        header.extend(has_mass.then_some("mass (g)"));
        let has_box = report.regions.iter().any(|region| region.bounds.is_some());
        header.extend(["area", "centre"]);
        header.extend(has_box.then_some("bounds"));
        let rows = report.regions.iter().map(|region| {
            let measured = &region.measured;
            let mut row =
                vec![measured.name.clone(), region.medium.clone(), interval::text(&measured.volume)];
            row.extend(has_formula.then(|| region.exact_volume.map_or_else(String::new, terminal::short)));
            row.extend(has_mass.then(|| region.mass.as_ref().map_or_else(String::new, interval::text)));
            let centre = measured.centre.map(|centre| centre.map(|c| interval::rounded(&c).0).join(", "));
            row.extend([
                interval::text(&measured.area),
                centre.map_or_else(String::new, |c| format!("({c})")),
            ]);
            let corner =
                |p: rayweave::Vec3| terminal::short_point(p.to_array().map(|x| terminal::rounded(x, 9)));
            let bounds = region.bounds.map(|own| format!("{} to {}", corner(own.lo), corner(own.hi)));
            row.extend(has_box.then(|| bounds.unwrap_or_default()));
            row
        });
        let rows: Vec<Vec<String>> = rows.collect();
        text += &terminal::table(&header, &rows, &vec![false; header.len()]);
        text
    }

    fn as_json(&self, scene: &Scene, report: &SceneReport) -> Value {
        json!({
            "model": self.model.name(),
            "unit": scene.unit.symbol(),
            "confidence": self.sampling.confidence,
            "rays": report.rays,
            "regions": report.regions.iter().map(region_json).collect::<Vec<_>>(),
        })
    }
}

/// Reads a file of sums.
pub fn read_share(path: &Path) -> Result<MeasureShare, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| unreadable(path, &error))?;
    MeasureShare::from_text(&text)
        .ok_or_else(|| Failure::Input(format!("{} has no sums of a measurement.", path.display())))
}

fn name(region: &RegionReport) -> &str {
    &region.measured.name
}

/// The most names in a note.
const MAX_NAMES: usize = 8;

/// The names for a note: the first ones and the number of the others.
fn listed(names: &[&str]) -> String {
    match names.len().checked_sub(MAX_NAMES) {
        Some(more) if more > 1 => format!("{}, ... and {more} more", names[..MAX_NAMES].join(", ")),
        _ => names.join(", "),
    }
}

fn region_json(region: &RegionReport) -> Value {
    let measured = &region.measured;
    let row = |row: &[Estimate; 3]| row.iter().map(interval::json).collect::<Vec<_>>();
    json!({
        "name": measured.name,
        "medium": region.medium,
        "volume": interval::json(&measured.volume),
        "volume_by_formula": region.exact_volume,
        "bounds": region.bounds.map(|own| [own.lo.to_array(), own.hi.to_array()]),
        "mass_g": region.mass.as_ref().map(interval::json),
        "area": interval::json(&measured.area),
        "centre": measured.centre.as_ref().map(row),
        "inertia": measured.inertia.iter().map(row).collect::<Vec<_>>(),
        "rays": measured.rays,
        "is_reached": measured.is_reached,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_name_a_few_regions() {
        let names: Vec<String> = (0..1801).map(|k| format!("r{k}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        assert_eq!(listed(&names), "r0, r1, r2, r3, r4, r5, r6, r7, ... and 1793 more");
        assert_eq!(listed(&names[..9]), names[..9].join(", "));
        assert_eq!(listed(&names[..1]), "r0");
    }
}
