//! Comparison of two evaluators on every kind of query.

use fearless_simd::Level;
use rayweave_conformance::rays::batch;
use rayweave_conformance::{Random, Tally};
use rayweave_model::{
    Collected, Crossing, Evaluator, FirstHits, HitArrayRows, Limit, Program, Query, Rays, Region, RegionId,
    Window,
};
use rayweave_shape::Ray;
use rayweave_trace::{Packets, Reference};
use std::sync::Arc;

/// The SIMD instruction sets of this machine, best first. The last one is the baseline, for which x86 has no kernels in lanes.
pub fn levels() -> Vec<Level> {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    let narrower = best.as_avx2().map(Level::Avx2);
    #[cfg(not(target_arch = "x86_64"))]
    let narrower = None;
    [Some(best), narrower, Some(Level::baseline())].into_iter().flatten().collect()
}

/// A model that is traced in lanes, and rays.
pub struct Setting {
    program: Arc<Program>,
    regions: Vec<Region>,
    pub rays: Vec<Ray>,
    name: String,
}

impl Setting {
    /// `None` if the model does not compile or is not traced in lanes.
    pub fn new(regions: Vec<Region>, rays: Vec<Ray>, name: String) -> Option<Setting> {
        let program = Arc::new(Program::compile_regions(&regions).ok()?);
        let for_lanes = Packets::new(program.clone()).uses_lanes();
        for_lanes.then_some(Setting { program, regions, rays, name })
    }

    pub fn program(&self) -> &Program {
        &self.program
    }

    pub fn describe(&self, i: usize) -> String {
        let solid = |r: &Region| format!("\n  medium {}: {}", r.medium, r.solid);
        let regions: String = self.regions.iter().map(solid).collect();
        format!("{}, ray {i}: {:?}{regions}", self.name, self.rays[i])
    }
}

/// All answers about one ray; numbers as bits, so that -0 differs from 0 and NaN equals itself.
#[derive(Clone, Debug, Default, PartialEq)]
struct Answer {
    start: u32,
    all: Vec<(u64, Crossing)>,
    first: Vec<(u64, Crossing)>,
    times: Vec<u64>,
    faces: Vec<i32>,
    /// Time and components of the normal.
    nearest: [u64; 4],
    /// Face, placement, regions before and after.
    nearest_at: [i64; 4],
}

/// Counts of compared answers and crossings.
pub struct Oracle {
    tally: Tally,
    crossings: usize,
}

impl Oracle {
    pub fn new(what: &'static str) -> Oracle {
        Oracle { tally: Tally::new(what), crossings: 0 }
    }

    /// Panics if any answer differs, if fewer than `least` rays were compared, or if there is at most one
    /// crossing per two rays.
    pub fn finish(self, least: u64) {
        let rays = self.tally.checked() as usize;
        self.tally.finish(least);
        assert!(2 * self.crossings > rays, "only {} crossings on {rays} rays", self.crossings);
    }

    /// Compares every kind of query in several windows, with a random instruction set and number of rows.
    pub fn everything(&mut self, setting: &Setting, rng: &mut Random, levels: &[Level]) {
        let truth = Reference::new(setting.program.clone());
        let lists = lists(&truth, &setting.rays, &Query::default());
        for window in windows(&lists.crossings, rng) {
            let (rows, size) = (rng.below(12), rng.pick(&[setting.rays.len(), 8, 13]));
            let questions = Questions { window, rows, size };
            let level = rng.pick(levels);
            self.compare(setting, &questions, &[level]);
        }
    }

    /// Compares on the whole line, in batches of a given size.
    pub fn in_batches(&mut self, setting: &Setting, size: usize, levels: &[Level]) {
        for rows in [2, 16] {
            self.compare(setting, &Questions { window: Window::ALL, rows, size }, levels);
        }
    }

    /// Compares lists of all crossings and first crossings in one window: for many rays.
    pub fn lists(&mut self, setting: &Setting, rng: &mut Random) {
        let level = rng.pick(&levels());
        let (truth, packets) = evaluators(setting, level);
        let t = if rng.chance(0.5) { f64::NEG_INFINITY } else { rng.between(-3.0, 3.0) };
        let Ok(window) = Window::new(t, f64::INFINITY) else { return };
        let all = lists(&truth, &setting.rays, &Query { window, ..Query::default() });
        let found = lists(&packets, &setting.rays, &Query { window, ..Query::default() });
        let first = lists(&packets, &setting.rays, &Query { window, limit: Limit::First, starts: None });
        self.crossings += all.crossings.len();
        for i in 0..setting.rays.len() {
            let expected = all.of(i);
            let head = &expected[..expected.len().min(1)];
            let starts = all.starts[i] == found.starts[i] && all.starts[i] == first.starts[i];
            let equal = starts && bits(found.of(i)) == bits(expected) && bits(first.of(i)) == bits(head);
            self.tally.check(equal, || {
                let context = setting.describe(i);
                format!(
                    "{context}\n{level:?}, {window:?}\nfound {:?}\n{:?}\nnot {expected:?}",
                    found.of(i),
                    first.of(i)
                )
            });
        }
    }

    fn compare(&mut self, setting: &Setting, questions: &Questions, levels: &[Level]) {
        let truth = answers(&Reference::new(setting.program.clone()), &setting.rays, questions);
        for &level in levels {
            let packets = Packets::with_level(setting.program.clone(), level);
            let found = answers(&packets, &setting.rays, questions);
            let context = || format!("{level:?}, {questions:?}, a batch from {}", setting.describe(0));
            self.tally.check(found.most == truth.most, context);
            for (i, (found, expected)) in found.rays.iter().zip(&truth.rays).enumerate() {
                self.crossings += expected.all.len();
                self.tally.check(found == expected, || {
                    let context = setting.describe(i);
                    format!("{context}\n{level:?}, {questions:?}\nfound {found:?}\nnot {expected:?}")
                });
            }
        }
    }
}

