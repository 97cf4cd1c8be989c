//! The span evaluator: combines whole hit arrays of many rays, gate by gate.
//!
//! - [`Spans`]: the evaluator of compiled models;
//! - `group`: the arrays of a group, leaf by leaf and gate by gate;
//! - `schedule`: the order of the gates and the slots of their results;
//! - `scratch`, `level`: the memory of a thread, and of a chunk of columns;
//! - `column_query`: the columns, which are rays or points;
//! - `changes`: the changes of region, from the arrays of the outputs;
//! - `sides`: the sides of leaves, for the rule of attribution.

mod changes;
mod column_query;
mod evaluator;
mod group;
mod level;
mod schedule;
mod scratch;
mod sides;

pub use evaluator::{Spans, SpansScratch};

/// Largest number of columns of a chunk: with a few rows each, the arrays of a gate stay in the L1 cache.
const WIDTH: usize = 128;

/// Largest number of (leaf, column) pairs of a chunk of several columns. This bounds the memory of a chunk
/// independently of the size of the model.
const MAX_PAIRS: usize = 1 << 13;
