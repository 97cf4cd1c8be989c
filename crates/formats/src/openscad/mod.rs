//! OpenSCAD's flattened dump, `.csg`: what `openscad -o model.csg model.scad` writes.
//!
//! A dump holds no variables and no loops: items with arguments, in each other. Round shapes are truly round here, unless
//! [`Options::facets`](crate::Options) asks for the facets that OpenSCAD makes of them.
//!
//! *Source*: the OpenSCAD user manual, chapters "CSG modelling", "Primitive solids", "2D primitives", "Transformations";
//! vertices of faceted shapes as OpenSCAD 2021.01 places them.

mod arguments;
mod body;
mod boolean;
mod convex_hull;
mod drawing;
mod dxf;
mod extrude;
mod facets;
mod flat;
mod gather;
mod hull;
mod hull2;
mod import;
mod mesh;
mod offset;
mod part;
mod primitive;
mod reader;
mod region;
mod relief;
mod revolve;
mod shell;
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

/// Reads a dump. What cannot be read of it is refused, and told in the report.
///
/// # Errors
///
/// What keeps the text from being a dump at all: words out of place, braces that do not match, numbers beyond the range
/// of `f64`.
pub fn read(source: &Arc<Source>, options: &Options) -> Result<(Scene, Report), Diagnostics> {
    let tree = syntax::parse(source)?;
    Ok(reader::Reader::new(source, options, &tree).scene())
}
