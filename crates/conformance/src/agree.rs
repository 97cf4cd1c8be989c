//! Differential test of an evaluator against the reference: equal answers to every query, bit for bit.

use crate::rays::{batch, rays};
use crate::{Effort, Model, Random, Style, Tally, list};
use rayweave_math::Vec3;
use rayweave_model::{Collected, Crossing, Evaluator, Limit, Program, Query, RegionId, Window};
use rayweave_shape::Ray;
use std::sync::Arc;

/// Random models and rays of all styles: all crossings, windows, repeated queries for the nearest crossing,
/// regions at the start and at points; one ray at a time and in batches, with a used scratch.
pub fn with_the_reference<E: Evaluator, R: Evaluator>(
    make: impl Fn(Arc<Program>) -> E,
    reference: impl Fn(Arc<Program>) -> R,
    effort: Effort,
) {
    let (models, count) = effort.models_and_rays();
    let mut tally = Tally::new("answers equal to those of the reference");
    let mut crossings = 0;
    for seed in 0..models {
        let mut rng = Random::new(seed);
        let style = [Style::Generic, Style::Grid, Style::Grid, Style::Planes][seed as usize % 4];
        let model = Model::random(&mut rng, style);
        let program = model.compiled();
        let rays = rays(&mut rng, style, &model.frame, count);
        let pair = Pair { seed, model: &model, ours: make(program.clone()), theirs: reference(program) };
        crossings += pair.all(&rays, &mut tally);
        pair.windows(&rays, &mut rng, &mut tally);
        pair.nearest(&rays, &mut rng, &mut tally);
        pair.points(&rays, &mut rng, &mut tally);
    }
    assert!(crossings > models as usize * count, "the rays miss too much: {crossings} crossings");
    tally.finish(models * count as u64);
}

struct Pair<'m, E, R> {
    seed: u64,
    model: &'m Model,
    ours: E,
    theirs: R,
}

impl<E: Evaluator, R: Evaluator> Pair<'_, E, R> {
    fn compare(&self, rays: &[Ray], query: &Query<'_>, tally: &mut Tally) -> Collected {
        let rays_in = batch(rays);
        let ours = self.ours.collect(rays_in.rays(), query).unwrap();
        let theirs = self.theirs.collect(rays_in.rays(), query).unwrap();
        for (i, ray) in rays.iter().enumerate() {
            let equal = ours.starts[i] == theirs.starts[i] && ours.of(i) == theirs.of(i);
            tally.check(equal, || {
                format!(
                    "seed {}, ray {i}: {ray:?}, {query:?}\n{}{} {:?} {}\n{} {:?} {}",
                    self.seed,
                    self.model,
                    self.ours.name(),
                    ours.starts[i],
                    list(ours.of(i)),
                    self.theirs.name(),
                    theirs.starts[i],
                    list(theirs.of(i)),
                )
            });
        }
        theirs
    }

    fn all(&self, rays: &[Ray], tally: &mut Tally) -> usize {
        let query = Query::default();
        let found = self.compare(rays, &query, tally);
        // one by one, with a scratch that was used for other rays in between
        let mut scratch = self.ours.scratch();
        for (i, &ray) in rays.iter().enumerate().step_by(17) {
            let mut again = Collected::default();
            self.ours.crossings(batch(&[ray]).rays(), &query, &mut scratch, &mut again);
            let equal = again.starts[0] == found.starts[i] && again.of(0) == found.of(i);
            tally.check(equal, || {
                format!("seed {}: ray {i} alone differs from ray {i} in a batch", self.seed)
            });
        }
        found.crossings.len()
    }

    fn windows(&self, rays: &[Ray], rng: &mut Random, tally: &mut Tally) {
        for chunk in rays.chunks(25) {
            let lists = self.theirs.collect(batch(chunk).rays(), &Query::default()).unwrap();
            let mut bound = || match rng.below(4) {
                0 => f64::NEG_INFINITY,
                1 if !lists.crossings.is_empty() => lists.crossings[rng.below(lists.crossings.len())].t,
                2 => f64::INFINITY,
                _ => rng.between(-10.0, 10.0),
            };
            let (a, b) = (bound(), bound());
            let Ok(window) = Window::new(a.min(b), a.max(b)) else { continue };
            let found = self.compare(chunk, &Query { window, ..Query::default() }, tally);
            let within = |c: &Crossing| window.t_min() < c.t && c.t < window.t_max();
            tally.check(found.crossings.iter().all(within), || {
                format!("seed {}: outside {window:?}", self.seed)
            });
        }
    }

    /// `nearest` returns the first crossing after t_min, and repeated queries from its t return the others in
    /// turn.
    fn nearest(&self, rays: &[Ray], rng: &mut Random, tally: &mut Tally) {
        let mut scratch = self.ours.scratch();
        for (i, &ray) in rays.iter().enumerate().step_by(7) {
            let mut t_min = rng.pick(&[f64::NEG_INFINITY, 0.0, -1.0, 2.5]);
            let rest = Query { window: beyond(t_min), ..Query::default() };
            let whole = self.theirs.one(ray, &rest).unwrap();
            let mut steps = Vec::new();
            loop {
                let query = Query { window: beyond(t_min), limit: Limit::First, starts: None };
                let mut next = Collected::default();
                self.ours.crossings(batch(&[ray]).rays(), &query, &mut scratch, &mut next);
                let Some(&crossing) = next.crossings.first() else { break };
                steps.push(crossing);
                t_min = crossing.t;
                if next.crossings.len() > 1 || steps.len() > whole.crossings.len() {
                    break;
                }
            }
            tally.check(steps == whole.crossings, || {
                format!(
                    "seed {}, ray {i}: {ray:?} step by step\n{}{}\nwhole {}",
                    self.seed,
                    self.model,
                    list(&steps),
                    list(&whole.crossings)
                )
            });
        }
    }

    fn points(&self, rays: &[Ray], rng: &mut Random, tally: &mut Tally) {
        let grid = |rng: &mut Random| 0.25 * (rng.below(25) as f64 - 12.0);
        let points: Vec<Vec3> = (0..rays.len())
            .map(|k| match k % 3 {
                0 => rng.point(3.0),
                1 => self.model.frame.point(Vec3::new(grid(rng), grid(rng), grid(rng))),
                _ => rays[k].at(rng.between(-5.0, 5.0)),
            })
            .filter(|p| p.is_finite())
            .collect();
        let column = |k: usize| points.iter().map(|p| p[k]).collect::<Vec<f64>>();
        let (x, y, z) = (column(0), column(1), column(2));
        let mut ours = vec![RegionId(u32::MAX); points.len()];
        let mut theirs = ours.clone();
        self.ours.regions_at([&x, &y, &z], &mut self.ours.scratch(), &mut ours);
        self.theirs.regions_at([&x, &y, &z], &mut self.theirs.scratch(), &mut theirs);
        for (k, point) in points.iter().enumerate() {
            tally.check(ours[k] == theirs[k], || {
                format!(
                    "seed {}: {point} is in {:?}, not {:?}\n{}",
                    self.seed, ours[k], theirs[k], self.model
                )
            });
        }
        let inside = theirs.first().is_some_and(|&region| region != RegionId(0));
        tally.check(self.ours.contains(points[0]) == Ok(inside), || format!("seed {}: contains", self.seed));
    }
}

/// The window of all times after `t_min`.
pub(crate) fn beyond(t_min: f64) -> Window {
    Window::new(t_min, f64::INFINITY).unwrap_or(Window::ALL)
}
