//! Analysis of images from real rays.
//!
//! Light is traced through a [`System`](rayweave_optics::System), of whatever kind; [`arrivals`] picks the rays that come to a sheet,
//! in the coordinates of that sheet, and the rest works on these:
//!
//! | what | where |
//! | --- | --- |
//! | spot: centroid, RMS and geometric radius, through focus, best focus | [`Spot`], [`through_focus`], [`best_focus`] |
//! | encircled energy | [`encircled_energy`], [`radius_of_energy`] |
//! | geometric modulation transfer | [`geometric_mtf`] |
//! | wavefront against a reference sphere | [`Wavefront`] |
//! | Zernike polynomials by Noll's and the OSA/ANSI index, fits | [`Zernike`], [`fit`] |
//!
//! A [`Study`] does so for a prescription, field by field, and adds what only a prescription has: ray fans, distortion, field
//! curvature, axial and lateral colour.
//!
//! ```
//! use rayweave_lens::analysis::{Spot, Study, hexapolar};
//! use rayweave_lens::prescription::{Behind, Prescription, Surface};
//! use rayweave_optics::Tracer;
//! use rayweave_trace::Packets;
//!
//! let lens = Prescription::new(vec![Surface::new(-200.0, -100.0, Behind::Mirror).conic(-1.0)])
//!     .entrance_pupil_diameter(20.0);
//! let layout = lens.assembly()?;
//! let system = layout.assembly.compile()?;
//! let tracer = Tracer::new(&system, Packets::new);
//! let study = Study::new(&lens, &layout, &tracer);
//! let spot = Spot::of(&study.arrivals(0, 550.0, &hexapolar(6))?).ok_or("no ray arrives")?;
//! assert!(spot.rms < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arrivals;
mod colour;
mod energy;
mod error;
mod field;
mod focus;
mod pupil;
mod spot;
mod study;
mod wavefront;
mod zernike;

pub(crate) use arrivals::followed;
pub use arrivals::{Arrival, arrivals};
pub use energy::{encircled_energy, geometric_mtf, radius_of_energy};
pub use error::AnalysisError;
pub use field::{Distortion, FieldFoci};
pub(crate) use focus::focal_moments;
pub use focus::{best_focus, moved, through_focus};
pub use pupil::{fan_x, fan_y, hexapolar, square};
pub use spot::Spot;
pub use study::{Fan, Study};
pub use wavefront::Wavefront;
pub(crate) use wavefront::reference_radius;
pub use zernike::{Fit, Zernike, fit};
