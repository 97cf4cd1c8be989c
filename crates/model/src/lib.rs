//! Solids as boolean expressions, compiled once into a flat program.
//!
//! - [`Solid`]: what people build: shapes, transforms, boolean operators, names. Cheap to clone.
//! - [`Program`]: what evaluators read: boolean skeletons, a leaf table, shared surfaces. Immutable.
//! - [`Evaluator`]: the trait between the two sides, with its rays, queries and answers.
//!
//! The rules about what is true along a ray that every evaluator shares (when crossings are welded, to
//! which face they belong, what their normal is) are here too, each once: [`weld`] and [`attributes`].

pub mod attributes;
pub mod drive;
pub mod gate;
pub mod plain;
pub mod simplify;
pub mod weld;

mod approximate;
mod boxes;
mod chord;
mod columns;
mod compile;
mod error;
mod evaluator;
mod events;
mod expression;
mod ids;
mod instances;
mod label;
mod leaf;
mod lower;
mod print;

mod program;
mod rays;
mod solid;
mod sweep;
mod tables;

pub use approximate::{ApproximateColumns, ApproximateEvaluator};
pub use chord::{Ball, chord};
pub use columns::{CrossingColumns, FirstHits, HitRows};
pub use error::{CompileError, CompileProblem};
pub use evaluator::{
    Collected, Crossing, Evaluator, Face, Limit, Query, RayAnswer, Sink, Start, StartLists, State, Window,
    WindowError,
};
pub use events::{Event, GroupPoint, GroupRay, LeafEvents, carried, facets_contain, leaf_events};
pub use expression::{Edge, Expression, Gate, Rule};
pub use ids::{LeafId, NodeId, PlacementId, PrototypeId, RegionId, SurfaceId};
pub use instances::Place;
pub use leaf::{Leaf, LeafFacet, LeafKind};
pub use program::{MARGIN, Medium, Program, Prototype, RegionInfo, SurfaceEntry};
pub use rays::{BadRay, RayBatch, Rays};
pub use solid::{Node, Region, Solid};
pub use sweep::{NetworkFlips, Sweep};
