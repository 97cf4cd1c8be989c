//! Root-rays beyond straight lines in space: solids in R^d, and trajectories that bend.
//!
//! A [`Field`] is a function whose sign says where a solid is; a [`Curve`] is a trajectory. Everything else
//! (isolating the times at which a curve crosses a field's surface, solids in R^d, curves through compiled
//! models) is made of these two.

pub mod curve;
mod field;
pub mod isolate;
mod lie;
mod model;
mod point;
pub mod polygon;

pub use curve::{Curve, CurveError};
pub use field::Field;
pub use isolate::isolate;
pub use lie::{leads_inside, lie_direction};
pub use model::{CurveTrace, curve_normal, curve_point, trace_curve};
pub use point::Point;
