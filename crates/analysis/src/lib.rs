//! Questions about geometry, asked of any evaluator.
//!
//! [`infill`](mod@infill) covers a region of the plane, or the layers of a solid, with the parallel traces of a tool.

pub mod infill;
