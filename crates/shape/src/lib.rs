//! Surfaces and primitive solids.
//!
//! - [`surface`]: a small, closed set of hot kernels: crossings of rays and surfaces, sides, normals.
//! - [`lanes`]: the same kernels for eight rays at a time, in SIMD lanes.
//! - [`real`]: numbers of one ray or of eight, for kernels that are written once for both.
//! - [`primitive`]: an open set of parametric shapes, each *lowered* to a conjunction of sides of surfaces.

pub mod lanes;
pub mod primitive;
pub mod real;
pub mod surface;

mod ray;

pub use ray::{Ray, RayError, RayPart};
