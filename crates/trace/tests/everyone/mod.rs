//! One ray, traced by every evaluator.

use rayweave_model::{Collected, Evaluator, Program, Query};
use rayweave_shape::Ray;
use rayweave_trace::{AnyEvaluator, Reference};
use std::sync::Arc;

/// The answer of the reference, after a check that all other evaluators return the same.
pub fn trace(program: &Arc<Program>, ray: Ray) -> Collected {
    let reference = Reference::new(program.clone()).one(ray, &Query::default()).unwrap();
    for name in AnyEvaluator::NAMES {
        let evaluator = AnyEvaluator::new(Some(name), program.clone()).unwrap();
        assert_eq!(evaluator.one(ray, &Query::default()).unwrap(), reference, "{name}");
    }
    reference
}
