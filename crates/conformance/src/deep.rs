//! Trees of 100,000 levels on a small stack.

use crate::Random;
use crate::models::shape;
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Evaluator, Program, Query, RegionId, Solid};
use rayweave_shape::Ray;
use std::sync::Arc;

const DEPTH: usize = 100_000;

/// Stack size in bytes of the thread that runs the test.
const STACK: usize = 256 << 10;

/// Builds, prints, compares, compiles, traces and drops a chain of all operators, complements, maps and
/// names.
pub fn chains<E: Evaluator>(make: impl Fn(Arc<Program>) -> E + Sync + Send) {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, || chain(&make));
        let done = thread.map(|thread| thread.join().is_ok());
        assert!(matches!(done, Ok(true)), "a tree of {DEPTH} levels failed on a stack of {STACK} bytes");
    });
}

fn chain<E: Evaluator>(make: impl Fn(Arc<Program>) -> E) {
    let solid = build(1, true);
    assert!(solid == build(1, true), "a tree differs from its twin");
    assert!(solid != build(2, true), "different trees compare equal");
    // a named solid is printed as its name
    assert!(solid.to_string().len() < 100 * DEPTH && build(1, false).to_string().len() > 10 * DEPTH);
    let program = Arc::new(Program::compile(&solid).expect("all maps are regular"));
    let leaves = program.leaves().len();
    assert!((DEPTH / 3..=DEPTH).contains(&leaves), "{leaves} leaves");
    // memory grows with the number of leaves, not with that number times the depth
    let nodes = program.prototypes()[0].expression.nodes();
    let count = nodes.len();
    let operands: usize = nodes.map(operand_count).sum();
    assert!(count + operands <= 6 * DEPTH, "{count} nodes, {operands} operands");
    let evaluator = make(program);
    for row in 0..20 {
        let at = Vec3::new(-9.0, 3.0 * f64::from(row * 37), 0.1);
        let found = evaluator.one(Ray::new(at, Vec3::X), &Query::default()).unwrap();
        let mut region = found.starts[0];
        for crossing in &found.crossings {
            assert_eq!(region, crossing.before);
            assert_ne!(crossing.before, crossing.after);
            region = crossing.after;
        }
        assert_eq!(
            region == RegionId(0),
            found.crossings.len() % 2 == usize::from(found.starts[0] != RegionId(0))
        );
    }
}

fn operand_count(gate: rayweave_model::Gate<'_>) -> usize {
    match gate {
        rayweave_model::Gate::Join(_, operands) => operands.len(),
        _ => 0,
    }
}

/// Balls in a column along y, joined by all operators; each ray of the test hits few of them.
fn build(seed: u64, names: bool) -> Solid {
    let mut rng = Random::new(seed);
    let ball = shape("sphere", &[("radius", 1.0)]);
    let mut solid = ball.clone();
    for level in 1..DEPTH {
        let next = || ball.translate([0.0, 3.0 * level as f64, 0.0]);
        solid = match rng.below(9) {
            0 | 1 => solid | next(),
            2 => solid - next(),
            3 => solid ^ next(),
            4 => solid & !next(),
            5 => !solid,
            6 => solid.apply(Affine::translate(Vec3::new(0.0, 0.0, 1e-7))),
            7 if names => solid.named("part"),
            _ => next() | solid,
        };
    }
    solid
}
