//! No evaluator allocates per ray: once a scratch has been used, further batches do not allocate.
//!
//! A single test in its own program, because allocations are counted for all threads.

use rayweave_conformance::rays::{batch, rays};
use rayweave_conformance::{Model, Random, Style};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{
    CrossingColumns, Evaluator, FirstHits, Limit, Program, Query, RayAnswer, RayBatch, RegionId, Solid,
    Window,
};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Packets, SingleHit, Spans, Weave};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::sync::Arc;

#[global_allocator]
static COUNTER: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Allocations and reallocations in a repeated round, and the result of the round. The least of three, since
/// the thread of the test harness may allocate meanwhile.
fn in_second<T: PartialEq + std::fmt::Debug>(mut round: impl FnMut() -> T) -> (usize, T) {
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

/// All crossings, first crossings, and the regions of the origins.
fn second_round<E: Evaluator>(evaluator: &E, seed: u64, model: &Model) -> (usize, usize) {
    let rays = batch(&rays(&mut Random::new(seed), model.style, &model.frame, 100));
    let points: [Vec<f64>; 3] = std::array::from_fn(|k| rays.rays().origins[k].to_vec());
    let mut regions = vec![RegionId(0); points[0].len()];
    let mut scratch = evaluator.scratch();
    in_second(|| {
        let mut crossings = 0;
        for limit in [Limit::All, Limit::First] {
            let query = Query { limit, ..Query::default() };
            let mut count = |answer: RayAnswer<'_>| crossings += answer.crossings.len();
            evaluator.crossings(rays.rays(), &query, &mut scratch, &mut count);
        }
        evaluator.regions_at([&points[0], &points[1], &points[2]], &mut scratch, &mut regions);
        crossings
    })
}

/// First hits with normals. Returns allocations and number of hits.
fn second_look<E: Evaluator>(evaluator: &E, rays: &RayBatch) -> (usize, usize) {
    let count = rays.rays().len();
    let [mut t, mut x, mut y, mut z] = [(); 4].map(|()| vec![0.0; count]);
    let [mut placement, mut before, mut after] = [(); 3].map(|()| vec![0; count]);
    let (mut face, mut scratch) = (vec![-1; count], evaluator.scratch());
    in_second(|| {
        let mut hits = FirstHits {
            t: &mut t,
            face: &mut face,
            placement: &mut placement,
            before: &mut before,
            after: &mut after,
            normal: Some([&mut x, &mut y, &mut z]),
        };
        evaluator.nearest(rays.rays(), Window::ALL, &mut scratch, &mut hits);
        face.iter().filter(|&&face| face >= 0).count()
    })
}

/// All crossings, batch by batch in the same columns. Returns allocations and number of crossings.
fn second_columns<E: Evaluator>(evaluator: &E, rays: &RayBatch) -> (usize, usize) {
    let (rays, query) = (rays.rays(), Query::default());
    let (mut scratch, mut columns) = (evaluator.scratch(), CrossingColumns::default());
    in_second(|| {
        let mut crossings = 0;
        for start in (0..rays.len()).step_by(64) {
            let range = start..rays.len().min(start + 64);
            columns.clear();
            evaluator.columns(rays.slice(range), &query, &mut scratch, &mut columns);
            crossings += columns.rows();
        }
        crossings
    })
}

/// Curved solids, some of them placed, in a group that is placed again.
fn placed() -> Arc<Program> {
    let shape = |name: &str, arguments: &[(&str, f64)]| {
        let arguments: Vec<_> = arguments.iter().map(|&(name, value)| (name, Value::Number(value))).collect();
        Solid::from(build(name, &arguments).unwrap())
    };
    let ring = shape("torus", &[("major", 0.3), ("minor", 0.1)]);
    let funnel = shape("cone", &[("radius1", 0.3), ("radius2", 0.1), ("height", 0.5)]);
    let at =
        |k: usize, step: f64| Affine::translate(step * Vec3::new(k as f64, (k / 2) as f64, 0.3 * k as f64));
    let pair = (&ring | funnel).place((0..4).map(|k| at(k, 0.8)).collect::<Vec<_>>());
    let all = ring.translate([0.0, 0.0, 1.0]) | pair.place((0..3).map(|k| at(k, -2.0)).collect::<Vec<_>>());
    Arc::new(Program::compile(&all).unwrap())
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
        let packets = second_round(&Packets::new(program.clone()), seed, &model);
        assert_eq!(packets.0, 0, "packets, model {seed}");
        assert_eq!(packets.1, weave.1);
        let single_hit = second_round(&SingleHit::new(program).unwrap(), seed, &model);
        assert_eq!(single_hit.0, 0, "single_hit, model {seed}");
        assert_eq!(single_hit.1, weave.1);
        models += 1;
        crossings += weave.1;
    }
    assert!(models > 150 && crossings > 10_000, "{models} models, {crossings} crossings");

    let (program, mut random) = (placed(), Random::new(1));
    let mut vector =
        || Vec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let rays = (0..2_000).map(|_| {
        let from = 9.0 * vector();
        Ray::new(from, 4.0 * vector() - from)
    });
    let rays: RayBatch = rays.collect();
    let looks = [
        second_look(&Packets::new(program.clone()), &rays),
        second_look(&Weave::new(program.clone()), &rays),
    ];
    assert_eq!(looks[0], looks[1]);
    assert_eq!(looks[0].0, 0);
    assert!(looks[0].1 > 100, "{} hits", looks[0].1);
    let columns = [
        second_columns(&Packets::new(program.clone()), &rays),
        second_columns(&Weave::new(program.clone()), &rays),
    ];
    assert_eq!(columns[0], columns[1]);
    assert_eq!(columns[0].0, 0);
    assert!(columns[0].1 > 200, "{} crossings", columns[0].1);
}
