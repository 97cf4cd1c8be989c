//! Questions about geometry, asked of any evaluator.
//!
//! [`infill`](mod@infill) covers a region of the plane, or the layers of a solid, with the parallel traces of a tool;
//! [`measure`](mod@measure) tells how large regions are: volume, centre, inertia, surface area;
//! [`section`](mod@section) cuts a model by a plane; [`survey`](mod@survey) looks at the pieces of rays in regions, and how thick
//! they are; [`thickness`] tells how far rays go through each medium.

pub mod infill;
pub mod measure;
pub mod section;
pub mod survey;
pub mod thickness;
