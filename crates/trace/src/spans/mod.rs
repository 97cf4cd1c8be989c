//! The span evaluator: whole hit arrays, gate by gate.
//!
//! - [`Spans`]: the evaluator of compiled models;
//! - `group`: the arrays of a group, leaf by leaf and gate by gate;
//! - `schedule`: the order of the gates and the slots for their results;
//! - `room`, `level`: the memory of a thread, and for a chunk of columns;
//! - `asked`: columns are rays or points;
//! - `changes`: from the arrays of the outputs to changes of region;
//! - `sides`: the sides of leaves, for the rule of attribution.

mod asked;
mod changes;
mod evaluator;
mod group;
mod level;
mod room;
mod schedule;
mod sides;

pub use evaluator::{Spans, SpansScratch};

/// Columns handled together: with a few rows each, the arrays of a gate stay in the nearest cache.
const WIDTH: usize = 128;

/// Pairs of a column and a leaf that it can touch handled together, unless one column alone has more: this, not the size of
/// the model, bounds what a chunk needs.
const MOST_PAIRS: usize = 1 << 13;
