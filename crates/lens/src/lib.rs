//! Lens design: sequential prescriptions, their paraxial data and aberrations, tolerances and optimisation.
//!
//! - [`prescription`]: sequential lens data, read from and written to Zemax files, with conversion to beams
//!   and to the solids of a [`System`](rayweave_optics::System).
//! - [`paraxial`]: ray transfer matrices, focal lengths, pupils, Petzval and Seidel sums.
//! - [`analysis`]: spots, ray fans, wavefronts, Zernike fits, encircled energy and geometric MTF of the rays
//!   that arrive at a sheet, in prescriptions and in any other system.
//! - [`design`]: Monte Carlo tolerancing, and optimisation by damped least squares.
//!
//! Solids, media and ray tracing come from [`rayweave_optics`].
//!
//! ```
//! use rayweave_lens::prescription::{Behind, Prescription, Surface};
//!
//! let singlet = Prescription::new(vec![
//!     Surface::new(50.0, 4.0, Behind::Glass("N-BK7".to_owned())),
//!     Surface::new(-50.0, 47.0, Behind::Air),
//! ])
//! .entrance_pupil_diameter(10.0);
//! assert!((singlet.first_order(587.5618)?.focal_length - 49.04).abs() < 0.01);
//! # Ok::<(), rayweave_lens::prescription::PrescriptionError>(())
//! ```

pub mod analysis;
pub mod design;
pub mod paraxial;
pub mod prescription;
