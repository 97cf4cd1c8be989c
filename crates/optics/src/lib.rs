//! Optics: non-sequential ray tracing of light in the solids of a model.
//!
//! An [`Assembly`] of [`Element`]s (solids of a [`Material`], and sheets) compiles to a [`System`].
//! A [`Tracer`] traces light, a [`Beam`] or any other [`Emitter`], through the system and returns
//! the [`Segments`] of all rays and the power [`Balance`]. Light is refracted and reflected at the
//! interfaces between media, independent of the shapes that bound them: cemented, immersed and
//! nested elements need no gaps.
//!
//! - [`interface`]: the physics of one event (Snell's law, Fresnel equations, thin films, gratings,
//!   Stokes parameters)
//! - [`glass`]: refractive indices and absorption; [`gradient`]: gradient-index media
//! - [`component`]: lenses, mirrors, prisms, concentrators and sheets
//! - [`source`]: light sources with spectrum and power
//! - [`file`](mod@file): the `[optics]` tables of model files; [`table`]: tables of results
//! - [`detector`]: binning of the light that arrives at sheets
//!
//! ```
//! use rayweave_model::Solid;
//! use rayweave_optics::{Assembly, Beam, Element, Light, Medium, TraceSettings, Tracer};
//! use rayweave_shape::primitive::{Primitive, Sphere};
//! use rayweave_trace::Packets;
//!
//! // a ball lens of radius 10 focuses light near its axis at n R / (2 (n - 1)) from its centre
//! let ball = Solid::from(Primitive::from(Sphere::new(10.0)?));
//! let glass = Medium::constant("glass", 1.5, 0.0)?;
//! let system = Assembly::new().add(Element::transparent("ball", ball, &glass)).compile()?;
//! let beam: Beam = [Light::new([0.01, 0.0, -50.0], [0.0, 0.0, 1.0], 587.6)].into_iter().collect();
//! let trace = Tracer::new(&system, Packets::new).trace(&beam, &TraceSettings::default())?;
//! let last = trace.segments.iter().last().ok_or("no segment")?;
//! let focus = last.start.z - last.start.x * last.direction.z / last.direction.x;
//! assert!((focus - 15.0).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod beam;
mod bundle;
pub mod component;
pub mod detector;
mod element;
mod error;
pub mod file;
pub mod glass;
pub mod gradient;
pub mod interface;
mod medium;
mod paths;
mod phase;
mod scatter;
mod segments;
mod settings;
pub mod source;
pub mod start_surfaces;
mod system;
pub mod table;
mod trace;

pub use beam::{Beam, Emitter, Light};
pub use element::{Action, Body, Element, Finish, Material};
pub use error::OpticsError;
pub use medium::{Index, Medium};
pub use paths::{Path, Paths};
pub use phase::Phases;
pub use segments::{Balance, Event, Segment, Segments};
pub use settings::{Branches, Keep, TraceSettings};
pub use system::{Assembly, System};
pub use trace::{RowLimit, Trace, Tracer};
