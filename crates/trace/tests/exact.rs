//! Evaluators against exact arithmetic: no wrong side, no crossing too many or too few.
//!
//! The oracle answers each ray once, and every evaluator is compared with it. `examples/exact.rs` runs the
//! long forms for any number of rays.

use rayweave_conformance::{Maker, exact, maker};
use rayweave_trace::AnyEvaluator;

/// Seeds of the short form, a model of fifty rays each.
const SHORT: std::ops::Range<u64> = 0..1100;

/// Seeds of the long form: 1e7 rays.
const LONG: std::ops::Range<u64> = 0..200_000;

fn evaluators() -> Vec<Maker> {
    let evaluator = |name| {
        let make = AnyEvaluator::maker(Some(name));
        maker(move |program| make(program).expect("no model of the suite is too large"))
    };
    AnyEvaluator::NAMES.map(evaluator).into()
}

/// Models with planted coincidences, which at least half of the rays hit.
fn planted(seeds: std::ops::Range<u64>, least: u64) {
    let count = exact::planted(&evaluators(), seeds);
    assert!(2 * count.plain <= count.rays, "{} of {} rays are plain", count.plain, count.rays);
    count.finish("planted", least);
}

#[test]
fn planted_coincidences() {
    planted(SHORT, 45_000);
}

#[test]
fn meshes() {
    exact::meshes(&evaluators(), SHORT).finish("meshes", 20_000);
}

#[test]
fn transversal_rays() {
    exact::transversal(&evaluators(), SHORT).finish("transversal", 45_000);
}

#[test]
fn turned_models() {
    exact::turned(&evaluators(), SHORT).finish("turned", 20_000);
}

#[test]
fn points() {
    exact::points(&evaluators(), SHORT).finish("points", 45_000);
}

/// Models of the long form on which engine and oracle once differed: parts placed far from the origin with rays near
/// their faces, cones and crossing planes with rays through the singular point, boundary events that change the result
/// only together, a stretched tube and a pin, crossings near ties and points of tangency, rays nearly along infinite
/// cylinders, equal ellipsoids with other axes, a grazed edge in one of two crossing planes.
#[test]
fn planted_coincidences_that_were_wrong_once() {
    let seeds = [
        4599, 7260, 8002, 11731, 12007, 23972, 26017, 36059, 36742, 44966, 59295, 67026, 69044, 101_429,
        107_824, 121_913, 123_821, 125_825, 126_583, 154_945, 157_042, 159_435, 169_340, 192_450, 196_390,
        2_081_752, 3_063_006,
    ];
    for seed in seeds {
        exact::planted(&evaluators(), seed..seed + 1).finish("planted", 20);
    }
}

/// Models of the long form with rays near faces of meshes, for which the oracle once tested only the chord of the model
/// and not that of the mesh.
#[test]
fn meshes_that_were_wrong_once() {
    let seeds = [1332, 3579, 9470, 12_757, 15_355, 16_101, 22_463, 25_228, 80_583, 97_927];
    for seed in seeds {
        exact::meshes(&evaluators(), seed..seed + 1).finish("meshes", 5);
    }
}

/// `cargo test --release -p rayweave-trace --test exact -- --ignored --nocapture long_`.
#[test]
#[ignore = "long"]
fn long_planted_coincidences() {
    planted(LONG, 9_000_000);
}

#[test]
#[ignore = "long"]
fn long_meshes() {
    exact::meshes(&evaluators(), LONG).finish("meshes", 4_000_000);
}

#[test]
#[ignore = "long"]
fn long_transversal_rays() {
    exact::transversal(&evaluators(), LONG).finish("transversal", 9_500_000);
}

#[test]
#[ignore = "long"]
fn long_turned_models() {
    exact::turned(&evaluators(), LONG).finish("turned", 4_000_000);
}

#[test]
#[ignore = "long"]
fn long_points() {
    exact::points(&evaluators(), LONG).finish("points", 9_000_000);
}
