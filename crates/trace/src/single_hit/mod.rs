//! The single-hit evaluator: computes the next crossing after t, again and again, on a binary CSG tree.
//!
//! Only the next change of each operand is kept, however many it has: a gate combines those of its two
//! operands by one rule (see [`decide`]), or queries them again from a later time on. So memory is bounded by
//! the height of the tree, the original motive of the algorithm (on machines whose threads have little
//! memory), and every decision can be explained: see [`SingleHit::explain`].
//!
//! - [`Next`], [`ValueStep`]: the next change of a leaf or node;
//! - [`decide`]: the rule;
//! - [`Tree`]: the expression as a binary tree;
//! - [`Stacks`]: iterative evaluation of a tree;
//! - [`SingleHit`]: the evaluator of compiled models;
//! - `seed_view`: the original form, with complete binary trees and decision tables, for study (feature `seed-view`).

mod answer;
mod evaluator;
mod explain;
mod names;
mod next_change;
mod resolved;
mod roots;
mod rule;
mod sides;
mod text;
mod tree;

#[cfg(feature = "seed-view")]
pub mod seed_view;

pub use answer::{Next, ValueStep};
pub use evaluator::{SingleHit, SingleHitScratch};
pub use explain::{
    Entry, ExplainError, ExplainedOperand, Explanation, Found, MAX_ENTRIES, Meaning, Question, What, explain,
};
pub use next_change::{LeafAnswers, NoObserver, Observer, Stacks};
pub use rule::{GateOp, Verdict, decide};
pub use text::{ExplanationText, MAX_LINES};
pub use tree::{MAX_NODES, TooLarge, Tree, TreeNode, TreeNodeKind};
