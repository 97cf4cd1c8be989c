//! `rayweave volume`: volume, mass, inertia and surface area of the regions of a model.

use crate::arguments::{
    GlobalArguments, ModelArguments, SamplingArguments, SubjectArguments, WithinArguments,
};
use crate::failure::Failure;
use crate::{interrupt, interval, terminal};
use clap::Args;
use rayweave::AnyEvaluator;
use rayweave::measure::{Estimate, MeasureSettings, RegionReport, SceneReport, measure_scene};
use rayweave::scene::Scene;
use serde_json::{Value, json};

/// Measure volume, mass, centre, inertia and surface area of every region, with confidence intervals
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

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Volume {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let scene = self.model.load()?;
        let settings = MeasureSettings {
            precision: self.sampling.precision,
            confidence: self.sampling.confidence,
            most_rays: self.sampling.rays,
            within: self.within.bounds(),
            seed: self.sampling.seed,
            threads: global.threads,
            cancel: interrupt::token(),
        };
        let solid = self.subject.solid.as_deref();
        let make = AnyEvaluator::maker(self.subject.evaluator.as_deref());
        let bar = terminal::counter("rays", global.quiet);
        let report = measure_scene(&scene, solid, make, &settings, &mut |rays| bar.set_position(rays));
        bar.finish_and_clear();
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
        let [missed, imprecise] =
            [missed, imprecise].map(|some| some.into_iter().map(name).collect::<Vec<_>>());
        if !missed.is_empty() {
            let names = missed.join(", ");
            terminal::note(&format!(
                "note: {names}: no ray crossed it. Measure within a smaller box: --within."
            ));
        }
        if !imprecise.is_empty() {
            let (names, most) = (imprecise.join(", "), self.sampling.rays);
            terminal::note(&format!(
                "note: {names}: the requested precision is not reached after {most} rays. See --rays."
            ));
        }
        Ok(())
    }

    fn as_text(&self, scene: &Scene, report: &SceneReport) -> String {
        let (model, unit) = (self.model.name(), scene.unit.symbol());
        let percent = terminal::short(self.sampling.confidence * 100.0);
        let rays = report.rays;
        let mut text =
            format!("{model}: {percent} % confidence intervals from {rays} rays, lengths in {unit}\n\n");
        let has_mass = report.regions.iter().any(|region| region.mass.is_some());
        let has_formula = report.regions.iter().any(|region| region.exact_volume.is_some());
        let mut header = vec!["region", "medium", "volume"];
        header.extend(has_formula.then_some("by formula"));
        header.extend(has_mass.then_some("mass (g)"));
        header.extend(["area", "centre"]);
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

fn name(region: &RegionReport) -> &str {
    &region.measured.name
}

fn region_json(region: &RegionReport) -> Value {
    let measured = &region.measured;
    let row = |row: &[Estimate; 3]| row.iter().map(interval::json).collect::<Vec<_>>();
    json!({
        "name": measured.name,
        "medium": region.medium,
        "volume": interval::json(&measured.volume),
        "volume_by_formula": region.exact_volume,
        "mass_g": region.mass.as_ref().map(interval::json),
        "area": interval::json(&measured.area),
        "centre": measured.centre.as_ref().map(row),
        "inertia": measured.inertia.iter().map(row).collect::<Vec<_>>(),
        "rays": measured.rays,
        "is_reached": measured.is_reached,
    })
}
