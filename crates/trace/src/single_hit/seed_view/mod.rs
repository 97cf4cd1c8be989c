//! Single hit as it was first done: a complete binary tree, tables of decisions, small fixed stacks.
//!
//! For study and for tests. This is the machinery of S. Blyth's Opticks as its documentation tells it, with
//! each of its parts open to exchange, so that what comes of the original table and the original limits can
//! be counted beside what comes of the rule and of limits derived from the tree:
//!
//! - [`CompleteTree`]: nodes by number in level order, empty ones included, so that parents, children and the
//!   post-order follow from bits of the number; a tree of height h takes 2^(h+1) - 1 slots;
//! - [`Tables`]: nine entries for each operator and each closer side, eight of them packed in 32 bits (the
//!   ninth, two misses, is a miss): the original ones, or those that follow from [`super::decide`];
//! - [`next`]: evaluates slices of the post-order with a stack of slices and one of values.
//!
//! What is wrong with the original is one entry of the tables and three limits:
//!
//! - UNION of two operands that are both exited: it answers the farther exit. But the operand whose exit is
//!   closer may be entered again before the farther exit, and go on beyond it. The rule asks the closer one
//!   again.
//! - Four slices do for trees of height 3, five leaves in a row that overlap need five; a full stack ends as
//!   a miss.
//! - Numbers of slots in 8 bits: a tree of height 8 begins at slot 256, and every ray misses.
//! - Where both operands have the same time only one of them is asked again, or answers for both, so that
//!   sides get out of step: tables leak on faces that coincide, the mended ones, too. The rule changes
//!   *every* operand whose time it is.

mod complete_tree;
mod machine;
mod tables;

pub use complete_tree::{CompleteTree, Slot};
pub use machine::{Fault, Limits, next, silent};
pub use tables::{Action, Operator, State, Tables};
