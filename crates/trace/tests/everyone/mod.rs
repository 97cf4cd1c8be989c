//! One ray, traced by every evaluator.

use rayweave_model::{Collected, Evaluator, Program, Query};
use rayweave_shape::Ray;
use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};
use std::sync::Arc;

/// The answer of the reference, after a check that all other evaluators return the same.
pub fn trace(program: &Arc<Program>, ray: Ray) -> Collected {
    let reference = Reference::new(program.clone()).one(ray, &Query::default()).unwrap();
    let single_hit = SingleHit::new(program.clone()).unwrap();
    assert_eq!(Packets::new(program.clone()).one(ray, &Query::default()).unwrap(), reference, "packets");
    assert_eq!(Weave::new(program.clone()).one(ray, &Query::default()).unwrap(), reference, "weave");
    assert_eq!(single_hit.one(ray, &Query::default()).unwrap(), reference, "single_hit");
    assert_eq!(Spans::new(program.clone()).one(ray, &Query::default()).unwrap(), reference, "spans");
    reference
}
