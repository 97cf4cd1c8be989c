//! Boolean algebra of solids along one ray ("Roth's ray algebra"): root-rays and hit arrays.
//!
//! The crate handles only crossing times, no geometry.
//!
//! A [`RootRay`] stores the side of a solid on which a trajectory starts and the times at which it changes sides. Boolean
//! operations on solids become boolean operations on root-rays, in a space of any dimension, along any curve:
//!
//! ```
//! use rayweave_rootray::{RootRay, Side};
//!
//! let ball = RootRay::from_times(Side::Outside, [1.0, 4.0])?;
//! let half_space = RootRay::from_times(Side::Inside, [2.0])?;
//!
//! assert_eq!((&ball & &half_space).to_string(), "outside [1, 2]");
//! assert_eq!((&ball - &half_space).to_string(), "outside [2, 4]");
//! assert_eq!((&ball | &half_space).to_string(), "inside [4]");
//! assert_eq!((&ball ^ &half_space).spans().collect::<Vec<_>>(), [(f64::NEG_INFINITY, 1.0), (2.0, 4.0)]);
//! assert_eq!(!(!&ball), ball);
//! # Ok::<(), rayweave_rootray::RootRayError>(())
//! ```
//!
//! The algebra is exact: equal times toggle together and no comparison uses a tolerance, so every law of boolean algebra holds
//! bit for bit. [`RootRay::weld`] drops pieces thinner than rounding errors once, at the end. [`hit_array`] has these
//! operations for many rays at once, in arrays of one column per ray; `array_csg` keeps pieces of length zero unless it
//! regularises. [`seed`] has the functions of the publication that introduced root-rays.
//!
//! The crate has no vectors, surfaces or files. Only operations on large hit arrays use threads.

mod algebra;
mod count_rule;
mod error;
pub mod hit_array;
mod min_sep;
mod operators;
mod root_ray;
pub mod seed;
mod side;
mod surface_count;
mod validate;
mod weld;
mod window;

pub use count_rule::CountRule;
pub use error::{Problem, RootRayError};
pub use min_sep::min_sep;
pub use root_ray::{Root, RootRay};
pub use side::Side;
pub use surface_count::{SurfaceCount, surface_count};
pub use validate::validate_times;
pub use weld::{next_run, weld_runs};
