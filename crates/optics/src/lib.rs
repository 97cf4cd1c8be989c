//! Optics: what light does in the solids of a model.
//!
//! An [`Assembly`] of [`Element`]s, solids of a [`Material`] and sheets, is compiled into a [`System`]; a [`Tracer`] sends
//! light through it, a [`Beam`] or any other [`Emitter`], and answers with the [`Segments`] of all rays and a [`Balance`] of
//! power. Light is refracted and reflected where media meet, whatever the shapes that bound them: cemented, immersed and
//! nested parts need no gaps. [`interface`] holds the physics of one such event, [`glass`] the indices of refraction,
//! [`component`] lenses, mirrors and prisms, [`source`] what shines, [`file`](mod@file) reads the `[optics]`
//! tables of model files, [`gradient`] are media whose index changes from place to place.
//!
//! [`prescription`] makes solids of lenses as designers write them, surface by surface, [`paraxial`] tells their focal lengths,
//! pupils and aberration sums, and [`analysis`] makes spots, wavefronts and aberrations of real rays, in these and any other
//! systems. [`design`] tells what errors of making do to them, and looks for better ones.
//!
//! ```
//! use rayweave_model::Solid;
//! use rayweave_optics::{Assembly, Beam, Element, Light, Medium, Settings, Tracer};
//! use rayweave_shape::primitive::{Primitive, Sphere};
//! use rayweave_trace::Packets;
//!
//! // a ball lens of radius 10 focuses light near its axis at n R / (2 (n - 1)) from its centre
//! let ball = Solid::from(Primitive::from(Sphere::new(10.0)?));
//! let glass = Medium::constant("glass", 1.5, 0.0)?;
//! let system = Assembly::new().add(Element::transparent("ball", ball, &glass)).compile()?;
//! let beam: Beam = [Light::new([0.01, 0.0, -50.0], [0.0, 0.0, 1.0], 587.6)].into_iter().collect();
//! let trace = Tracer::new(&system, Packets::new).trace(&beam, &Settings::default())?;
//! let last = trace.segments.iter().last().ok_or("no segment")?;
//! let focus = last.start.z - last.start.x * last.direction.z / last.direction.x;
//! assert!((focus - 15.0).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod abreast;
pub mod analysis;
mod beam;
pub mod component;
pub mod design;
mod element;
mod error;
pub mod file;
mod foresee;
mod generation;
pub mod glass;
pub mod gradient;
mod indices;
mod interact;
pub mod interface;
mod medium;
mod near;
pub mod paraxial;
mod paths;
mod phase;
pub mod prescription;
mod segments;
mod settings;
pub mod source;
mod system;
mod trace;

pub use beam::{Beam, Emitter, Light};
pub use element::{Action, Body, Element, Finish, Material};
pub use error::OpticsError;
pub use medium::{Index, Medium};
pub use paths::{Path, Paths};
pub use phase::Phases;
pub use segments::{Balance, Event, Segment, Segments};
pub use settings::{Branches, Keep, Settings};
pub use system::{Assembly, System};
pub use trace::{Trace, Tracer};

/// The code of the guide runs with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guides/lens-design.md")]
mod guide {}

/// The code of the guide to gradients.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guides/gradient-index.md")]
mod guide_to_gradients {}
