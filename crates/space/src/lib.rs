//! Root-rays beyond straight lines in space: solids in R^d, and trajectories that bend.
//!
//! A [`Field`] is a function whose sign says where a solid is; a [`Curve`] is a trajectory. Everything else
//! (isolating the times at which a curve crosses a field's surface, solids in R^d, curves through compiled
//! models) is made of these two.
//!
//! A [`Solid`] is made of half-spaces, boxes, balls, cylinders, cones, quadrics and prisms of any dimension by boolean
//! operators and affine maps; [`trace`] and [`trace_along`] give its [root-ray](rayweave_rootray::RootRay) along a line
//! or a curve.

mod affine;
pub mod curve;
mod error;
mod faces;
mod field;
pub mod isolate;
mod lie;
mod model;
mod point;
pub mod polygon;
mod prism;
mod program;
mod shape;
mod solid;
pub mod surface;
mod trace;
mod vector;

pub use affine::Affine;
pub use curve::{Curve, CurveError};
pub use error::SpaceError;
pub use field::Field;
pub use isolate::isolate;
pub use lie::{leads_inside, lie_direction};
pub use model::{CurveTrace, curve_normal, curve_point, trace_curve, trace_curve_from};
pub use point::Point;
pub use program::Program;
pub use solid::Solid;
pub use trace::{Face, Tracer, trace, trace_along};
