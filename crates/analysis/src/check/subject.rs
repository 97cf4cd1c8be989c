//! The model under check.

use super::Hierarchy;
use rayweave_math::Bounds;
use rayweave_model::{Region, Solid};

/// The model under check.
pub(super) struct Subject<'a> {
    pub regions: &'a [Region],
    /// The regions before the restriction to a box, if there is one.
    pub whole: Option<&'a [Region]>,
    /// The boxes of the regions, without subtraction of later regions.
    pub boxes: Vec<Bounds>,
    pub hierarchy: Option<&'a Hierarchy>,
}

impl Subject<'_> {
    /// The name of a region.
    pub fn name(&self, region: usize) -> &str {
        &self.regions[region].name
    }

    /// The unrestricted solid of a region, if the check is restricted to a box.
    pub fn beyond(&self, region: usize) -> Option<&Solid> {
        self.whole.map(|whole| &whole[region].solid)
    }

    /// True if one of the regions is an ancestor of the other in the hierarchy.
    pub fn are_kin(&self, a: usize, b: usize) -> bool {
        self.hierarchy.is_some_and(|known| known.is_within(a, b) || known.is_within(b, a))
    }
}