pub fn evaluators(setting: &Setting, level: Level) -> (Reference, Packets) {
    (Reference::new(setting.program.clone()), Packets::with_level(setting.program.clone(), level))
}

pub fn bits(crossings: &[Crossing]) -> Vec<(u64, Crossing)> {
    crossings.iter().map(|crossing| (crossing.t.to_bits(), *crossing)).collect()
}

pub fn lists<E: Evaluator>(evaluator: &E, rays: &[Ray], query: &Query<'_>) -> Collected {
    let mut found = Collected::default();
    evaluator.crossings(batch(rays).rays(), query, &mut evaluator.scratch(), &mut found);
    found
}

/// The whole line, half lines and an interval; most bounds are times of crossings.
fn windows(crossings: &[Crossing], rng: &mut Random) -> Vec<Window> {
    let mut time = || match crossings {
        [_, ..] if rng.chance(0.7) => crossings[rng.below(crossings.len())].t,
        _ => rng.between(-4.0, 4.0),
    };
    let (a, b) = (time(), time());
    let ends = [(f64::NEG_INFINITY, f64::INFINITY), (0.0, f64::INFINITY), (a, f64::INFINITY)];
    let more = [(f64::NEG_INFINITY, b), (a.min(b), a.max(b))];
    ends.into_iter().chain(more).filter_map(|(from, to)| Window::new(from, to).ok()).collect()
}

#[derive(Clone, Copy, Debug)]
struct Questions {
    window: Window,
    /// Rows of the hit arrays.
    rows: usize,
    /// Rays per batch.
    size: usize,
}

/// The answers about all rays.
struct Answers {
    rays: Vec<Answer>,
    /// For each batch, the largest number of entries of a ray.
    most: Vec<usize>,
}

fn answers<E: Evaluator>(evaluator: &E, rays: &[Ray], questions: &Questions) -> Answers {
    let mut scratch = evaluator.scratch();
    let mut all = Answers { rays: Vec::new(), most: Vec::new() };
    for rays in rays.chunks(questions.size) {
        let mut answers = vec![Answer::default(); rays.len()];
        let batch = batch(rays);
        by_lists(evaluator, batch.rays(), questions.window, &mut scratch, &mut answers);
        all.most.push(by_rows(evaluator, batch.rays(), questions, &mut scratch, &mut answers));
        by_columns(evaluator, batch.rays(), questions.window, &mut scratch, &mut answers);
        all.rays.append(&mut answers);
    }
    all
}

fn by_lists<E: Evaluator>(
    evaluator: &E,
    rays: Rays<'_>,
    window: Window,
    scratch: &mut E::Scratch,
    answers: &mut [Answer],
) {
    let (mut all, mut first) = (Collected::default(), Collected::default());
    evaluator.crossings(rays, &Query { window, limit: Limit::All, starts: None }, scratch, &mut all);
    evaluator.crossings(rays, &Query { window, limit: Limit::First, starts: None }, scratch, &mut first);
    assert_eq!((all.len(), first.len()), (answers.len(), answers.len()));
    for (i, answer) in answers.iter_mut().enumerate() {
        let RegionId(start) = all.starts[i];
        assert_eq!(start, first.starts[i].0);
        *answer = Answer { start, all: bits(all.of(i)), first: bits(first.of(i)), ..Answer::default() };
    }
}

/// Writes to rows initialised with garbage; with an even number of rows, without faces.
fn by_rows<E: Evaluator>(
    evaluator: &E,
    rays: Rays<'_>,
    questions: &Questions,
    scratch: &mut E::Scratch,
    answers: &mut [Answer],
) -> usize {
    let mut times = vec![vec![f64::NAN; rays.len()]; questions.rows];
    let mut faces = vec![vec![i32::MIN; rays.len()]; questions.rows * (questions.rows % 2)];
    let mut rows = HitArrayRows {
        times: &mut times.iter_mut().map(|row| &mut row[..]).collect::<Vec<_>>(),
        faces: &mut faces.iter_mut().take(questions.rows).map(|row| &mut row[..]).collect::<Vec<_>>(),
    };
    let most = evaluator.hits(rays, questions.window, scratch, &mut rows);
    for (i, answer) in answers.iter_mut().enumerate() {
        answer.times = times.iter().map(|row| row[i].to_bits()).collect();
        answer.faces = faces.iter().take(questions.rows).map(|row| row[i]).collect();
    }
    most
}

fn by_columns<E: Evaluator>(
    evaluator: &E,
    rays: Rays<'_>,
    window: Window,
    scratch: &mut E::Scratch,
    answers: &mut [Answer],
) {
    let count = rays.len();
    let (mut numbers, mut face) = ([(); 4].map(|()| vec![0.5; count]), vec![i32::MIN; count]);
    let mut ids = [(); 3].map(|()| vec![u32::MAX; count]);
    let [t, nx, ny, nz] = &mut numbers;
    let [placement, before, after] = &mut ids;
    let normal = Some([&mut nx[..], &mut ny[..], &mut nz[..]]);
    let mut hits = FirstHits { t, face: &mut face, placement, before, after, normal };
    evaluator.nearest(rays, window, scratch, &mut hits);
    for (i, answer) in answers.iter_mut().enumerate() {
        answer.nearest = std::array::from_fn(|k| numbers[k][i].to_bits());
        let [placement, before, after] = std::array::from_fn(|k| i64::from(ids[k][i]));
        answer.nearest_at = [face[i].into(), placement, before, after];
    }
}
