//! Nothing allocates per ray: with a scratch that has seen rays before, batches cost no allocation at all.
//!
//! One test alone in its program, because allocations are counted for all threads.

use rayweave_conformance::rays::{batch, rays};
use rayweave_conformance::{Model, Random, Style};
use rayweave_model::{Evaluator, Limit, Program, Query, RayAnswer, RegionId};
use rayweave_trace::{SingleHit, Spans, Weave};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::sync::Arc;

#[global_allocator]
static COUNTER: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Allocations and reallocations in a round like one before, and the crossings found there: the least of three, since the
/// thread of the test harness may allocate meanwhile.
fn second_round<E: Evaluator>(evaluator: &E, seed: u64, model: &Model) -> (usize, usize) {
    let rays = batch(&rays(&mut Random::new(seed), model.style, &model.frame, 100));
    let points: [Vec<f64>; 3] = std::array::from_fn(|k| rays.rays().origins[k].to_vec());
    let mut regions = vec![RegionId(0); points[0].len()];
    let mut scratch = evaluator.scratch();
    let mut round = || {
        let mut crossings = 0;
        for limit in [Limit::All, Limit::First] {
            let query = Query { limit, ..Query::default() };
            let mut count = |answer: RayAnswer<'_>| crossings += answer.crossings.len();
            evaluator.crossings(rays.rays(), &query, &mut scratch, &mut count);
        }
        evaluator.regions_at([&points[0], &points[1], &points[2]], &mut scratch, &mut regions);
        crossings
    };
    let first = round();
    let mut again = || {
        let region = Region::new(COUNTER);
        assert_eq!(first, round());
        let change = region.change();
        change.allocations + change.reallocations
    };
    let least = (0..2).fold(again(), |least, _| if least == 0 { 0 } else { least.min(again()) });
    (least, first)
}

#[test]
fn no_ray_and_no_point_allocates() {
    let (mut models, mut crossings) = (0, 0);
    for seed in 0..200 {
        let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
        let model = Model::random(&mut Random::new(seed), style);
        let Ok(program): Result<Arc<Program>, _> = model.compile() else { continue };
        let weave = second_round(&Weave::new(program.clone()), seed, &model);
        assert_eq!(weave.0, 0, "weave, model {seed}");
        let spans = second_round(&Spans::new(program.clone()), seed, &model);
        assert_eq!(spans.0, 0, "spans, model {seed}");
        assert_eq!(spans.1, weave.1);
        let single_hit = second_round(&SingleHit::new(program).unwrap(), seed, &model);
        assert_eq!(single_hit.0, 0, "single_hit, model {seed}");
        assert_eq!(single_hit.1, weave.1);
        models += 1;
        crossings += weave.1;
    }
    assert!(models > 150 && crossings > 10_000, "{models} models, {crossings} crossings");
}
