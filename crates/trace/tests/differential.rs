//! Differential test of all evaluators against the reference, short form of `examples/differential.rs`.

use rayweave_conformance::differential::compare;
use rayweave_conformance::maker;
use rayweave_trace::{AnyEvaluator, Reference, Weave};

#[test]
fn all_give_the_same_lists() {
    let tested: Vec<_> = AnyEvaluator::NAMES.into_iter().filter(|name| *name != "reference").collect();
    let evaluator = |name: &&'static str| {
        let make = AnyEvaluator::maker(Some(*name));
        maker(move |program| make(program).expect("no model of the suite is too large"))
    };
    let evaluators: Vec<_> = tested.iter().map(evaluator).collect();
    let scores = compare(&maker(Reference::new), &evaluators, 0..48);
    let names: Vec<_> = scores.iter().map(|score| score.name).collect();
    assert_eq!(names, tested);
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
