//! Analysis of models with any evaluator.
//!
//! - [`measure`](mod@measure): volume, mass, centre, inertia, surface area, with confidence intervals;
//! - [`section`](mod@section): cross-sections by planes;
//! - [`thickness`]: path lengths of rays through media, and radiographs;
//! - [`diff`](mod@diff): comparison of two models;
//! - [`distance`](mod@distance): signed distances and nearest boundary points, with bounds;
//! - [`check`](mod@check): detection of modelling errors;
//! - [`features`]: the extent of a model, the diameters and depths of its cylindrical faces, polygonal holes and steps along the axes;
//! - [`infill`](mod@infill): parallel traces of a tool over a region of the plane, or the layers of a solid;
//! - [`hits`]: streaming of ray files into tables of hits;
//! - [`survey`](mod@survey): chords of random rays in regions, and the thickness of regions; the basis of other
//!   analyses.
//!
//! Functions that compile programs take a function `make` that creates the evaluator of a program.

pub mod check;
#[cfg(test)]
mod counted;
pub mod diff;
pub mod distance;
mod error;
pub mod features;
pub mod hits;
pub mod infill;
pub mod measure;
pub mod section;
mod subject;
pub mod survey;
pub mod thickness;

pub use error::{AnalysisError, Cancelled};
