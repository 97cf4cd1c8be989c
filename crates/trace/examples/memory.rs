//! Bytes per leaf and compile times of large models: `memory [LEAVES] [FAMILY...]`.

use rayweave_conformance::scale;
use rayweave_model::{Program, Solid};
use rayweave_trace::Weave;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::sync::Arc;
use std::time::Instant;

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

type Family = (&'static str, fn(usize) -> Solid);

const FAMILIES: [Family; 5] = [
    ("spheres", |n| scale::spheres(n, 1)),
    ("plate", scale::plate),
    ("sponge", scale::sponge),
    ("lattice", scale::lattice),
    ("affine", |n| scale::lattice_affine(n, 1)),
];

/// The result of `make`, the bytes that it keeps allocated, and the seconds that it takes.
fn kept<T>(make: impl FnOnce() -> T) -> (T, f64, f64) {
    let (region, started) = (Region::new(GLOBAL), Instant::now());
    let made = make();
    let seconds = started.elapsed().as_secs_f64();
    let change = region.change();
    (made, change.bytes_allocated as f64 - change.bytes_deallocated as f64, seconds)
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let leaves: usize = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(100_000);
    let chosen: Vec<String> = arguments.collect();
    println!(
        "{:<8} {:>8} | {:>6} {:>6} | {:>8} {:>8} | {:>9} {:>8} | bytes a leaf by part",
        "family", "leaves", "solid", "s", "program", "s", "hierarchy", "s"
    );
    for (name, family) in FAMILIES {
        if !chosen.is_empty() && !chosen.iter().any(|c| c == name) {
            continue;
        }
        let (solid, in_solid, building) = kept(|| family(leaves));
        let (program, in_program, compiling) =
            kept(|| Arc::new(Program::compile(&solid).expect("the model is valid")));
        let count = program.prototypes()[0].leaves.len() as f64;
        let (_weave, in_weave, ordering) = kept(|| Weave::new(program.clone()));
        let part = |(part, bytes): (&str, usize)| format!("{part} {:.1}", bytes as f64 / count);
        let parts: Vec<String> = program.bytes().into_iter().map(part).collect();
        println!(
            "{name:<8} {count:>8} | {:>6.0} {building:>6.2} | {:>8.1} {compiling:>8.3} | {:>9.1} {ordering:>8.3} | {}",
            in_solid / count,
            in_program / count,
            in_weave / count,
            parts.join(", "),
        );
    }
}
