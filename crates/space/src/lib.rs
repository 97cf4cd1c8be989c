//! Curved rays and higher dimensions: tracing along curves (helices, parabolas, arcs, splines) with rigorous root isolation, and
//! constructive solid geometry in R^d.
//!
//! A [`Field`] is a function that is negative inside a solid; a [`Curve`] is a trajectory with a bound on its acceleration.
//! [`isolate`](isolate()) finds all times at which a curve crosses the surface of a field.
//!
//! A [`Solid`] combines half-spaces, boxes, balls, cylinders, cones, quadrics and prisms of any dimension by boolean operators and
//! affine maps; [`trace`](trace()) and [`trace_along`] compute its [root-ray](rayweave_rootray::RootRay) along a line or a curve.
//! [`trace_curve`] traces a curve through a compiled model.

mod affine;
pub mod curve;
mod error;
mod faces;
mod field;
pub mod isolate;
mod model;
mod point;
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
pub use model::{CurveTrace, curve_normal, curve_point, trace_curve, trace_curve_from};
pub use point::Point;
pub use program::Program;
pub use solid::Solid;
pub use trace::{Face, Tracer, trace, trace_along};
