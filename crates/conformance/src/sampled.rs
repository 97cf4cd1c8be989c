//! An evaluator against formulas: all points between two crossings are on the reported side.

use crate::oracle::{Oracle, Probe, medium};
use crate::rays::{batch, rays};
use crate::{Effort, Model, Random, Style, Tally, list};
use rayweave_model::{Collected, Evaluator, Program, Query, RegionId};
use rayweave_shape::Ray;
use std::sync::Arc;

/// Samples points between neighbouring crossings, before the first and after the last one: in the middle and
/// ever closer to both ends. A surplus, missing or misplaced crossing shows up there.
pub fn with_formulas<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let (models, count) = effort.models_and_rays();
    let mut tally = Tally::new("points on the side that formulas give");
    let mut clear = 0;
    for seed in 0..models {
        let mut rng = Random::new(1_000_000 + seed);
        let style = [Style::Generic, Style::Generic, Style::Grid, Style::Planes][seed as usize % 4];
        let model = Model::random(&mut rng, style);
        let program = model.compiled();
        let evaluator = make(program);
        let oracles: Vec<Oracle> = model.regions.iter().map(|r| Oracle::new(&r.solid)).collect();
        let rays = rays(&mut rng, style, &model.frame, count / 4);
        let found = evaluator.collect(batch(&rays).rays(), &Query::default()).unwrap();
        for (i, ray) in rays.iter().enumerate() {
            clear += one(&model, &oracles, ray, &found, i, seed, &evaluator, &mut tally);
        }
    }
    // the tolerance must not exclude most samples
    assert!(clear * 10 > tally.checked() * 8, "only {clear} of {} samples are clear", tally.checked());
    tally.finish(models * count as u64);
}

#[expect(clippy::too_many_arguments, reason = "one ray with all that is known of it, for the message")]
fn one<E: Evaluator>(
    model: &Model,
    oracles: &[Oracle],
    ray: &Ray,
    found: &Collected,
    i: usize,
    seed: u64,
    evaluator: &E,
    tally: &mut Tally,
) -> u64 {
    let crossings = found.of(i);
    let mut region = found.starts[i];
    let mut clear = 0;
    for k in 0..=crossings.len() {
        let from = k.checked_sub(1).map(|k| crossings[k].t);
        let to = crossings.get(k).map(|c| c.t);
        let reported = medium_of(evaluator.program(), region);
        for t in samples(ray, from, to) {
            let probe = Probe { point: ray.at(t), origin: ray.origin.length() };
            let truth = medium(&model.regions, oracles, probe);
            clear += u64::from(truth.is_some());
            tally.check(truth.is_none_or(|truth| truth == reported), || {
                format!(
                    "seed {seed}, ray {i}: {ray:?} at t = {t} is in medium {truth:?}, not {reported}\n{model}\
                     start {:?}, crossings {}",
                    found.starts[i],
                    list(crossings)
                )
            });
        }
        // a crossing at t ~ 1e16, of a ray that rounding keeps from being parallel to a face, has an
        // arbitrary position
        let certain = |t: f64| t.abs() * ray.direction.length() < 1e6 * (1.0 + ray.origin.length());
        if let Some(crossing) = crossings.get(k).filter(|c| certain(c.t)) {
            let point = ray.at(crossing.t);
            let slack = 1e-9 * (1.0 + point.length() + ray.origin.length());
            let bounds = evaluator.program().bounds().grown(slack);
            tally.check(bounds.contains(point), || {
                format!("seed {seed}: {point} is not in {bounds:?}\n{model}")
            });
        }
        region = crossings.get(k).map_or(region, |c| c.after);
    }
    clear
}

fn medium_of(program: &Program, region: RegionId) -> u32 {
    program.medium_of(region)
}

/// Times in an open interval: its middle, and close to its ends. An unbounded end is replaced by one 100
/// lengths away.
fn samples(ray: &Ray, from: Option<f64>, to: Option<f64>) -> Vec<f64> {
    let unit = 1.0 / ray.direction.length();
    let closest = -ray.origin.dot(ray.direction) / ray.direction.length_squared();
    let (a, b) = match (from, to) {
        (Some(a), Some(b)) => (a, b),
        (Some(a), None) => (a, a.max(closest) + 100.0 * unit),
        (None, Some(b)) => (b.min(closest) - 100.0 * unit, b),
        (None, None) => (closest - 20.0 * unit, closest + 20.0 * unit),
    };
    let places = [0.5, 0.13, 0.29, 0.71, 0.88, 1e-2, 1.0 - 1e-2, 1e-4, 1.0 - 1e-4, 1e-7, 1.0 - 1e-7];
    let mut times: Vec<f64> = places.iter().map(|f| a + f * (b - a)).filter(|&t| a < t && t < b).collect();
    if from.is_none() && to.is_none() {
        times.extend((0..40).map(|k| closest + unit * 0.25 * (f64::from(k) - 19.7)));
    }
    times
}
