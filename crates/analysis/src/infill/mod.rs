//! Infill: parallel traces that fill a region of the plane or the layers of a solid.
//!
//! A tool of width *spacing* (a laser, a nozzle, a cutter) covers a region by running along parallel *scan
//! lines*. A *trace* is a piece of a scan line within the region, from where the line enters it to where it
//! leaves.
//!
//! ```text
//!   scan line 4     -----------+=2=+-----------------------------
//!   scan line 3     --+==0==+------------------+===1===+---------   level (3 + phase) spacing
//!   scan line 2     --+=====0=====+--------+====1====+-----------   level (2 + phase) spacing
//!   scan line 1     ----+==0==+-----------------+==1==+----------   level (1 + phase) spacing
//!   scan line 0     --------+===0===+----------------------------   level (0 + phase) spacing
//!                   --> direction: `angle` degrees from +x towards +y
//! ```
//!
//! **Scan lines** are numbered on one grid for the whole plane: line k is the set of points p with `p . (-sin
//! angle, cos angle) = (k + phase) spacing`, independent of the region, so that the lines of neighbouring
//! layers and of separately filled parts are aligned. With a turn, layer j has the angle `angle + j turn`,
//! and its own grid.
//!
//! **Components**: two traces on adjacent scan lines are connected if they overlap, that is if their ranges
//! along the direction have more than a point in common; a component is a connected set of traces of one
//! layer. Components are numbered from 0 in the order in which their first traces are listed. In the picture,
//! the trace of scan line 0 overlaps the left one of scan line 1, so both are in component 0; the trace of scan
//! line 4 overlaps none of scan line 3 and is a separate component. A tool fills a component in steps from one
//! line to the next, without long moves outside the region. (A sharp tip nearly parallel to the scan lines,
//! whose traces do not overlap, is divided into separate components.)
//!
//! **Order**: layer by layer, line by line, along each line in its direction. With alternating directions,
//! lines with an odd number are run backwards: their traces are listed in the opposite order, with their ends
//! swapped.
//!
//! A scan line in a face of the region follows the rule of symbolic perturbation for rays in a surface: it
//! is treated as moved infinitesimally along the fixed vector w, which points towards +x and +y (and +z). A
//! square from 0 to 10 therefore gets lines 0 to 9 with spacing 1, phase 0 and angle 0, and the lengths of
//! all traces times the spacing are its area.
//!
//! ```
//! use rayweave_analysis::infill::{Filling, InfillError, Layers, Raster, InfillRun, Slices, infill};
//! use rayweave_model::{Program, Solid};
//! use rayweave_rootray::Side;
//! use rayweave_shape::primitive::build;
//! use rayweave_polygon::from_polygons;
//! use rayweave_trace::Weave;
//! use std::sync::Arc;
//!
//! // a drilled plate, in layers 0.5 thick, each turned by 90 degrees from the one below
//! let block = Solid::from(build("box", &[("size", (&[20.0, 10.0, 1.0][..]).into())])?).translate([10.0, 5.0, 0.5]);
//! let hole = Solid::from(build("cylinder", &[("radius", 3.0.into()), ("height", f64::INFINITY.into())])?);
//! let plate = block - hole.translate([10.0, 5.0, 0.0]);
//! let weave = Weave::new(Arc::new(Program::compile(&plate)?));
//! let filling = Filling { raster: Raster::new(0.5, 0.0, 0.5)?, turn: 90.0, alternate: true };
//! let mut traces = 0;
//! let summary = infill(&Slices(&weave), &filling, &Layers::Every(0.5), &InfillRun::default(), |layer| {
//!     traces += layer.traces.len();
//!     Ok::<(), InfillError>(())
//! })?;
//! assert_eq!((summary.layers, summary.traces), (2, traces as u64));
//! // the traces of a layer, each as wide as the spacing, cover the area of the plate
//! let area = 0.5 * summary.length / 2.0;
//! assert!((area - (200.0 - 9.0 * std::f64::consts::PI)).abs() < 1.0);
//!
//! // a region of the plane is its own only layer
//! let square = from_polygons(&[vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]], Side::Outside)?;
//! let (layers, run) = (Layers::At(vec![0.0]), InfillRun::default());
//! let flat = infill(&square, &filling, &layers, &run, |_| Ok::<(), InfillError>(()))?;
//! assert_eq!(flat.length, 32.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod component;
mod contours;
mod error;
mod layers;
mod problems;
mod raster;
mod region;
mod run;
mod table;
#[cfg(test)]
mod tests;

pub use contours::read_region;
pub use error::InfillError;
pub use layers::Layers;
pub use problems::ContourProblems;
pub use raster::Raster;
pub use region::{Fillable, Slices};
pub use run::{Filling, InfillRun, InfillTrace, LayerTraces, Summary, infill};
pub use table::{InfillTable, write_infill};
