//! Differential test of several evaluators against one reference on the same rays, for large numbers of rays.
//!
//! Each ray is traced once with the reference. Every other evaluator has to return the same list, bit for
//! bit, and its first crossing for a query with that limit. A seed determines one model with [`RAYS`] rays
//! and nothing else, so a run may be interrupted anywhere, restarted, and distributed over threads and
//! machines.

use crate::exact::draw;
use crate::rays::{batch, rays};
use crate::{EvaluatorUnderTest, Maker, Model, Random, Style, list};
use rayweave_math::Affine;
use rayweave_model::{Collected, Crossing, Limit, Program, Query};
use rayweave_shape::Ray;
use std::ops::Range;
use std::sync::Arc;

/// Number of rays per model.
pub const RAYS: usize = 1000;

/// The result of one evaluator.
#[derive(Clone, Debug, Default)]
pub struct Score {
    /// The name of the evaluator.
    pub name: &'static str,
    /// Number of rays.
    pub rays: u64,
    /// Number of answers: one or two for each ray.
    pub answers: u64,
    /// Number of crossings in the lists of the reference.
    pub crossings: u64,
    /// Number of answers that differ from that of the reference in any bit.
    pub wrong: u64,
    /// Messages for the first few of these.
    pub messages: Vec<String>,
}

impl Score {
    /// Adds the score of the same evaluator on other models.
    pub fn add(&mut self, other: Score) {
        self.name = other.name;
        self.rays += other.rays;
        self.answers += other.answers;
        self.crossings += other.crossings;
        self.wrong += other.wrong;
        self.messages.extend(other.messages);
        self.messages.truncate(3);
    }

    /// Adds scores that are in the order of the evaluators.
    pub fn add_all(sums: &mut Vec<Score>, scores: Vec<Score>) {
        sums.resize_with(sums.len().max(scores.len()), Score::default);
        sums.iter_mut().zip(scores).for_each(|(sum, score)| sum.add(score));
    }
}

/// Runs the test on the models of a range of seeds; the scores are in the order of the evaluators.
pub fn compare(reference: &Maker, others: &[Maker], seeds: Range<u64>) -> Vec<Score> {
    let mut sums = Vec::new();
    for seed in seeds {
        let (program, rays) = setting(seed);
        // some models do not compile, those with two media in one place for example
        let Some(program) = program else { continue };
        let truth = reference(program.clone()).trace(batch(&rays).rays(), &Query::default());
        let scores = others.iter().map(|make| score(&*make(program.clone()), &rays, &truth, seed));
        Score::add_all(&mut sums, scores.collect());
    }
    sums
}

/// The model and the rays of a seed. Most models have a few leaves, some have many; half of the rays lie on
/// the grid on which faces, edges and axes coincide.
fn setting(seed: u64) -> (Option<Arc<Program>>, Vec<Ray>) {
    let mut rng = Random::new(3 << 40 | seed);
    if seed % 4 == 3 {
        let parts = draw::parts(&mut rng);
        let regions = crate::exact::regions(&parts, &Affine::IDENTITY);
        let rays = (0..RAYS).map(|_| draw::ray(&mut rng)).collect();
        return (Program::compile_regions(&regions).map(Arc::new).ok(), rays);
    }
    let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
    let model = match seed % 16 {
        0 => Model::random(&mut rng, style),
        _ => Model::small(&mut rng, style),
    };
    (model.compile().ok(), rays(&mut rng, style, &model.frame, RAYS))
}

fn score(evaluator: &dyn EvaluatorUnderTest, rays: &[Ray], truth: &Collected, seed: u64) -> Score {
    let count = rays.len() as u64;
    let crossings = truth.crossings.len() as u64;
    let mut score =
        Score { name: evaluator.name(), rays: count, answers: count, crossings, ..Score::default() };
    let found = evaluator.trace(batch(rays).rays(), &Query::default());
    compare_lists(&mut score, truth, &found, usize::MAX, rays, seed);
    if seed.is_multiple_of(5) {
        score.answers += count;
        let query = Query { limit: Limit::First, ..Query::default() };
        let found = evaluator.trace(batch(rays).rays(), &query);
        compare_lists(&mut score, truth, &found, 1, rays, seed);
    }
    score
}

/// Compares the first `most` crossings of each ray.
fn compare_lists(
    score: &mut Score,
    truth: &Collected,
    found: &Collected,
    most: usize,
    rays: &[Ray],
    seed: u64,
) {
    for (i, ray) in rays.iter().enumerate() {
        let expected = truth.of(i);
        let expected = &expected[..most.min(expected.len())];
        if found.starts[i] == truth.starts[i] && equal(found.of(i), expected) {
            continue;
        }
        score.wrong += 1;
        if score.messages.len() < 3 {
            let (ours, theirs) = (list(found.of(i)), list(expected));
            score.messages.push(format!(
                "seed {seed}, ray {i}: {ray:?}\n{} from {:?}{ours}\nreference from {:?}{theirs}",
                score.name, found.starts[i], truth.starts[i]
            ));
        }
    }
}

/// Bitwise equality of times: -0 differs from 0.
fn equal(a: &[Crossing], b: &[Crossing]) -> bool {
    a == b && a.iter().zip(b).all(|(a, b)| a.t.to_bits() == b.t.to_bits())
}
