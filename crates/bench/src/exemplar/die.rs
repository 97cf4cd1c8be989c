//! The die of five leaves: all crossings and first crossings, for coherent and incoherent rays, and
//! for a single ray.

use super::{Bench, Exemplar, question, text};
use crate::answer::{Agreement, Lists, first_lists, full_lists};
use crate::batch::{coherent, incoherent};
use crate::ceiling::Need;
use crate::interleaved::{Candidate, Outcome, Role, measure_in_turn};
use crate::kernel::die::{self as kernel, BORE, First, HALF, SPHERE};
use crate::kernel::lanes::{Counted, Tally};
use crate::level;
use crate::report::Section;
use fearless_simd::Level;
use rayweave::model::{HitArrayRows, RayBatch, Rays};
use rayweave::shapes::{box_, cylinder, sphere};
use rayweave::{AnyEvaluator, Error, Evaluator, Program, Reference, Solid, Window};
use std::sync::Arc;

pub use crate::kernel::die::ROWS;

/// Rays per batch: inputs and results fit into the last-level cache, but not into the others.
const RAYS: usize = 1 << 17;

/// The number of rays whose results are compared.
const COMPARED: usize = 4096;

/// The die: a box with rounded corners and bores along the three axes.
pub fn solid() -> Result<Solid, Error> {
    let core = box_([2.0 * HALF; 3])? & sphere(SPHERE)?;
    let bore = cylinder(BORE, f64::INFINITY)?;
    Ok(core - bore.rotate_y(90.0) - bore.rotate_x(90.0) - bore)
}

/// The die, compiled.
pub fn program() -> Result<Program, Error> {
    Ok(Program::compile(&solid()?)?)
}

/// The kind of query.
#[derive(Clone, Copy, PartialEq)]
enum QueryKind {
    Full,
    First,
}

/// One kind of query on one kind of rays.
struct Die {
    name: &'static str,
    about: &'static str,
    query: QueryKind,
    is_coherent: bool,
}

/// All queries on the die.
pub fn all() -> Vec<Box<dyn Exemplar>> {
    let of = |name, query, is_coherent, about: &'static str| -> Box<dyn Exemplar> {
        Box::new(Die { name, about, query, is_coherent })
    };
    vec![
        of(
            "die/full/incoherent",
            QueryKind::Full,
            false,
            "Every crossing with the die (box & sphere) - three cylinders, with its face, into hit arrays; rays from random \
             points on a sphere of radius 5 to random points in the box: 2.73 crossings per ray.",
        ),
        of(
            "die/full/coherent",
            QueryKind::Full,
            true,
            "Every crossing with the die, with its face; rays of the pixels of a picture, row by row.",
        ),
        of(
            "die/first/incoherent",
            QueryKind::First,
            false,
            "The first crossing with the die, with its face and its normal; rays from a sphere to the box.",
        ),
        of(
            "die/first/coherent",
            QueryKind::First,
            true,
            "The first crossing with the die, with its face and its normal; rays of the pixels of a picture.",
        ),
        Box::new(Single),
    ]
}

/// All evaluators of the program.
pub fn evaluators(program: &Arc<Program>) -> Result<Vec<AnyEvaluator>, String> {
    let one = |name: &&str| AnyEvaluator::new(Some(name), program.clone()).map_err(text);
    AnyEvaluator::NAMES.iter().map(one).collect()
}

impl Exemplar for Die {
    fn name(&self) -> &str {
        self.name
    }

    fn about(&self) -> &str {
        self.about
    }

    fn measure(&self, bench: &Bench) -> Result<Vec<Section>, String> {
        let program = Arc::new(program().map_err(text)?);
        let evaluators = evaluators(&program)?;
        let count = bench.effort.size(RAYS);
        let batch = match self.is_coherent {
            true => coherent(count).map_err(text)?,
            false => incoherent(count, 1),
        };
        let rays = batch.rays();
        let (file, task) = (self.name.replace('/', "-"), self.task());
        bench.peers.give_rays(&file, rays).map_err(text)?;
        let mut candidates = self.ours(&evaluators, rays)?;
        candidates.extend(bench.levels.iter().map(|&level| self.by_hand(level, rays)));
        candidates.extend(bench.peers.candidates(task, &file, rays.len()));
        let outcomes = measure_in_turn(candidates, &bench.effort);
        let mut section = Section::new(self.name, "ray", self.about);
        let best = best_kernel(&outcomes);
        section.take(outcomes, |outcome| {
            bench.floor(self.needs(bench, outcome, best).as_slice(), outcome.threads)
        });
        self.compare(&mut section, bench, &evaluators, &batch, &file)?;
        Ok(vec![section])
    }
}

