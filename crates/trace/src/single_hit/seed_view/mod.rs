//! The single-hit algorithm in its original form: a complete binary tree, decision tables, small fixed
//! stacks.
//!
//! For study and tests. This is the algorithm of S. Blyth's Opticks as documented. Its tables and limits can be
//! replaced by those derived from the rule and from the tree, so that the errors of both versions can be counted:
//!
//! - [`CompleteTree`]: nodes by number in level order, empty ones included, so that parents, children and the
//!   post-order follow from bits of the number; a tree of height h takes 2^(h+1) - 1 slots;
//! - [`Tables`]: nine entries for each operator and each closer side, eight of them packed in 32 bits (the
//!   ninth, two misses, is a miss): the original ones, or those derived from [`super::decide`];
//! - [`next`]: evaluates slices of the post-order with a stack of slices and one of values.
//!
//! The original has one wrong entry in the tables and three limitations:
//!
//! - For the union of two operands that are both exited next, the table returns the farther exit. But the operand with
//!   the closer exit may be entered again before that time and extend beyond it. The rule queries this operand again.
//! - A stack of four slices suffices for trees of height 3; a row of five overlapping leaves needs five. If the stack
//!   is full, the ray is reported as a miss.
//! - Slot numbers have 8 bits: the post-order of a tree of height 8 begins at slot 256, so every ray misses.
//! - If both operands change at the same time, the tables query only one of them again, or return the change of one for
//!   both, so that the sides become inconsistent. So both the original and the corrected tables leak on coincident
//!   faces. The rule changes *every* operand that has this time.

mod complete_tree;
mod machine;
mod tables;

pub use complete_tree::{CompleteTree, Slot};
pub use machine::{Fault, Limits, next, silent};
pub use tables::{Action, Operator, State, Tables};
