//! Pictures of compiled models, and time lines of single rays.
//!
//! [`render`] draws a model as people see it: shaded ([`Style`]), with dark lines where something begins or ends ([`Lines`]),
//! anti-aliased, lit and shadowed if asked. [`depth`], [`normals`] and [`ids`] give what the picture is made from as plain
//! numbers, [`geometry`] all three at once. [`png`] turns all of them into files in memory. [`Timeline`] draws what happens along one ray, with the elements
//! of [`svg`].
//!
//! Pixels are counted from the upper left corner; z is up in every [`View`]. The same model, camera and settings give the
//! same bits for any number of threads.
//!
//! Invariants of absence: this crate knows no files of models and names no evaluator: it takes one by its trait.

pub mod axis;
mod camera;
mod closer;
mod colour;
mod columns;
mod contrast;
mod error;
mod extent;
mod gaze;
mod image;
mod light;
mod occlusion;
mod pen;
mod planes;
pub mod png;
mod render;
mod run;
mod sample;
mod section;
mod settings;
mod shade;
mod shadow;
mod survey;
pub mod svg;
mod sweep;
mod timeline;
mod view;
mod wavelength;

pub use camera::{Camera, Projection};
pub use colour::{Linear, PALETTE, Rgba, region_colour};
pub use error::{CameraError, RenderError};
pub use image::{Image, Plane, Size};
pub use light::{Light, LightKind};
pub use planes::{Geometry, IdKind, depth, geometry, ids, normals};
pub use render::render;
pub use run::Run;
pub use section::{SECTION, section};
pub use settings::{Background, Lines, Settings, Style};
pub use timeline::{Timeline, TimelineError};
pub use view::View;
pub use wavelength::wavelength_colour;