impl Die {
    fn task(&self) -> &'static str {
        match self.query {
            QueryKind::Full => "die.full",
            QueryKind::First => "die.first",
        }
    }

    fn ours<'a>(&self, evaluators: &'a [AnyEvaluator], rays: Rays<'a>) -> Result<Vec<Candidate<'a>>, String> {
        let one = |evaluator: &'a AnyEvaluator| match self.query {
            QueryKind::Full => Ok(question::full(evaluator.name(), evaluator, rays, ROWS)),
            QueryKind::First => question::first(evaluator.name(), evaluator, rays),
        };
        evaluators.iter().map(one).collect()
    }

    fn by_hand<'a>(&self, level: Level, rays: Rays<'a>) -> Candidate<'a> {
        match self.query {
            QueryKind::Full => full_by_hand(level, rays),
            QueryKind::First => first_by_hand(level, rays),
        }
    }

    /// The limits per ray: for kernels the operations (a batch fits into the last-level cache), for
    /// all others the time of the best kernel.
    fn needs(&self, bench: &Bench, outcome: &Outcome, best: Option<f64>) -> Option<Need> {
        match outcome.role {
            Role::Ceiling => {
                let level = bench.levels.iter().find(|&&level| kernel_name(level) == outcome.name);
                Some(operations(self.query, level.copied()))
            }
            Role::Ours | Role::Peer => best.map(Need::Kernel),
        }
    }

    fn lists<E: Evaluator>(&self, evaluator: &E, rays: Rays<'_>) -> Result<Lists, String> {
        match self.query {
            QueryKind::Full => Ok(full_lists(evaluator, rays)),
            QueryKind::First => first_lists(evaluator, rays).map_err(text),
        }
    }

    fn compare(
        &self,
        section: &mut Section,
        bench: &Bench,
        evaluators: &[AnyEvaluator],
        batch: &RayBatch,
        file: &str,
    ) -> Result<(), String> {
        let few: RayBatch = (0..COMPARED.min(batch.rays().len())).map(|i| batch.rays().get(i)).collect();
        let reference = Reference::new(Arc::new(program().map_err(text)?));
        let expected = self.lists(&reference, few.rays())?;
        for evaluator in evaluators {
            let found = self.lists(evaluator, few.rays())?;
            section.agree(evaluator.name(), Ok(Agreement::of(&expected, &found)));
        }
        for (name, answer) in bench.peers.answers(self.task(), file, few.rays().len()) {
            section.agree(&name, answer.map(|found| Agreement::of(&expected, &found)));
        }
        Ok(())
    }
}

/// The time of the fastest hand-written kernel.
fn best_kernel(outcomes: &[Outcome]) -> Option<f64> {
    let kernels = outcomes.iter().filter(|outcome| outcome.role == Role::Ceiling);
    let times = kernels.filter_map(|outcome| Some(outcome.times.as_ref().ok()?.median));
    times.min_by(f64::total_cmp)
}

/// The operations of the kernel per ray, by running it with lanes that count.
fn operations(query: QueryKind, level: Option<Level>) -> Need {
    let (tally, count) = (Tally::default(), 64);
    let batch = incoherent(count, 1);
    let zero = Counted::zero(&tally);
    match query {
        QueryKind::Full => {
            let mut table = Rows::new(count);
            let (mut times, mut faces) = table.rows();
            kernel::all(zero, &batch.rays(), &mut times, &mut faces);
        }
        QueryKind::First => kernel::first_of_all(zero, &batch.rays(), &mut Columns::new(count).first()),
    }
    let each = |operations: u64| operations as f64 / count as f64;
    let (simple, divisions, roots) = (tally.simple(), tally.divisions(), tally.roots());
    Need::Operations { simple: each(simple), divisions: each(divisions), roots: each(roots), level }
}

/// Buffers for the full lists of the kernel.
struct Rows {
    times: Vec<f64>,
    faces: Vec<i32>,
    columns: usize,
}

impl Rows {
    fn new(columns: usize) -> Rows {
        Rows { times: vec![0.0; ROWS * columns], faces: vec![0; ROWS * columns], columns }
    }

    fn rows(&mut self) -> ([&mut [f64]; ROWS], [&mut [i32]; ROWS]) {
        let mut times = self.times.chunks_mut(self.columns);
        let mut faces = self.faces.chunks_mut(self.columns);
        let times = std::array::from_fn(|_| times.next().unwrap_or_default());
        (times, std::array::from_fn(|_| faces.next().unwrap_or_default()))
    }
}

/// Buffers for the first hits of the kernel.
struct Columns {
    t: Vec<f64>,
    face: Vec<i32>,
    normal: [Vec<f64>; 3],
}

impl Columns {
    fn new(count: usize) -> Columns {
        let numbers = || vec![0.0; count];
        Columns { t: numbers(), face: vec![0; count], normal: [numbers(), numbers(), numbers()] }
    }

