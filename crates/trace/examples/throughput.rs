//! Rays per second through a small lens and a die, on one thread, for every evaluator or for those named as
//! arguments.

use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Limit, Program, Query, RayAnswer, RayBatch, Solid};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// The number of rays that are timed at once.
const PIECE: usize = 1000;

/// The number of times that each piece is traced.
const ROUNDS: usize = 20;

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(n, v)| (n, Value::Number(v))).collect();
    Solid::from(build(name, &arguments).expect("a valid shape"))
}

fn lens() -> Solid {
    let ball = shape("sphere", &[("radius", 50.0)]);
    let rim = shape("cylinder", &[("radius", 12.0)]);
    ball.translate([0.0, 0.0, 48.0]) & ball.translate([0.0, 0.0, -48.0]) & rim
}

fn die() -> Solid {
    let bore = shape("cylinder", &[("radius", 0.5)]);
    let body = shape("box", &[("size", 2.0)]) & shape("sphere", &[("radius", 1.35)]);
    body - &bore - bore.rotate_x(90.0) - bore.rotate_y(90.0)
}

/// Rays from points on a sphere towards points in a box, from a fixed linear congruential sequence.
fn rays(count: usize, radius: f64, half: f64) -> RayBatch {
    let mut state = 1u64;
    let mut unit = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    std::iter::repeat_with(|| {
        let from = Vec3::new(unit(), unit(), unit()).normalize() * radius;
        let to = Vec3::new(unit(), unit(), unit()) * half;
        Ray::new(from, (to - from).normalize())
    })
    .take(count)
    .collect()
}

/// Rays per second, and crossings per ray. Each piece of the batch counts with the least time of several rounds, so that
/// other work on the machine affects the rate little.
fn rate<E: Evaluator>(evaluator: &E, batch: &RayBatch, limit: Limit) -> (f64, f64) {
    let mut scratch = evaluator.scratch();
    let query = Query { limit, ..Query::default() };
    let (rays, mut crossings, mut seconds) = (batch.rays(), 0, 0.0);
    for first in (0..rays.len()).step_by(PIECE) {
        let piece = rays.slice(first..rays.len().min(first + PIECE));
        let mut least = f64::INFINITY;
        for _ in 0..ROUNDS {
            let started = Instant::now();
            evaluator.crossings(piece, &query, &mut scratch, &mut |answer: RayAnswer<'_>| {
                crossings += answer.crossings.len();
            });
            least = least.min(started.elapsed().as_secs_f64());
        }
        seconds += least;
    }
    (rays.len() as f64 / seconds, crossings as f64 / (ROUNDS * rays.len()) as f64)
}

fn report<E: Evaluator>(model: &str, evaluator: &E, batch: &RayBatch) {
    if std::env::args().len() > 1 && !std::env::args().any(|name| name == evaluator.name()) {
        return;
    }
    for (what, limit) in [("all crossings", Limit::All), ("first crossing", Limit::First)] {
        let (rays, crossings) = rate(evaluator, batch, limit);
        let (name, rays) = (evaluator.name(), rays / 1e6);
        println!("{model}: {name}: {what}: {rays:.2} Mray/s, {crossings:.2} crossings a ray");
    }
}

/// Nanoseconds per ray of the check that callers run once per batch: the least of several rounds.
fn check_time(program: &Program, batch: &RayBatch) -> f64 {
    let round = |_| {
        let started = Instant::now();
        assert_eq!(program.check_rays(black_box(batch.rays())), Ok(()));
        started.elapsed().as_secs_f64()
    };
    (0..10 * ROUNDS).map(round).fold(f64::INFINITY, f64::min) * 1e9 / batch.rays().len() as f64
}

fn main() {
    for (model, solid, radius, half) in [("lens", lens(), 60.0, 10.0), ("die", die(), 5.0, 1.0)] {
        let program = Arc::new(Program::compile(&solid).expect("a valid solid"));
        let batch = rays(10_000, radius, half);
        println!("{model}: check of the rays: {:.3} ns a ray", check_time(&program, &batch));
        report(model, &Packets::new(program.clone()), &batch);
        report(model, &Weave::new(program.clone()), &batch);
        report(model, &Spans::new(program.clone()), &batch);
        report(model, &SingleHit::new(program.clone()).expect("a small solid"), &batch);
        report(model, &Reference::new(program), &batch);
    }
}
