//! Throughput of hits and first hits in rays per second, written into columns by several threads.
//!
//! `columns [RAYS] [THREADS] [REPEATS]`; the columns are allocated once, and the shortest time counts.

use rayweave::model::drive::{Cancel, drive};
use rayweave::model::{Evaluator, FirstHits, HitArrayRows, RayBatch, Rays, Window};
use rayweave::shapes::{box_, cylinder, sphere};
use rayweave::{AnyEvaluator, AnyScratch, Program, Ray, Solid, Vec3};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

/// Rays per chunk of a thread.
const CHUNK: usize = 8192;

fn die() -> Result<Solid, rayweave::Error> {
    let bore = cylinder(0.5, f64::INFINITY)?;
    Ok((box_([2.0; 3])? & sphere(1.35)?) - &bore - bore.rotate_x(90.0) - bore.rotate_y(90.0))
}

fn lens() -> Result<Solid, rayweave::Error> {
    let (ball, rim) = (sphere(50.0)?, cylinder(12.0, f64::INFINITY)?);
    Ok(ball.translate([0.0, 0.0, 48.0]) & ball.translate([0.0, 0.0, -48.0]) & rim)
}

/// Rays from points on a sphere towards points in a box, from a fixed multiplicative sequence.
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

/// A slice of the rays.
fn part<'a>(rays: &Rays<'a>, start: usize, len: usize) -> Rays<'a> {
    let cut = |columns: [&'a [f64]; 3]| columns.map(|column| &column[start..start + len]);
    Rays { origins: cut(rays.origins), directions: cut(rays.directions) }
}

/// Runs `work` on chunks on several threads.
fn share<C: Send>(
    evaluator: &AnyEvaluator,
    threads: NonZeroUsize,
    chunks: impl Iterator<Item = C> + Send,
    work: impl Fn(&mut AnyScratch, C) + Sync,
) {
    let run = drive(threads, &Cancel::new(), chunks, || evaluator.scratch(), work, |()| Ok::<(), ()>(()));
    run.expect("nothing fails");
}

/// Writes all hits into rows.
fn hits(evaluator: &AnyEvaluator, rays: &Rays<'_>, threads: NonZeroUsize, rows: &mut [Vec<f64>]) {
    let mut rest: Vec<_> = rows.iter_mut().map(Vec::as_mut_slice).collect();
    let chunks = (0..rays.len()).step_by(CHUNK).map(|start| {
        let len = CHUNK.min(rays.len() - start);
        (start, rest.iter_mut().filter_map(|row| row.split_off_mut(..len)).collect::<Vec<_>>())
    });
    share(evaluator, threads, chunks, |scratch, (start, mut times)| {
        let rays = part(rays, start, times[0].len());
        let mut rows = HitArrayRows { times: &mut times, faces: &mut [] };
        evaluator.hits(rays, Window::ALL, scratch, &mut rows);
    });
}

/// Columns of first hits with their normals.
#[derive(Default)]
struct First {
    t: Vec<f64>,
    face: Vec<i32>,
    numbers: [Vec<u32>; 3],
    normal: [Vec<f64>; 3],
}

impl First {
    fn new(len: usize) -> First {
        let (numbers, normal) = ([0; 3].map(|zero| vec![zero; len]), [0.0; 3].map(|zero| vec![zero; len]));
        First { t: vec![0.0; len], face: vec![0; len], numbers, normal }
    }

    fn fill(&mut self, evaluator: &AnyEvaluator, rays: &Rays<'_>, threads: NonZeroUsize) {
        let mut t = self.t.chunks_mut(CHUNK);
        let mut face = self.face.chunks_mut(CHUNK);
        let mut numbers = self.numbers.each_mut().map(|column| column.chunks_mut(CHUNK));
        let mut normal = self.normal.each_mut().map(|column| column.chunks_mut(CHUNK));
        let chunks = (0..rays.len()).step_by(CHUNK).map(|start| {
            let [placement, before, after] =
                numbers.each_mut().map(|column| column.next().unwrap_or_default());
            let normal = normal.each_mut().map(|column| column.next().unwrap_or_default());
            let (t, face) = (t.next().unwrap_or_default(), face.next().unwrap_or_default());
            (start, FirstHits { t, face, placement, before, after, normal: Some(normal) })
        });
        let window = Window::new(0.0, f64::INFINITY).expect("a window");
        share(evaluator, threads, chunks, |scratch, (start, mut hits)| {
            evaluator.nearest(part(rays, start, hits.t.len()), window, scratch, &mut hits);
        });
    }
}

/// Millions of items per second, from the shortest of several runs.
fn rate(count: usize, repeats: usize, mut work: impl FnMut()) -> f64 {
    let seconds = (0..repeats).map(|_| {
        let started = Instant::now();
        work();
        started.elapsed().as_secs_f64()
    });
    count as f64 / seconds.fold(f64::INFINITY, f64::min) / 1e6
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<usize>());
    let mut number = |default| arguments.next().unwrap_or(Ok(default));
    let (count, threads, repeats) = (number(100_000)?, number(1)?, number(20)?);
    let threads = NonZeroUsize::new(threads).ok_or("there must be a thread")?;
    for (name, solid, radius, half) in [("die", die()?, 5.0, 1.0), ("lens", lens()?, 60.0, 10.0)] {
        let evaluator = AnyEvaluator::new(None, Arc::new(Program::compile(&solid)?))?;
        let batch = rays(count, radius, half);
        let rays = batch.rays();
        let most = evaluator.hits(
            rays,
            Window::ALL,
            &mut evaluator.scratch(),
            &mut HitArrayRows { times: &mut [], faces: &mut [] },
        );
        let mut rows = vec![vec![0.0; count]; most.next_multiple_of(2).max(2)];
        let all = rate(count, repeats, || hits(&evaluator, &rays, threads, &mut rows));
        let mut first = First::new(count);
        let nearest = rate(count, repeats, || first.fill(&evaluator, &rays, threads));
        println!("{name}: {threads} threads: hits {all:.2}, first hits {nearest:.2} Mray/s");
    }
    Ok(())
}
