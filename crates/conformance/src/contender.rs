//! Evaluators of any kind in one list.

use rayweave_math::Vec3;
use rayweave_model::{Collected, Evaluator, Program, Query, Rays, RegionId};
use std::sync::Arc;

/// An evaluator of one model, whatever its scratch is.
pub trait Asked {
    /// What the evaluator is called.
    fn name(&self) -> &'static str;
    /// The answers for a batch.
    fn ask(&self, rays: Rays<'_>, query: &Query<'_>) -> Collected;
    /// The region that holds a point.
    fn region_at(&self, point: Vec3) -> RegionId;
}

impl<E: Evaluator> Asked for E {
    fn name(&self) -> &'static str {
        Evaluator::name(self)
    }

    fn ask(&self, rays: Rays<'_>, query: &Query<'_>) -> Collected {
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

/// Makes an evaluator of a model.
pub type Maker = Box<dyn Fn(Arc<Program>) -> Box<dyn Asked> + Sync>;

/// An evaluator as one that takes part, from the function that makes it.
pub fn contender<E: Evaluator + 'static>(make: impl Fn(Arc<Program>) -> E + Sync + 'static) -> Maker {
    Box::new(move |program| Box::new(make(program)))
}
