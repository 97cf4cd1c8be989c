//! Drawings as SVG and DXF, and pictures of scenes arranged on sheets.
//!
//! | drawing | functions and types |
//! | --- | --- |
//! | pictures of scenes, cut-away and exploded views, sheets | [`picture`] |
//! | layouts of optical systems | [`layout`] |
//! | spot diagrams and maps of irradiance | [`detector`] |
//! | time lines of rays | [`Timeline`], [`ray_timeline`] |
//! | cross-sections, as SVG and DXF | [`section`] |
//! | technical drawings: views with dimensions | [`technical`] |
//! | infill | [`InfillPicture`] |
//!
//! [`svg`] writes the few elements that all drawings share; [`axis`] maps values to positions and formats numbers.
//!
//! This crate reads and writes no files and depends on no particular evaluator; functions that need one are generic over
//! [`Evaluator`](rayweave_model::Evaluator).

mod all_edges;
pub mod axis;
pub mod detector;
mod dimension;
mod edges;
mod error;
mod indications;
mod infill;
pub mod layout;
mod legend;
mod lens_element;
pub mod picture;
mod plan;
pub mod section;
pub mod svg;
pub mod technical;
mod timeline;

pub use edges::{EdgeView, visible_edges};
pub use error::DrawError;
pub use indications::Indications;
pub use infill::InfillPicture;
pub use lens_element::{ElementFace, LensElement, lens_element_drawing, lens_group_drawing};
pub use timeline::{Timeline, TimelineError, ray_timeline};
