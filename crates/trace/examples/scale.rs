//! Cost of a ray as a function of the number of leaves, in five families of models. The argument is the
//! largest number of leaves (default 100000).

use rayweave_conformance::{Random, scale};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Limit, Program, Query, RayAnswer, RayBatch, Solid};
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::sync::Arc;
use std::time::Instant;

/// Rays from a sphere around the model towards points of a box in it.
fn rays(count: usize, half: Vec3) -> RayBatch {
    let mut rng = Random::new(7);
    std::iter::repeat_with(|| {
        let from = rng.direction() * 3.0;
        let to = rng.point(1.0) * half;
        Ray::new(from, (to - from).normalize())
    })
    .take(count)
    .collect()
}

/// Seconds, crossings and intersected leaves per ray: the fastest of four rounds.
fn cost(weave: &Weave, batch: &RayBatch, limit: Limit) -> [f64; 3] {
    let mut scratch = weave.scratch();
    let query = Query { limit, ..Query::nearest() };
    let count = batch.rays().len() as f64;
    let (mut seconds, mut crossings) = (f64::INFINITY, 0);
    let mut leaves = 0;
    for _ in 0..4 {
        crossings = 0;
        let before = scratch.intersected_leaves();
        let started = Instant::now();
        weave.crossings(batch.rays(), &query, &mut scratch, &mut |answer: RayAnswer<'_>| {
            crossings += answer.crossings.len();
        });
        seconds = started.elapsed().as_secs_f64().min(seconds);
        leaves = scratch.intersected_leaves() - before;
    }
    [seconds / count, crossings as f64 / count, leaves as f64 / count]
}

fn row(family: &str, n: usize, solid: &Solid, half: Vec3) {
    let started = Instant::now();
    let program = Arc::new(Program::compile(solid).expect("a valid solid"));
    let compile = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let weave = Weave::new(program.clone());
    let build = started.elapsed().as_secs_f64();
    let bytes = weave.hierarchy_bytes() as f64 / program.leaves().len() as f64;
    let batch = rays(20_000, half);
    let [first, hit, near] = cost(&weave, &batch, Limit::First);
    let [all, crossings, leaves] = cost(&weave, &batch, Limit::All);
    let (first, all, leaf) = (first * 1e9, all * 1e9, all / leaves * 1e9);
    println!(
        "| {family} | {n} | {compile:.2} | {build:.3} | {bytes:.0} | {near:.1} | {hit:.2} | {first:.0} | {leaves:.1} | \
         {crossings:.1} | {all:.0} | {leaf:.0} |"
    );
}

fn main() {
    let most = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(100_000);
    println!(
        "| family | n | compile s | build s | bytes/leaf | leaves, nearest | hits | ns, nearest | leaves, list | crossings | ns, list | ns/leaf |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let sizes = || (3..).map(|k| 10usize.pow(k)).take_while(move |&n| n <= most);
    sizes().for_each(|n| row("spheres", n, &scale::spheres(n, 1), Vec3::ONE));
    sizes().for_each(|n| row("parts", n, &scale::parts(n, 1), Vec3::ONE));
    sizes().for_each(|n| row("plate", n, &scale::plate(n), Vec3::new(1.0, 1.0, 0.05)));
    sizes().for_each(|n| row("sponge", n, &scale::sponge(n), Vec3::ONE));
    sizes().for_each(|n| row("lattice", n, &scale::lattice(n), Vec3::ONE));
}
