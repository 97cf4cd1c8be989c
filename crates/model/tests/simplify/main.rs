//! The preparation of formulas: every pass keeps the answer and its promise.

mod boxes;
mod deep;
mod passes;
mod prints;
mod written;
