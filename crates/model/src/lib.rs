//! Solids as boolean expressions, compiled once into a flat program.
//!
//! - [`Solid`]: the tree of shapes, transforms, boolean operators and names that users build; cheap to clone.
//! - [`Program`]: the immutable compiled form, with expressions, a table of leaves and shared surfaces.
//! - [`Evaluator`]: the trait of evaluators, which compute the crossings of rays with a program; [`Query`] and
//!   [`RayAnswer`] are its input and output.
//!
//! The rules that all evaluators share are implemented here, each once: [`weld`] merges coincident crossings and
//! attributes each crossing to a face; [`attributes`] computes points and normals.

pub mod attributes;
pub mod drive;
pub mod gate;
pub mod memory;
pub mod plain;
pub mod simplify;
pub mod weld;

mod approximate;
mod boundary;
mod box_cells;
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
mod load;
mod lower;
mod name_map;
mod number_map;
mod occurrence;
mod pixels;
mod points;
mod print;
mod program;
mod rays;
mod rings;
mod size;
mod solid;
mod sweep;
mod tables;
mod trail;

pub use approximate::{ApproximateColumns, ApproximateEvaluator};
pub use boundary::{Boundary, Facets, FlatFace, MAX_POINTS, Motion, Swept};
pub use box_cells::{AxisBox, BoxCell, BoxCells, BoxStart};
pub use chord::{Ball, chord};
pub use columns::{CrossingColumns, FirstHitColumns, FirstHits, HitArrayRows};
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
pub use load::RayLoad;
pub use name_map::{NameHasher, NameMap, NameState};
pub use occurrence::{Occurrence, OccurrencePath, PathStep};
pub use pixels::{PixelCamera, PixelRays, RaySource};
pub use points::BadPoint;
pub use program::{MARGIN, Medium, Program, Prototype, RegionInfo, SurfaceEntry};
pub use rays::{BadRay, RayBatch, Rays};
pub use rings::Ring;
pub use size::{check_repetition, expanded_size};
pub use solid::{Node, Region, Solid};
pub use sweep::{NetworkLeafStates, Sweep};
