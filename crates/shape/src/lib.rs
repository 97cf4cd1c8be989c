//! Surfaces and primitive solids.
//!
//! - [`surface`]: few, closed, hot kernels: where a ray crosses a surface, on which side it is, the normal.
//! - [`lanes`]: the same for eight rays at a time.
//! - [`primitive`]: many, open: what people call shapes, each *lowered* to a conjunction of sides of surfaces.

pub mod lanes;
pub mod primitive;
pub mod surface;

mod ray;

pub use ray::{Ray, RayError, RayPart};
