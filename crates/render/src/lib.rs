//! Rendering of compiled models: shaded pictures and images of depth, normals and ids.
//!
//! [`render`] draws a shaded ([`Style`]) and anti-aliased picture of a model, with outlines and creases
//! ([`Lines`]), lights and shadows. [`depth`], [`normals`] and [`ids`] compute images of plain numbers,
//! [`geometry`] all three at once. [`png`] encodes images as PNG files in memory.
//!
//! Pixels are counted from the upper left corner; z is up in every [`View`]. The same model, camera and
//! settings give the same bits for any number of threads.
//!
//! This crate reads no model files and depends on no particular evaluator; functions are generic over
//! [`Evaluator`].
//!
//! [`Evaluator`]: rayweave_model::Evaluator

mod camera;
mod camera_rays;
mod colour;
mod columns;
mod contrast;
mod error;
mod extent;
mod first_pass;
mod image;
mod light;
mod limits;
mod occlusion;
mod pen;
mod planes;
pub mod png;
mod primary;
mod render;
mod run;
mod sample;
mod section;
mod settings;
mod shade;
mod shadow;
mod supersampling;
mod sweep;
mod view;
mod wavelength;

pub use camera::{Camera, Projection};
pub use colour::{Linear, PALETTE, Rgba, region_colour};
pub use error::{CameraError, RenderError};
pub use image::{Image, PixelGrid, Size};
pub use light::{Light, LightKind};
pub use planes::{Geometry, IdKind, depth, geometry, ids, normals};
pub use render::render;
pub use run::Run;
pub use section::{SECTION, section};
pub use settings::{Background, Lines, RenderOptions, Style};
pub use view::View;
pub use wavelength::wavelength_colour;
