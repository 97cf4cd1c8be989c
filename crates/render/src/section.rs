//! Models cut open.

use rayweave_math::Vec3;
use rayweave_model::{Region, Solid};
use rayweave_shape::primitive::{HalfSpace, Primitive, ShapeError};

/// The name of the cut, by which its face is called in answers (`section.plane`).
pub const SECTION: &str = "section";

/// The regions cut by a plane: what lies where `normal . p < offset` stays, and the cut shows the inside as a face.
///
/// Each region keeps its name, its medium and its number, also one that is cut away whole, so that colours stay with their
/// regions. Regions that overlap show at the cut as they win over one another.
///
/// # Errors
/// A normal that is zero or not finite, an offset that is not finite.
pub fn section(regions: &[Region], normal: impl Into<Vec3>, offset: f64) -> Result<Vec<Region>, ShapeError> {
    let half_space = Primitive::from(HalfSpace::new(normal.into(), offset)?);
    let kept = Solid::from(half_space).named(SECTION);
    let cut = |region: &Region| Region { solid: &region.solid & &kept, ..region.clone() };
    Ok(regions.iter().map(cut).collect())
}
