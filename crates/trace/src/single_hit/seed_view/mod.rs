//! The single-hit algorithm in its original form: a complete binary tree, decision tables, small fixed
//! stacks.
//!
//! For study and tests. This is the algorithm of S. Blyth's Opticks as documented, with exchangeable parts,
//! so that errors of the original table and limits can be counted beside those of the rule and of limits
//! derived from the tree:
//!
//! - [`CompleteTree`]: nodes by number in level order, empty ones included, so that parents, children and the
//!   post-order follow from bits of the number; a tree of height h takes 2^(h+1) - 1 slots;
//! - [`Tables`]: nine entries for each operator and each closer side, eight of them packed in 32 bits (the
//!   ninth, two misses, is a miss): the original ones, or those derived from [`super::decide`];
//! - [`next`]: evaluates slices of the post-order with a stack of slices and one of values.
//!
//! The original has one wrong entry in the tables and three limitations:
//!
//! - UNION of two operands that are both exited returns the farther exit. But the operand whose exit is
//!   closer may be entered again before the farther exit, and extend beyond it. The rule queries the closer
//!   one again.
//! - Four slices suffice for trees of height 3; five overlapping leaves in a row need five. A full stack ends
//!   as a miss.
//! - Numbers of slots have 8 bits: a tree of height 8 begins at slot 256, and every ray misses.
//! - Where both operands have the same time, only one of them is queried again, or stands for both, so that
//!   sides become inconsistent: tables leak on coincident faces, the corrected ones, too. The rule changes
//!   *every* operand whose time it is.

mod complete_tree;
mod machine;
mod tables;

pub use complete_tree::{CompleteTree, Slot};
pub use machine::{Fault, Limits, next, silent};
pub use tables::{Action, Operator, State, Tables};
