//! The kernels of [`surface`](crate::surface) for eight rays at a time.
//!
//! Each lane does what the scalar kernel does, operation by operation in the same order, so it gives the same bits: the
//! scalar kernel is the specification. What a lane cannot do in that way (a ray that may lie in a surface, numbers near
//! the ends of the range) it does not do at all: it raises a [`Doubt`], and the ray is asked again one by one.
//!
//! All functions are generic over the instruction set and have to be inlined into a caller that was compiled for it
//! ([`fearless_simd::dispatch`]).

mod axis;
mod cone;
mod departure;
mod facet;
mod gradient;
mod quadratic;
mod quadric;
mod ray;
mod span;
mod torus;
mod torus_line;
mod vector;

pub use axis::{AxisCylinder, AxisSlab};
pub use departure::LaneStarts;
pub use facet::{Facet, Kernel, Slab};
pub use gradient::Gradient;
pub use quadric::LaneQuadric;
pub use ray::{Doubt, LaneLimits, LaneRay};
pub use span::{Gap, Span};
pub use torus::LaneTorus;
pub use vector::{LANES, Lanes, Mask, Vec3Lanes, splat};
