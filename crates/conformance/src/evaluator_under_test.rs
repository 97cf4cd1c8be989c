//! A common interface to evaluators of different types.

use rayweave_math::Vec3;
use rayweave_model::{Collected, Evaluator, Program, Query, Rays, RegionId};
use std::sync::Arc;

/// An evaluator of one model, of any scratch type.
pub trait EvaluatorUnderTest {
    /// The name of the evaluator.
    fn name(&self) -> &'static str;
    /// The answers for a batch.
    fn trace(&self, rays: Rays<'_>, query: &Query<'_>) -> Collected;
    /// The region that contains a point.
    fn region_at(&self, point: Vec3) -> RegionId;
}

impl<E: Evaluator> EvaluatorUnderTest for E {
    fn name(&self) -> &'static str {
        Evaluator::name(self)
    }

    fn trace(&self, rays: Rays<'_>, query: &Query<'_>) -> Collected {
        let mut collected = Collected::default();
        self.crossings(rays, query, &mut self.scratch(), &mut collected);
        collected
    }

    fn region_at(&self, point: Vec3) -> RegionId {
        let mut region = [RegionId(0)];
        self.regions_at([&[point.x], &[point.y], &[point.z]], &mut self.scratch(), &mut region);
        region[0]
    }
}

/// A function that makes an evaluator of a model.
pub type Maker = Box<dyn Fn(Arc<Program>) -> Box<dyn EvaluatorUnderTest> + Sync>;

/// Wraps the function that makes an evaluator, for a differential test.
pub fn maker<E: Evaluator + 'static>(make: impl Fn(Arc<Program>) -> E + Sync + 'static) -> Maker {
    Box::new(move |program| Box::new(make(program)))
}
