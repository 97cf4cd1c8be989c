//! Solids as boolean expressions, compiled once into a flat program.
//!
//! - [`Solid`]: a tree of shapes, transforms, boolean operators and names, as users build it. Cheap to clone.
//! - [`Program`]: the compiled form that evaluators use: expressions, leaf table, shared surfaces. Immutable.
//! - [`Evaluator`]: the trait that answers ray queries on a program, with its rays, queries and answers.
//!
//! The rules that all evaluators share are implemented here, each once: when crossings are welded and to
//! which face they belong ([`weld`]), and their points and normals ([`attributes`]).

pub mod attributes;
pub mod drive;
pub mod gate;
pub mod memory;
pub mod plain;
pub mod simplify;
pub mod weld;

mod approximate;
mod boxes;
mod chord;
mod columns;
mod compile;
mod copies;
mod distance;
mod error;
mod evaluator;
mod events;
mod expression;
mod ids;
mod instances;
mod label;
mod leaf;
mod lower;
mod number_map;
mod occurrence;
mod print;
mod program;
mod rays;
mod size;
mod solid;
mod sweep;
mod tables;
mod trail;

pub use approximate::{ApproximateColumns, ApproximateEvaluator};
pub use chord::{Ball, chord};
pub use columns::{CrossingColumns, FirstHits, HitArrayRows};
pub use copies::Copies;
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
pub use occurrence::{Occurrence, OccurrencePath, PathStep};
pub use program::{MARGIN, Medium, Program, Prototype, RegionInfo, SurfaceEntry};
pub use rays::{BadRay, RayBatch, Rays};
pub use size::check_repetition;
pub use solid::{Node, Region, Solid};
pub use sweep::{NetworkLeafStates, Sweep};
