//! How large the regions of a model are: volume, centre, inertia, surface area, each with a confidence interval.
//!
//! Rays are drawn parallel to x, y and z through a box. The cross-section of the box is cut into equal cells, and each cell gets
//! two rays at random places (stratified sampling; W. G. Cochran, *Sampling Techniques*, 3rd ed., 1977, chapter 5). A piece of a
//! ray within a region counts with its length, and with the integrals of the coordinates and of their products along it, which
//! are closed forms:
//!
//! ```text
//!   volume    V = sum over cells of  A (l1 + l2) / 2          A: the area of a cell, l: the length of a ray in the region
//!   variance      sum over cells of  A^2 (l1 - l2)^2 / 4
//! ```
//!
//! Both are unbiased; every axis gives an estimate of its own, and their mean is reported. The cells make the error fall faster
//! than the root of the number of rays: nearly as its 3/4-th power where the boundary is smooth.
//!
//! The surface area comes from the crossings of the same rays. With `n` the unit normal, `n_x^2 + n_y^2 + n_z^2 = 1`, and a
//! piece of surface of area `dS` shows the area `|n_x| dS` to the rays along x. So
//!
//! ```text
//!   S = integral of |n_x| over what the rays along x cross + the same for y and z
//! ```
//!
//! with weights that are never above 1, whereas one direction alone would need the weight 1 / |n_x|, which has no bound.
//!
//! A half width is the quantile of the normal distribution times the estimated deviation. It covers only the observed rays: all
//! of them may miss a part much thinner than their distance. Models with very small parts therefore need more rays than the
//! precision requires. Rounds of rays are added until the precision is reached, which makes intervals
//! slightly too short on average (by less than the estimate of the deviation varies).

pub(crate) mod cells;
mod chord;
mod error;
mod estimate;
mod exact;
mod moments;
mod run;
mod scene;
mod tally;
#[cfg(test)]
mod tests;

pub use chord::Chord;
pub use error::MeasureError;
pub use estimate::{Estimate, Measured, Measurement};
pub use exact::exact_volume;
pub use run::{Settings, measure, one_medium_each};
pub use scene::{RegionReport, SceneReport, measure_scene};
