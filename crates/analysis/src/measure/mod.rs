//! Measurement of regions: volume, centre, inertia, surface area, each with a confidence interval.
//!
//! Random rays parallel to x, y and z sample a box. The cross-section of the box is divided into equal cells
//! with two rays at random positions each (stratified sampling; W. G. Cochran, *Sampling Techniques*, 3rd
//! ed., 1977, chapter 5). A chord of a region contributes its length, and the integrals of the coordinates
//! and of their products along it, which are closed forms:
//!
//! ```text
//!   volume    V = sum over cells of  A (l1 + l2) / 2          A: the area of a cell, l: the length of a ray in the region
//!   variance      sum over cells of  A^2 (l1 - l2)^2 / 4
//! ```
//!
//! Both are unbiased; each axis gives a separate estimate, and the mean is reported. The stratification makes
//! the error decrease faster than with the square root of the number of rays: for a smooth boundary, nearly with its
//! power of 3/4.
//!
//! The surface area comes from the crossings of the same rays. With `n` the unit normal, `n_x^2 + n_y^2 +
//! n_z^2 = 1`, and a piece of surface of area `dS` has the projected area `|n_x| dS` for the rays along x. So
//!
//! ```text
//!   S = integral of |n_x| over what the rays along x cross + the same for y and z
//! ```
//!
//! with weights of at most 1, whereas one direction alone would need the unbounded weight 1 / |n_x|.
//!
//! A half width is the quantile of the normal distribution times the estimated standard deviation. It reflects only
//! the observed rays, all of which can miss a part much thinner than their spacing. Models with very small parts
//! therefore need more rays than the precision requires. The rays that decide how many more are needed do not count in the result:
//! `plan` states why.

pub(crate) mod cells;
mod chord;
mod error;
mod estimate;
mod exact;
mod moments;
mod plan;
mod run;
mod scene;
mod share;
mod tally;
#[cfg(test)]
mod tests;

pub use chord::MeasuredChord;
pub use error::MeasureError;
pub use estimate::{Estimate, Measured, Measurement};
pub use exact::exact_volume;
pub use run::{MeasureProgress, MeasureSettings, measure, measure_with_progress, one_medium_each};
pub use scene::{
    RegionReport, SceneReport, measure_scene, measure_scene_with_progress, report_shares, share_of_scene,
};
pub use share::{MeasureShare, cell_count};
