//! The height of a formula.

use super::formula::{Formula, Term};

/// The number of joins on the longest path from an output down to a leaf or constant.
///
/// A complement is a flag, not a node, so it adds nothing.
pub fn height(formula: &Formula) -> u32 {
    let mut heights: Vec<u32> = Vec::with_capacity(formula.node_count());
    for (_, term, operands) in formula.nodes() {
        let below = operands.iter().map(|edge| heights[edge.node().index()]).max().unwrap_or(0);
        heights.push(if matches!(term, Term::Join(_)) { below + 1 } else { 0 });
    }
    formula.outputs().iter().map(|edge| heights[edge.node().index()]).max().unwrap_or(0)
}
