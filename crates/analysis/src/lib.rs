//! Questions about geometry, asked of any evaluator.
//!
//! [`infill`](mod@infill) covers a region of the plane, or the layers of a solid, with the parallel traces of a tool;
//! [`section`](mod@section) cuts a model by a plane.

pub mod infill;
pub mod section;
