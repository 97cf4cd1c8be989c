//! OpenSCAD's flattened dump, `.csg`: the output of `openscad -o model.csg model.scad`.
//!
//! A dump has no variables and no loops, only nested items with arguments. Round shapes are exactly round unless
//! [`Options::facets`](crate::Options) selects the facets of OpenSCAD.
//!
//! *Source*: the OpenSCAD user manual, chapters "CSG modelling", "Primitive solids", "2D primitives", "Transformations";
//! vertices of faceted shapes as in OpenSCAD 2021.01.

mod arguments;
mod body;
mod boolean;
mod budget;
mod convex_hull;
mod drawing;
mod dxf;
mod extent;
mod extrude;
mod facets;
mod flat;
mod fold;
mod gather;
mod hull;
mod hull2;
mod import;
mod mesh;
mod offset;
mod operation;
mod part;
mod primitive;
mod projection;
mod reader;
mod region;
mod relief;
mod revolve;
mod sector;
mod shared;
mod shell;
mod state;
mod sum;
mod svg;
mod syntax;
mod text;
mod token;
mod transform;
mod value;

use crate::{Options, Report};
use rayweave_scene::{Diagnostics, Scene, Source};
use std::sync::Arc;

/// Reads a dump. Unsupported items are refused and listed in the report.
///
/// # Errors
///
/// Syntax errors: misplaced tokens, unbalanced braces, numbers beyond the range of `f64`; an item that exceeds the work or
/// the memory that a file of this size may take; references to files that the dump may not read.
pub fn read(source: &Arc<Source>, options: &Options) -> Result<(Scene, Report), Diagnostics> {
    let tree = syntax::parse(source)?;
    let budget = budget::Budget::new(source.text().len());
    state::Reader::new(source, options, &tree, &budget).scene()
}
