//! Test of [`ApproximateEvaluator`]s, whose answers have error bounds or are marked uncertain, against an
//! exact one.

use crate::rays::{batch, rays};
use crate::{Effort, Model, Random, Style};
use rayweave_model::{
    ApproximateColumns, ApproximateEvaluator, CrossingColumns, Evaluator, Program, Query, Rays, Window,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The result of a test of an approximate evaluator.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// The number of rays.
    pub rays: u64,
    /// Rays that the evaluator marked as uncertain, which are not compared.
    pub uncertain: u64,
    /// Crossings of the certain rays, in the answers of the exact evaluator.
    pub crossings: u64,
    /// Rays whose certain answer violates the contract.
    pub wrong: u64,
    /// The greatest difference between a time and the exact one.
    pub greatest_error: f64,
    /// The greatest error bound.
    pub greatest_bound: f64,
    /// The violations of the contract by kind, each with its first failure.
    pub failures: BTreeMap<&'static str, String>,
}

impl Verdict {
    /// The share of uncertain rays, 0 to 1.
    pub fn uncertain_share(&self) -> f64 {
        self.uncertain as f64 / self.rays.max(1) as f64
    }

    /// Fails unless every certain answer satisfies the contract and at most this share of the rays is
    /// uncertain.
    ///
    /// # Panics
    ///
    /// With the first failure of each kind.
    pub fn check(&self, most_uncertain: f64) {
        let share = self.uncertain_share();
        let Verdict { wrong, rays, failures, .. } = self;
        assert!(*wrong == 0, "{wrong} of {rays} rays are wrong: {failures:#?}");
        assert!(share <= most_uncertain, "{:.3} % of the rays are uncertain", 100.0 * share);
    }

    /// Adds the result of another test.
    pub fn add(&mut self, other: Verdict) {
        self.rays += other.rays;
        self.uncertain += other.uncertain;
        self.crossings += other.crossings;
        self.wrong += other.wrong;
        self.greatest_error = self.greatest_error.max(other.greatest_error);
        self.greatest_bound = self.greatest_bound.max(other.greatest_bound);
        for (what, failure) in other.failures {
            self.failures.entry(what).or_insert(failure);
        }
    }
}

/// Compares an approximate evaluator with an exact one on random models of all styles.
pub fn against<A: ApproximateEvaluator, E: Evaluator>(
    make: impl Fn(Arc<Program>) -> A,
    exact: impl Fn(Arc<Program>) -> E,
    effort: Effort,
) -> Verdict {
    let (models, rays) = effort.models_and_rays();
    let mut verdict = Verdict::default();
    (0..models).for_each(|seed| verdict.add(on_model(&make, &exact, seed, rays)));
    verdict
}

/// Like [`against`], on the model of one seed: whole lines, a window, first crossings.
pub fn on_model<A: ApproximateEvaluator, E: Evaluator>(
    make: impl Fn(Arc<Program>) -> A,
    exact: impl Fn(Arc<Program>) -> E,
    seed: u64,
    count: usize,
) -> Verdict {
    let mut rng = Random::new(seed);
    let style = [Style::Generic, Style::Grid, Style::Generic, Style::Planes][seed as usize % 4];
    let model = Model::random(&mut rng, style);
    let program = model.compiled();
    let rays = batch(&rays(&mut rng, style, &model.frame, count));
    let (ours, theirs) = (make(program.clone()), exact(program));
    let window = Window::new(rng.between(-3.0, 0.0), rng.between(0.5, 4.0)).unwrap_or(Window::ALL);
    let mut verdict = Verdict::default();
    for query in [Query::default(), Query { window, ..Query::default() }, Query::nearest()] {
        let mut one = check_bounds(&ours, &theirs, rays.rays(), &query);
        one.failures.values_mut().for_each(|failure| *failure = format!("seed {seed}, {query:?}, {failure}"));
        verdict.add(one);
    }
    verdict
}

