//! The boolean algebra of solids along one ray: root-rays and hit arrays. There is no geometry in here, only times.
//!
//! A [`RootRay`] says on which side of a solid a trajectory starts and at which times it changes sides. Boolean operations on
//! solids become boolean operations on root-rays, whatever the space, the dimension and the curve:
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
//! The algebra is exact: equal times flip together and nothing is compared with a tolerance, so every law of boolean algebra
//! holds bit for bit. Pieces too thin to mean anything are dropped once, at the end, by [`RootRay::weld`].
//! [`hit_array`] does the same for many rays at once, in arrays of one column per ray. [`seed`] holds the functions of the
//! module that root-rays come from.
//!
//! Invariants of absence: this crate knows no vectors, no surfaces, no files; no threads but those that cut large hit arrays.

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