    fn first(&mut self) -> First<'_> {
        let [x, y, z] = &mut self.normal;
        First { t: &mut self.t, face: &mut self.face, normal: [x, y, z] }
    }
}

fn full_by_hand(level: Level, rays: Rays<'_>) -> Candidate<'_> {
    let mut table = Rows::new(rays.len());
    Candidate::here(kernel_name(level), Role::Ceiling, rays.len(), move || {
        let (mut times, mut faces) = table.rows();
        kernel::crossings(level, &rays, &mut times, &mut faces);
    })
}

fn first_by_hand(level: Level, rays: Rays<'_>) -> Candidate<'_> {
    let mut columns = Columns::new(rays.len());
    Candidate::here(kernel_name(level), Role::Ceiling, rays.len(), move || {
        kernel::first(level, &rays, &mut columns.first());
    })
}

fn kernel_name(level: Level) -> String {
    format!("by hand, {}", level::name(level))
}

/// Queries of a single ray.
struct Single;

/// The number of different rays, so that branch predictors cannot learn them.
const TURNS: usize = 1024;

impl Exemplar for Single {
    fn name(&self) -> &'static str {
        "die/single"
    }

    fn about(&self) -> &'static str {
        "Every crossing of one ray with the die, one call per ray; by hand: one kernel step, which always processes \
         a full vector of rays, so that a single ray gains nothing."
    }

    fn measure(&self, bench: &Bench) -> Result<Vec<Section>, String> {
        let evaluators = evaluators(&Arc::new(program().map_err(text)?))?;
        let batches: Vec<RayBatch> = (0..TURNS).map(|i| incoherent(1, i as u64)).collect();
        let steps: Vec<RayBatch> = (0..TURNS).map(|i| incoherent(16, i as u64)).collect();
        let mut candidates: Vec<Candidate<'_>> =
            evaluators.iter().map(|evaluator| one_by_one(evaluator, &batches)).collect();
        candidates.extend(bench.levels.iter().map(|&level| step_by_step(level, &steps)));
        let outcomes = measure_in_turn(candidates, &bench.effort);
        let mut section = Section::new(self.name(), "ray", self.about());
        let best = best_kernel(&outcomes).map(Need::Kernel);
        section.take(outcomes, |outcome| bench.floor(best.as_slice(), outcome.threads));
        Ok(vec![section])
    }
}

fn one_by_one<'a>(evaluator: &'a AnyEvaluator, batches: &'a [RayBatch]) -> Candidate<'a> {
    let (mut scratch, mut times, mut faces) = (evaluator.scratch(), [[0.0]; ROWS], [[0]; ROWS]);
    Candidate::here(evaluator.name(), Role::Ours, batches.len(), move || {
        let mut times = times.each_mut().map(|row| &mut row[..]);
        let mut faces = faces.each_mut().map(|row| &mut row[..]);
        for batch in batches {
            let mut rows = HitArrayRows { times: &mut times, faces: &mut faces };
            evaluator.hits(batch.rays(), Window::ALL, &mut scratch, &mut rows);
        }
    })
}

fn step_by_step<'a>(level: Level, batches: &'a [RayBatch]) -> Candidate<'a> {
    let mut table = Rows::new(16);
    let steps = batches.len() * 16 / level_lanes(level);
    Candidate::here(kernel_name(level), Role::Ceiling, steps, move || {
        let (mut times, mut faces) = table.rows();
        batches.iter().for_each(|batch| kernel::crossings(level, &batch.rays(), &mut times, &mut faces));
    })
}

/// Rays per step of the kernel.
fn level_lanes(level: Level) -> usize {
    use crate::kernel::lanes::{Lanes, Native};
    fn count<L: Lanes>(_: L) -> usize {
        L::COUNT
    }
    fearless_simd::dispatch!(level, simd => count(Native::zero(simd)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_a_ray_are_as_is_said() {
        let batch = incoherent(4096, 11);
        let weave = AnyEvaluator::new(None, Arc::new(program().unwrap())).unwrap();
        let lists = full_lists(&weave, batch.rays());
        let mean = lists.iter().map(Vec::len).sum::<usize>() as f64 / 4096.0;
        assert!((mean - 2.7346).abs() < 0.06, "{mean}");
        assert!(lists.iter().all(|list| list.len() <= ROWS));
        // no ray starts inside, and the die is ahead of all rays
        let first = first_lists(&weave, batch.rays()).unwrap();
        assert!(first.iter().zip(&lists).all(|(first, all)| first.first() == all.first()));
    }

    #[test]
    fn the_kernel_needs_its_roots_and_divisions() {
        let Need::Operations { simple, divisions, roots, .. } = operations(QueryKind::Full, None) else {
            panic!("operations are counted");
        };
        assert_eq!((divisions, roots), (7.0, 4.0));
        assert!((100.0..1000.0).contains(&simple), "{simple}");
    }
}
