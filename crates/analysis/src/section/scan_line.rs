//! A scan line and its crossings.

use rayweave_model::{Face, RegionId};

/// A crossing of a scan line from one region into another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanCrossing {
    /// The coordinate along the scan line.
    pub v: f64,
    pub before: RegionId,
    pub after: RegionId,
    /// The face; `None` at the ends of the window.
    pub face: Option<Face>,
}

impl ScanCrossing {
    /// True for crossings between the same regions through the same surface.
    pub fn is_like(&self, other: &ScanCrossing) -> bool {
        // an edge of an outline may consist of several faces, in one surface
        let face = |own: &ScanCrossing| own.face.map(|face| (face.surface, face.placement));
        self.is_between_regions_of(other) && face(self) == face(other)
    }

    /// True for crossings from the same region into the same one.
    pub fn is_between_regions_of(&self, other: &ScanCrossing) -> bool {
        (self.before, self.after) == (other.before, other.after)
    }
}

/// A ray in the plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScanLine {
    pub u: f64,
    /// The crossings from bottom to top; below the first and above the last is the world.
    pub passes: Vec<ScanCrossing>,
}
