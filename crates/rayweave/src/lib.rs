//! Exact ray tracing through constructive solid geometry.

mod compiled;
mod error;
mod evaluator;

pub mod files;
pub mod shapes;

pub use rayweave_math as math;
pub use rayweave_model as model;
pub use rayweave_render as render;
pub use rayweave_rootray as rootray;
pub use rayweave_scene as scene;
pub use rayweave_shape as shape;
pub use rayweave_table as table;
pub use rayweave_trace as trace;

pub use compiled::Compiled;
pub use error::{Error, ErrorKind};
pub use evaluator::{AnyEvaluator, AnyScratch};
pub use rayweave_math::{Affine, Bounds, Vec3};
pub use rayweave_model::{Crossing, Evaluator, Program, Query, Region, Solid, Window};
pub use rayweave_shape::Ray;
pub use rayweave_trace::{Reference, Weave};
