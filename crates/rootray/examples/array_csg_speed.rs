//! Benchmark of `array_csg_into`, checks included: time per ray, and the fraction of the machine's copy
//! bandwidth.
//!
//! `cargo run --release -p rayweave-rootray --example array_csg_speed [-- RAYS [OPERATION]]`: by default a
//! million rays and their union (operations: `union`, `intersect`, `difference`). Every figure is the best of
//! several runs. The fraction refers to the bandwidth of a copy, reads and writes included.

use std::time::Instant;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_rootray::hit_array::{
    CsgOptions, Float, HitArray, HitArrayError, Instructions, Operation, array_csg_into,
};

/// Rows per operand.
const ROWS: [usize; 4] = [2, 4, 8, 16];

/// Seconds of the fastest run.
fn best(runs: usize, mut run: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    (0..runs).map(time).fold(f64::INFINITY, f64::min)
}

/// Sorted columns of random times; a fifth of the pairs is padding.
fn random_hits<T: Float>(rng: &mut ChaCha8Rng, rows: usize, rays: usize, number: fn(f64) -> T) -> Vec<T> {
    let mut hits = vec![T::INFINITY; rows * rays];
    let mut column = vec![0.0; rows];
    for ray in 0..rays {
        for pair in column.chunks_mut(2) {
            let padding = rng.random_bool(0.2);
            pair.iter_mut()
                .for_each(|t| *t = if padding { f64::INFINITY } else { rng.random_range(0.0..100.0) });
        }
        column.sort_by(f64::total_cmp);
        for (row, &t) in column.iter().enumerate() {
            hits[row * rays + ray] = number(t);
        }
    }
    hits
}

/// Copy bandwidth in bytes per second, reads and writes included, for a size that no cache holds.
fn copy_bandwidth() -> f64 {
    let from = vec![1_u8; 1 << 26];
    let mut to = vec![0_u8; 1 << 26];
    let seconds = best(10, || {
        to.copy_from_slice(&from);
        std::hint::black_box(&mut to);
    });
    2.0 * from.len() as f64 / seconds
}

fn measure<T: Float>(
    name: &str,
    number: fn(f64) -> T,
    rays: usize,
    operation: Operation,
    bandwidth: f64,
) -> Result<(), HitArrayError> {
    for rows in ROWS {
        let mut rng = ChaCha8Rng::seed_from_u64(rows as u64);
        let [a, b] = [0; 2].map(|_| random_hits(&mut rng, rows, rays, number));
        let (first, second) = (HitArray::new(&a, rows, rays)?, HitArray::new(&b, rows, rays)?);
        let mut out = vec![T::ZERO; 2 * rows * rays];
        let floor = 4.0 * (rows * size_of::<T>()) as f64 / bandwidth;
        for instructions in Instructions::available() {
            let options = CsgOptions { instructions, ..CsgOptions::default() };
            let runs = if instructions == Instructions::Scalar { 1 } else { 7 };
            array_csg_into(first, second, operation, options, &mut out)?;
            let seconds = best(runs, || {
                let done = array_csg_into(first, second, operation, options, &mut out);
                std::hint::black_box((&mut out, done.is_ok()));
            });
            let per_ray = seconds / rays as f64;
            println!(
                "{name}  {rows:>4} rows  {:<7} {:>9.2} ns a ray {:>7.2} ns an entry {:>6.0} % of the copy",
                format!("{instructions:?}"),
                per_ray * 1e9,
                per_ray * 1e9 / (2 * rows) as f64,
                100.0 * floor / per_ray
            );
        }
    }
    Ok(())
}

fn main() -> Result<(), HitArrayError> {
    let mut words = std::env::args().skip(1);
    let rays = words.next().and_then(|word| word.parse().ok()).unwrap_or(1_000_000);
    let operation = match words.next().as_deref() {
        Some("intersect") => Operation::Intersect,
        Some("difference") => Operation::Difference,
        _ => Operation::Union,
    };
    let bandwidth = copy_bandwidth();
    println!("{operation:?} of {rays} rays, one thread; copy {:.1} GB/s read and written", bandwidth * 1e-9);
    measure("f64", |t| t, rays, operation, bandwidth)?;
    measure("f32", |t| t as f32, rays, operation, bandwidth)
}
