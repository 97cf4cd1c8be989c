//! Edges of a section: lines between regions.

use rayweave_model::RegionId;

/// A line between two regions.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionEdge {
    /// The points in order, at least two.
    pub points: Vec<[f64; 2]>,
    /// The region to the left, in the direction of the points; 0 is the world.
    pub left: RegionId,
    /// The region to the right.
    pub right: RegionId,
}
