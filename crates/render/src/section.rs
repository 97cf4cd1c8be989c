//! Section views: models cut by a plane.

use rayweave_math::Vec3;
use rayweave_model::{Region, Solid};
use rayweave_shape::primitive::{HalfSpace, Primitive, ShapeError};

/// The name of the cutting half-space; its face appears in results as `section.plane`.
pub const SECTION: &str = "section";

/// Cuts the regions by a plane: the side `normal . p < offset` stays, and the cut is a face of each region.
///
/// Each region keeps its name, medium and number, even if it is cut away entirely, so colours stay with their
/// regions. Overlapping regions keep their priority at the cut.
///
/// # Errors
/// A normal that is zero or not finite, an offset that is not finite.
pub fn section(regions: &[Region], normal: impl Into<Vec3>, offset: f64) -> Result<Vec<Region>, ShapeError> {
    let half_space = Primitive::from(HalfSpace::new(normal.into(), offset)?);
    let kept = Solid::from(half_space).named(SECTION);
    let cut = |region: &Region| Region { solid: &region.solid & &kept, ..region.clone() };
    Ok(regions.iter().map(cut).collect())
}
