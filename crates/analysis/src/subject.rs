//! Selection of the regions that an analysis covers.

use crate::AnalysisError;
use rayweave_math::Bounds;
use rayweave_model::{Region, Solid};
use rayweave_scene::{Medium, Scene};
use rayweave_shape::primitive::{BoxFromCorners, Primitive};

/// The regions of a scene, or one of its solids as the only region, each with its medium.
pub(crate) fn subject<'a>(
    scene: &'a Scene,
    solid: Option<&str>,
) -> Result<(Vec<Region>, Vec<Option<&'a Medium>>), AnalysisError> {
    let medium = |number: u32| scene.media.get(number as usize);
    let Some(name) = solid else {
        let regions = scene.model_regions();
        let media = regions.iter().map(|region| medium(region.medium)).collect();
        return Ok((regions, media));
    };
    let solid = scene.find_solid(name)?;
    let last = scene.regions.iter().rev().find(|region| region.solid.is_same(solid));
    // a solid that is no region has no medium: a number that the scene does not have
    let medium_number = last.map_or(u32::MAX, |region| region.medium);
    let region = Region { name: name.to_owned(), solid: solid.clone(), medium: medium_number };
    Ok((vec![region], vec![last.and_then(|region| medium(region.medium))]))
}

/// Clips regions to a box.
pub(crate) fn clipped(regions: Vec<Region>, within: Option<Bounds>) -> Result<Vec<Region>, AnalysisError> {
    let Some(within) = within else { return Ok(regions) };
    let frame: Solid = Primitive::from(BoxFromCorners::new(within.lo, within.hi)?).into();
    Ok(regions.into_iter().map(|region| Region { solid: &region.solid & &frame, ..region }).collect())
}
