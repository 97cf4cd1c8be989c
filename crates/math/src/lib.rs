//! Numerics: vectors, affine maps, axis-aligned bounding boxes, interval arithmetic, error-free transformations of sums and
//! products, and real roots of polynomials up to degree 4.
//!
//! All items are plain values and total functions. Hot paths do not allocate. Results have the same bits on every platform:
//! transcendental functions come from `libm`, and no multiply-add is fused.

mod affine;
mod angle;
mod bounds;
mod compact;
mod decimal;
mod eigen;
mod interval;
mod number;
mod perturbation;
pub mod roots;
mod transform;

pub use affine::{Affine, SingularError, unit};
pub use angle::{MAX_AROUND, circle_count, sin_cos_degrees, unit_vector_degrees};
pub use bounds::Bounds;
pub use compact::CompactAffine;
pub use decimal::format_to_resolution;
pub use eigen::{Eigen, any_perpendicular, symmetric_eigen};
/// A 3 x 3 matrix, stored by columns.
pub use glam::DMat3 as Mat3;
/// A vector or a point of space.
pub use glam::DVec3 as Vec3;
pub use interval::Interval;
pub use number::{round_to_digits, unit_fraction};
pub use perturbation::{PERTURBATION_DIRECTION, perturbation_direction, perturbs_inside};
pub use transform::Transform;

/// The unit roundoff of `f64`, 2^-53: the relative error of one rounded operation is at most this.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
