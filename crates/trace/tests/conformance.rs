//! The conformance suite for all evaluators.

use rayweave_conformance::conformance_tests;
use rayweave_model::Program;
use rayweave_trace::{AnyEvaluator, Reference};
use std::sync::Arc;

/// The suite for each evaluator, by its name in [`AnyEvaluator::NAMES`], in a module of that name.
macro_rules! evaluators {
    ($($name:ident)+) => {
        $(mod $name {
            use super::*;

            fn make(program: Arc<Program>) -> AnyEvaluator {
                AnyEvaluator::new(Some(stringify!($name)), program)
                    .expect("no model of the suite is too large")
            }

            conformance_tests!(make, Reference::new);
        })+

        #[test]
        fn every_evaluator_is_tested() {
            assert_eq!(AnyEvaluator::NAMES, [$(stringify!($name)),+]);
        }
    };
}

evaluators! {
    packets
    weave
    reference
    single_hit
    spans
}
