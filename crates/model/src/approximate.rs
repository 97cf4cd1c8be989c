//! Contract of evaluators that are not exact: each crossing has an error bound, or its ray is marked
//! uncertain.

use crate::{CrossingColumns, Program, Query, Rays};

/// Finds the crossings of a compiled model within stated error bounds: single precision on a GPU, a preview,
/// a learned predictor.
///
/// This is a second contract next to that of [`Evaluator`](crate::Evaluator), whose answers are equal bit for bit. For
/// each ray that is not marked as uncertain, compared with the answer of an `Evaluator` to the same query:
///
/// - the region at the start, the number of crossings and their order are the same;
/// - each crossing has the same face, placement and regions on both sides;
/// - each time differs by at most the bound of its row.
///
/// A ray that is marked as uncertain carries no guarantee: the caller traces it with an exact evaluator. The
/// suite in `rayweave-conformance` tests both contracts.
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
    /// Rays must pass [`Program::check_rays`].
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
    /// The crossings. Those of an uncertain ray are meaningless and may be missing.
    pub crossings: CrossingColumns,
    /// Upper bound of the error of each time: finite, >= 0, one per row of `crossings`.
    pub bound: Vec<f64>,
    /// One flag per ray: true if an exact evaluator has to trace it again.
    pub uncertain: Vec<bool>,
}

impl ApproximateColumns {
    /// Removes all rays and keeps the memory.
    pub fn clear(&mut self) {
        self.crossings.clear();
        self.bound.clear();
        self.uncertain.clear();
    }
}
