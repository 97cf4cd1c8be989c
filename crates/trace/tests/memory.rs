//! Memory of large models, including the BVH of their leaves.

use rayweave_conformance::scale;
use rayweave_model::{Program, Solid};
use rayweave_trace::Weave;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::sync::Arc;

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

const LEAVES: usize = 20_000;

/// Bytes per leaf that a program and its BVH keep allocated.
fn bytes_a_leaf(solid: &Solid) -> f64 {
    let region = Region::new(GLOBAL);
    let weave = Weave::new(Arc::new(Program::compile(solid).unwrap()));
    let change = region.change();
    let kept = change.bytes_allocated - change.bytes_deallocated;
    let leaves = rayweave_model::Evaluator::program(&weave).prototypes()[0].leaves.len();
    assert!((LEAVES..LEAVES + 4).contains(&leaves), "{leaves} leaves");
    kept as f64 / leaves as f64
}

#[test]
fn a_million_leaves_fit() {
    let check = |family: &str, solid: Solid, most: f64| {
        let bytes = bytes_a_leaf(&solid);
        assert!((10.0..=most).contains(&bytes), "{family}: {bytes} bytes a leaf");
    };
    check("spheres", scale::spheres(LEAVES, 1), 200.0);
    check("plate", scale::plate(LEAVES), 200.0);
    check("sponge", scale::sponge(LEAVES), 200.0);
    check("translated copies", scale::lattice(LEAVES), 100.0);
    check("turned and stretched copies", scale::lattice_affine(LEAVES, 1), 160.0);
}