/// Compares the answers to one query for one batch.
pub fn check_bounds<A: ApproximateEvaluator, E: Evaluator>(
    approximate: &A,
    exact: &E,
    rays: Rays<'_>,
    query: &Query<'_>,
) -> Verdict {
    let (mut ours, mut theirs) = (ApproximateColumns::default(), CrossingColumns::default());
    approximate.columns(rays, query, &mut approximate.scratch(), &mut ours);
    exact.columns(rays, query, &mut exact.scratch(), &mut theirs);
    let mut verdict = Verdict { rays: rays.len() as u64, ..Verdict::default() };
    if !is_complete(&ours, rays.len()) {
        verdict.wrong = verdict.rays;
        verdict.failures.insert("columns whose length differs from the batch", String::new());
        return verdict;
    }
    for ray in 0..rays.len() {
        if ours.uncertain[ray] {
            verdict.uncertain += 1;
            continue;
        }
        let pair = Pair { program: exact.program(), ours: &ours, theirs: &theirs, ray };
        verdict.crossings += theirs.rows_of(ray).len() as u64;
        match pair.compare() {
            Ok([error, bound]) => {
                verdict.greatest_error = verdict.greatest_error.max(error);
                verdict.greatest_bound = verdict.greatest_bound.max(bound);
            }
            Err(what) => {
                verdict.wrong += 1;
                let names = [approximate.name(), exact.name()];
                verdict.failures.entry(what).or_insert_with(|| pair.lists(names));
            }
        }
    }
    verdict
}

/// True if every column has the right length and the rows of consecutive rays are adjacent.
fn is_complete(columns: &ApproximateColumns, rays: usize) -> bool {
    let ApproximateColumns { crossings, bound, uncertain } = columns;
    let rows = crossings.rows();
    let per_row = [
        bound.len(),
        crossings.face.len(),
        crossings.leaf.len(),
        crossings.placement.len(),
        crossings.enters.len(),
        crossings.before.len(),
        crossings.after.len(),
    ];
    crossings.rays() == rays
        && uncertain.len() == rays
        && crossings.offsets.len() == rays + 1
        && crossings.offsets.is_sorted()
        && crossings.offsets[0] == 0
        && crossings.offsets[rays] == rows
        && per_row.iter().all(|&len| len == rows)
}

/// The contents of a row other than its time.
fn identity(columns: &CrossingColumns, row: usize) -> ([u32; 5], bool) {
    let numbers = [&columns.face, &columns.leaf, &columns.placement, &columns.before, &columns.after];
    (numbers.map(|column| column[row]), columns.enters[row])
}

/// The two answers for one ray.
struct Pair<'a> {
    program: &'a Program,
    ours: &'a ApproximateColumns,
    theirs: &'a CrossingColumns,
    ray: usize,
}

impl Pair<'_> {
    /// The greatest error and the greatest bound of a ray, or the violation of the contract.
    fn compare(&self) -> Result<[f64; 2], &'static str> {
        let (ours, theirs, ray) = (&self.ours.crossings, self.theirs, self.ray);
        if ours.start[ray] != theirs.start[ray] {
            return Err("a different region at the start");
        }
        if ours.rows_of(ray).len() != theirs.rows_of(ray).len() {
            return Err("a different number of crossings");
        }
        let mut greatest = [0.0f64; 2];
        for (row, exact_row) in ours.rows_of(ray).zip(theirs.rows_of(ray)) {
            if identity(ours, row) != identity(theirs, exact_row) {
                return Err("a different face or region");
            }
            let (own, exact) = (ours.crossing(self.program, row), theirs.crossing(self.program, exact_row));
            if (own.left, own.entered) != (exact.left, exact.entered) {
                return Err("a different face on one of the sides");
            }
            let (error, bound) = ((ours.t[row] - exact.t).abs(), self.ours.bound[row]);
            if !(bound.is_finite() && bound >= 0.0) {
                return Err("a bound that is infinite, NaN or below 0");
            }
            // NaN is wrong too
            if error.is_nan() || error > bound {
                return Err("a time farther from the exact one than its bound");
            }
            greatest = [greatest[0].max(error), greatest[1].max(bound)];
        }
        Ok(greatest)
    }

    /// Both answers as text, one crossing per line. Ids of the evaluator under test may be out of range.
    fn lists(&self, names: [&str; 2]) -> String {
        let line = |columns: &CrossingColumns, row: usize| {
            let ([face, leaf, placement, before, after], enters) = identity(columns, row);
            let t = columns.t[row];
            format!("\n  t = {t:?}: {before} -> {after} ({enters}) at face {face} of leaf {leaf}@{placement}")
        };
        let (ours, theirs, ray) = (&self.ours.crossings, self.theirs, self.ray);
        let own: String = ours.rows_of(ray).map(|row| line(ours, row)).collect();
        let exact: String = theirs.rows_of(ray).map(|row| line(theirs, row)).collect();
        let bounds = &self.ours.bound[ours.rows_of(ray)];
        let [name, exact_name] = names;
        let starts = [ours.start[ray], theirs.start[ray]];
        format!("ray {ray}, starts {starts:?}\n{name}, bounds {bounds:?}{own}\n{exact_name}{exact}")
    }
}
