//! Image quality by real ray tracing: spots, wavefronts, MTF, field and colour aberrations.
//!
//! [`arrivals`] extracts the rays of a trace that arrive at a sheet of any
//! [`System`](rayweave_optics::System), in the coordinates of that sheet. The other functions work on these
//! rays:
//!
//! | what | where |
//! | --- | --- |
//! | spot: centroid, RMS and geometric radius, through focus, best focus | [`Spot`], [`through_focus`], [`best_focus`] |
//! | points and weights of the pupil for RMS values | [`PupilQuadrature`] |
//! | encircled energy | [`encircled_energy`], [`encircled_energy_radius`] |
//! | geometric modulation transfer function (MTF) | [`geometric_mtf`] |
//! | wavefront error: optical path difference (OPD) from a reference sphere | [`Wavefront`] |
//! | Zernike polynomials in Noll and OSA/ANSI indexing; least-squares fit | [`ZernikePolynomial`], [`fit_zernike`] |
//!
//! A [`Study`] traces and analyses a prescription field by field, and adds what needs a prescription: ray
//! fans, distortion, field curvature, axial and lateral colour.
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

pub(crate) use arrivals::sequential_arrival;
pub use arrivals::{Arrival, arrivals};
pub use energy::{encircled_energy, encircled_energy_radius, geometric_mtf};
pub use error::LensAnalysisError;
pub(crate) use field::paraxial_height;
pub use field::{Distortion, FieldFoci};
pub(crate) use focus::focal_moments;
pub use focus::{best_focus, defocused, through_focus};
pub(crate) use pupil::gauss_legendre;
pub use pupil::{PupilQuadrature, fan_x, fan_y, hexapolar, square};
pub use spot::Spot;
pub use study::{Fan, Study, needs_aiming};
pub use wavefront::Wavefront;
pub(crate) use wavefront::{reference_radius, weighted_rms, without_piston, without_tilt};
pub use zernike::{ZernikeFit, ZernikePolynomial, fit_zernike};
