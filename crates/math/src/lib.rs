//! Numbers under Rayweave: affine maps, bounds, exact products and polynomial roots.
//!
//! Everything here is a plain value or a total function: no allocation in the hot parts, no error that
//! could be raised later, and the same bits on every platform (transcendental functions come from `libm`,
//! and no operation is fused).

mod affine;
mod angle;
mod bounds;
mod eigen;
mod interval;
pub mod roots;
mod transform;

pub use affine::{Affine, SingularError, unit};
pub use angle::{sin_cos_degrees, unit_vector_degrees};
pub use bounds::Bounds;
pub use eigen::{Eigen, any_perpendicular, symmetric_eigen};
/// A 3 x 3 matrix, stored by columns.
pub use glam::DMat3 as Mat3;
/// A vector or a point in space.
pub use glam::DVec3 as Vec3;
pub use interval::Interval;
pub use transform::Transform;

/// The unit roundoff of `f64`, 2^-53: the relative error of one rounded operation is at most this.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
