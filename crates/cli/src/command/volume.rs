//! `rayweave volume`: how large and how heavy the regions of a model are.

use crate::arguments::{Cli, ModelArguments, SubjectArguments, point};
use crate::failure::Failure;
use crate::{interrupt, terminal};
use clap::Args;
use rayweave::measure::{Estimate, RegionReport, SceneReport, Settings, measure_scene};
use rayweave::scene::Scene;
use rayweave::{Bounds, Vec3};
use serde_json::{Value, json};

/// Measure volume, mass, centre, inertia and surface area of every region, with confidence intervals
///
/// By stratified rays, until the volume of each region is as precise as asked. A region is what later regions leave of it;
/// --solid measures a solid as if it were alone. The mass, in grams, needs a density (in g/cm^3) in the table of the medium.
/// The inertia tensor, about the centre and for density 1, is in the JSON.
#[derive(Args)]
pub struct Volume {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    /// Stop when half the width of the interval is this part of the volume
    #[arg(long, value_name = "P", default_value_t = 1e-3)]
    precision: f64,

    /// The level of confidence of the intervals
    #[arg(long, value_name = "C", default_value_t = 0.99)]
    confidence: f64,

    /// Ask at most so many rays for a region
    #[arg(long, value_name = "N", default_value_t = 1 << 24)]
    rays: u64,

    /// Measure only what lies within a box: its lower and its upper corner
    #[arg(long, num_args = 2, value_names = ["LO", "HI"], value_parser = point, allow_hyphen_values = true)]
    within: Option<Vec<[f64; 3]>>,

    /// Chooses the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Volume {
    pub fn run(&self, cli: &Cli) -> Result<(), Failure> {
        let scene = self.model.load()?;
        let settings = Settings {
            precision: self.precision,
            confidence: self.confidence,
            most_rays: self.rays,
            within: self.within.as_deref().and_then(|corners| match *corners {
                [lo, hi] => Some(Bounds { lo: Vec3::from(lo), hi: Vec3::from(hi) }),
                _ => None,
            }),
            seed: self.seed,
            threads: cli.threads,
            cancel: interrupt::token()?,
        };
        let (solid, evaluator) = (self.subject.solid.as_deref(), self.subject.evaluator.as_deref());
        let bar = terminal::counter("rays", cli.quiet);
        let report = measure_scene(&scene, solid, evaluator, &settings, &mut |rays| bar.set_position(rays));
        bar.finish_and_clear();
        let report = report?;
        terminal::print(&match self.json {
            true => format!("{:#}\n", self.as_json(&scene, &report)),
            false => self.as_text(&scene, &report),
        })?;
        let vague: Vec<&str> = report.regions.iter().filter(|r| !r.measured.is_reached).map(name).collect();
        if !vague.is_empty() {
            let (names, most) = (vague.join(", "), self.rays);
            terminal::note(&format!("note: {names}: not as precise as asked after {most} rays (see --rays)"));
        }
        Ok(())
    }

    fn as_text(&self, scene: &Scene, report: &SceneReport) -> String {
        let (model, unit) = (self.model.name(), scene.unit.symbol());
        let percent = terminal::short(self.confidence * 100.0);
        let rays = report.rays;
        let mut text = format!("{model}: {percent} % intervals from {rays} rays, lengths in {unit}\n\n");
        let has_mass = report.regions.iter().any(|region| region.mass.is_some());
        let has_formula = report.regions.iter().any(|region| region.formula.is_some());
        let mut header = vec!["region", "medium", "volume"];
        header.extend(has_formula.then_some("by formula"));
        header.extend(has_mass.then_some("mass (g)"));
        header.extend(["area", "centre"]);
        let rows = report.regions.iter().map(|region| {
            let measured = &region.measured;
            let mut row = vec![measured.name.clone(), region.medium.clone(), interval(&measured.volume)];
            row.extend(has_formula.then(|| region.formula.map_or_else(String::new, terminal::short)));
            row.extend(has_mass.then(|| region.mass.as_ref().map_or_else(String::new, interval)));
            let centre = measured.centre.map(|centre| centre.map(|c| rounded(&c).0).join(", "));
            row.extend([interval(&measured.area), centre.map_or_else(String::new, |c| format!("({c})"))]);
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
            "confidence": self.confidence,
            "rays": report.rays,
            "regions": report.regions.iter().map(region_json).collect::<Vec<_>>(),
        })
    }
}

fn name(region: &RegionReport) -> &str {
    &region.measured.name
}

fn region_json(region: &RegionReport) -> Value {
    let measured = &region.measured;
    let row = |row: &[Estimate; 3]| row.iter().map(estimate_json).collect::<Vec<_>>();
    json!({
        "name": measured.name,
        "medium": region.medium,
        "volume": estimate_json(&measured.volume),
        "volume_by_formula": region.formula,
        "mass_g": region.mass.as_ref().map(estimate_json),
        "area": estimate_json(&measured.area),
        "centre": measured.centre.as_ref().map(row),
        "inertia": measured.inertia.iter().map(row).collect::<Vec<_>>(),
        "rays": measured.rays,
        "is_reached": measured.is_reached,
    })
}

fn estimate_json(estimate: &Estimate) -> Value {
    json!({ "value": estimate.value, "half_width": estimate.half_width })
}

/// A value with its half width, as `12.34 ± 0.05`; the width has two digits at most, and the value ends where it does.
fn interval(estimate: &Estimate) -> String {
    let (value, width) = rounded(estimate);
    format!("{value} \u{b1} {width}")
}

fn rounded(estimate: &Estimate) -> (String, String) {
    let width = estimate.half_width;
    if !width.is_finite() {
        return (terminal::short(estimate.value), terminal::short(width));
    }
    // below ten digits of the value the width says nothing to a reader
    if width <= 1e-10 * estimate.value.abs() {
        return (terminal::short(estimate.value), "0".to_owned());
    }
    // the place of the second digit: one after the power of ten of the first
    let first = format!("{width:e}").split_once('e').and_then(|(_, power)| power.parse::<i32>().ok());
    let place = 1 - first.unwrap_or_default();
    if (0..=12).contains(&place) {
        let digits = place as usize;
        return (format!("{:.digits$}", estimate.value), format!("{width:.digits$}"));
    }
    let step = 10f64.powi(-place);
    let whole = |x: f64| terminal::short((x / step).round() * step);
    (whole(estimate.value), whole(width))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_rounded_to_two_digits_of_their_width() {
        let text = |value: f64, half_width: f64| interval(&Estimate { value, half_width });
        assert_eq!(text(1234.5678, 0.0456), "1234.568 \u{b1} 0.046");
        assert_eq!(text(1234567.0, 456.0), "1234570 \u{b1} 460");
        assert_eq!(text(-0.25, 0.0), "-0.25 \u{b1} 0");
        assert_eq!(text(48.0, 1e-15), "48 \u{b1} 0");
        assert_eq!(text(1.5e-20, 1e-22), "1.5e-20 \u{b1} 1e-22");
        assert_eq!(text(0.0, 0.0), "0 \u{b1} 0");
    }
}
