//! Differential test of all evaluators against the reference, short form of `examples/differential.rs`.

use rayweave_conformance::differential::compare;
use rayweave_conformance::maker;
use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};

#[test]
fn all_give_the_same_lists() {
    let single_hit = maker(|program| SingleHit::new(program).expect("no model of the suite is too large"));
    let scores = compare(
        &maker(Reference::new),
        &[maker(Packets::new), maker(Weave::new), single_hit, maker(Spans::new)],
        0..48,
    );
    let names: Vec<_> = scores.iter().map(|score| score.name).collect();
    assert_eq!(names, ["packets", "weave", "single_hit", "spans"]);
    for score in scores {
        assert!(score.rays >= 40_000 && score.crossings * 2 > score.rays, "{score:?}");
        assert!(score.wrong == 0, "{score:?}");
    }
}

#[test]
fn a_liar_is_found_out() {
    // an evaluator of a different model
    let liar = maker(|_| {
        Weave::new(std::sync::Arc::new(
            rayweave_model::Program::compile(&rayweave_model::Solid::universe()).expect("legal"),
        ))
    });
    let scores = compare(&maker(Reference::new), &[liar], 0..4);
    assert!(scores[0].wrong > 100 && !scores[0].messages.is_empty(), "{scores:?}");
}
