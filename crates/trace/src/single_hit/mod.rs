//! The single-hit evaluator: "what is next after t?", asked of a tree.
//!
//! Nothing but one next crossing is kept of each operand, however many it has: a gate takes the two answers
//! of its operands and makes its own from them by one rule (see [`decide`]), or asks again from a later time
//! on. So its memory is bounded by the height of the tree, which is what it was invented for (on machines
//! whose threads have little memory), and every decision can be told: see [`SingleHit::explain`].
//!
//! - [`Next`], [`Step`]: the answers;
//! - [`decide`]: the rule;
//! - [`Tree`]: the expression as a binary tree;
//! - [`Stacks`]: asking a tree, iteratively;
//! - [`SingleHit`]: the evaluator of compiled models;
//! - `seed_view`: the same by complete binary trees and decision tables, as first published (feature `seed-view`).

mod answer;
mod ask;
mod evaluator;
mod explain;
mod names;
mod roots;
mod rule;
mod settled;
mod sides;
mod story;
mod tree;

#[cfg(feature = "seed-view")]
pub mod seed_view;

pub use answer::{Next, Step};
pub use ask::{LeafAnswers, NoWatch, Stacks, Watch};
pub use evaluator::{SingleHit, SingleHitScratch};
pub use explain::{
    Entry, ExplainError, Explanation, Found, MOST_ENTRIES, Meaning, Operand, Question, What, explain,
};
pub use rule::{Op, Verdict, decide};
pub use story::{MOST_LINES, Story};
pub use tree::{Kind, MOST_NODES, Node, TooLarge, Tree};
