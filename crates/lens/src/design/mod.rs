//! Lens design: tolerance analysis and optimisation of prescriptions.
//!
//! A [`DesignParameter`] is a number of a prescription, with a name such as `radius 2` or `tilt x 3-4`.
//! [`Tolerancing`] computes the effect of random errors of parameters on a [`Merit`]; [`Optimiser`] computes
//! the parameter values that best satisfy a list of goals. Both follow rays from surface to surface
//! ([`Prescription::follow`](crate::prescription::Prescription::follow)) through the paraxial entrance pupil,
//! without regard to semi-diameters, and build no solids.
//!
//! ```
//! use rayweave_lens::design::{Goal, Merit, Operand, Optimiser, Spread, Tolerancing};
//! use rayweave_lens::prescription::{Behind, Prescription, Surface};
//!
//! let start = Prescription::new(vec![
//!     Surface::new(100.0, 4.0, Behind::Glass("N-BK7".to_owned())),
//!     Surface::new(-100.0, 95.0, Behind::Air),
//! ])
//! .entrance_pupil_diameter(10.0);
//! let found = Optimiser::new(&start)
//!     .vary("curvature 1".parse()?)
//!     .vary("curvature 2".parse()?)
//!     .vary("thickness 2".parse()?)
//!     .goal(Goal::equal(Operand::FocalLength, 80.0).weight(10.0))
//!     .goal(Goal::equal(Operand::Spot { field: 0, wavelength_nm: None }, 0.0))
//!     .run()?;
//! assert!((found.lens.first_order(587.5618)?.focal_length - 80.0).abs() < 1e-3);
//!
//! let trials = Tolerancing::new(&found.lens, Merit::FocalLength)
//!     .add("radius 1".parse()?, Spread::Uniform(0.1))
//!     .trials(200)?;
//! assert!((trials.quantile(0.5) - 80.0).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod merit;
mod modulation;
mod operand;
mod optimise;
mod parameter;
mod tolerance;
mod value;
mod variant;

pub use error::DesignError;
pub use merit::Merit;
pub use modulation::{MtfKind, MtfLines};
pub use operand::{Goal, Operand, SeidelTerm, Target};
pub use optimise::{GoalReport, Optimiser, Optimum};
pub use parameter::{DesignParameter, Quantity};
pub use tolerance::{Sensitivity, Spread, Tolerancing, Trials};
