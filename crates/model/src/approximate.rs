//! The contract of evaluators that do not give every bit: answers with a bound, or marked as uncertain.

use crate::{CrossingColumns, Program, Query, Rays};

/// Finds the crossings of a compiled model within stated bounds: single precision on a GPU, a preview, a learned guess.
///
/// This is the second contract beside [`Evaluator`](crate::Evaluator), whose answers are equal bit for bit. For each ray
/// that is not marked as uncertain, compared with the answer of an `Evaluator` to the same query:
///
/// - the region at the start, the number of crossings and their order are the same;
/// - each crossing has the same face, placement and regions on both sides;
/// - each time differs by at most the bound of its row.
///
/// Nothing is promised about a ray that is marked as uncertain: the caller finds its crossings with an exact evaluator. The
/// suite in `rayweave-conformance` judges both contracts.
pub trait ApproximateEvaluator: Sync {
    /// The memory that a thread needs.
    type Scratch: Send;

    /// The name of the evaluator.
    fn name(&self) -> &'static str;

    /// The model.
    fn program(&self) -> &Program;

    /// Memory for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// Appends the crossings of every ray of a batch to columns.
    ///
    /// The rays are those that pass [`Rays::check`].
    fn columns(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut Self::Scratch,
        columns: &mut ApproximateColumns,
    );
}

/// Crossings with bounds of their errors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ApproximateColumns {
    /// The crossings. Those of an uncertain ray have no meaning; there may be none.
    pub crossings: CrossingColumns,
    /// The most by which each time may differ from the exact one: finite, >= 0, as long as `crossings.t`.
    pub bound: Vec<f64>,
    /// Whether each ray is to be traced again by an exact evaluator: as long as the number of rays.
    pub uncertain: Vec<bool>,
}

impl ApproximateColumns {
    /// Removes all rays and keeps the memory.
    pub fn clear(&mut self) {
        self.crossings.clear();
        self.bound.clear();
        self.uncertain.clear();
    }

    /// The numbers of the rays that are uncertain.
    pub fn uncertain_rays(&self) -> impl Iterator<Item = usize> {
        self.uncertain.iter().enumerate().filter_map(|(ray, &uncertain)| uncertain.then_some(ray))
    }
}
