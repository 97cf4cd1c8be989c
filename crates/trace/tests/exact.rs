//! Evaluators against exact arithmetic: no wrong side, no crossing too many or too few.

use rayweave_conformance::{Effort, exact};
use rayweave_trace::{Reference, Weave};

/// Half of the rays at least meet a coincidence.
fn enough(count: exact::Count, what: &str, least: u64) {
    assert!(2 * count.plain <= count.rays, "{what}: {} of {} rays are plain", count.plain, count.rays);
    count.finish(what, least);
}

#[test]
fn weave_on_planted_coincidences() {
    enough(exact::planted(Weave::new, Effort::Short), "weave, planted", 45_000);
}

#[test]
fn reference_on_planted_coincidences() {
    enough(exact::planted(Reference::new, Effort::Short), "reference, planted", 45_000);
}

#[test]
fn turned_models() {
    exact::turned(Weave::new, Effort::Short).finish("weave, turned", 20_000);
}

#[test]
fn points() {
    exact::points(Weave::new, Effort::Short).finish("weave, points", 45_000);
}

/// Some 1e7 rays each: `cargo test --release -p rayweave-trace --test exact -- --ignored --nocapture long_`.
#[test]
#[ignore = "long"]
fn long_weave_on_planted_coincidences() {
    enough(exact::planted(Weave::new, Effort::Long), "weave, planted", 9_000_000);
}

#[test]
#[ignore = "long"]
fn long_reference_on_planted_coincidences() {
    enough(exact::planted(Reference::new, Effort::Long), "reference, planted", 9_000_000);
}

#[test]
#[ignore = "long"]
fn long_turned_models() {
    exact::turned(Weave::new, Effort::Long).finish("weave, turned", 4_000_000);
}
