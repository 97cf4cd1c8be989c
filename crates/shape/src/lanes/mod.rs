//! The kernels of [`surface`](crate::surface) for eight rays at a time, in SIMD lanes.
//!
//! Each lane performs the operations of the scalar kernel in the same order, and so computes the same bits: the scalar
//! kernel is the specification. Most arithmetic is the same source, generic over [`Real`](crate::real::Real). The lane
//! forms of planes (in `facet`), of tori (in `torus`, `torus_line`) and of quadratic equations (in `quadratic`) are
//! written separately; `tests/lanes.rs` compares all kernels with the scalar ones. A lane that cannot do that (the ray
//! may lie in a surface, or numbers are near the ends of the range) is marked as [`Uncertain`], and its ray falls back
//! to the scalar kernel.
//!
//! All functions are generic over the instruction set and must be inlined into a caller that is compiled for it
//! ([`fearless_simd::dispatch`]; [`dispatch_wide`](crate::dispatch_wide) for large kernels).

mod axis;
mod cone;
mod departure;
mod facet;
mod form;
mod gradient;
mod quadratic;
mod quadric;
mod ray;
mod span;
mod torus;
mod torus_line;
mod vector;
mod wide;

pub use axis::{AxisCylinder, AxisSlab};
pub use facet::{Kernel, LaneFacet, LaneSlab};
pub use form::{FormRow, LeafForm};
pub use gradient::LaneGradient;
pub use quadric::LaneQuadric;
pub use ray::{LaneLimits, LaneRay, LaneStarts, Uncertain};
pub use span::{Gap, LaneSpan};
pub use torus::LaneTorus;
pub use vector::{LANES, Lanes, Mask, Vec3Lanes, splat};
pub use wide::WideLevel;
