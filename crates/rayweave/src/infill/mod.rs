//! The traces that fill a region of the plane, or the layers of a solid: as a table, and as a picture.
//!
//! What scan lines, traces, components and layers are, and how they are numbered, is told in
//! [`rayweave_analysis::infill`], whose names are all here.
//!
//! ```
//! use rayweave::infill::{Filling, Layers, Raster, Run, Slices, infill};
//! use rayweave::polygon::from_polygons;
//! use rayweave::rootray::Side;
//! use rayweave::shapes::{box_from_corners, cylinder};
//! use rayweave::{Error, Program, Weave};
//! use std::sync::Arc;
//!
//! // a drilled plate, in layers 0.5 thick, each turned by 90 degrees from the one below
//! let plate = box_from_corners([0.0, 0.0, 0.0], [20.0, 10.0, 1.0])? - cylinder(3.0, f64::INFINITY)?.translate([10.0, 5.0, 0.0]);
//! let weave = Weave::new(Arc::new(Program::compile(&plate)?));
//! let filling = Filling { raster: Raster::new(0.5, 0.0, 0.5)?, turn: 90.0, alternate: true };
//! let mut traces = 0;
//! let summary = infill(&Slices(&weave), &filling, &Layers::Every(0.5), &Run::default(), |layer| {
//!     traces += layer.traces.len();
//!     Ok::<(), Error>(())
//! })?;
//! assert_eq!((summary.layers, summary.traces), (2, traces as u64));
//! // the traces of a layer, each as wide as the spacing, cover the area of the plate
//! let area = 0.5 * summary.length / 2.0;
//! assert!((area - (200.0 - 9.0 * std::f64::consts::PI)).abs() < 1.0);
//!
//! // a region of the plane is its own only layer
//! let square = from_polygons(&[vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]], Side::Outside)?;
//! let flat = infill(&square, &filling, &Layers::At(vec![0.0]), &Run::default(), |_| Ok::<(), Error>(()))?;
//! assert_eq!(flat.length, 32.0);
//! # Ok::<(), rayweave::Error>(())
//! ```

mod picture;
mod table;

pub use picture::InfillPicture;
pub use rayweave_analysis::infill::*;
pub use table::{InfillTable, write_infill};
