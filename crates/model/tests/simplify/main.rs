//! Simplification of formulas: every pass keeps the value and satisfies its contract.

mod boxes;
mod deep;
mod passes;
mod prints;
mod written;
