//! Results of comparisons.

use super::Match;
use crate::measure::{Estimate, MeasuredChord};
use rayweave_math::{Bounds, Vec3};
use rayweave_scene::Unit;

/// The result of a comparison.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct DiffReport {
    /// The unit of all lengths: that of the first model.
    pub unit: Unit,
    /// The matching of regions; never [`Match::Auto`].
    pub by: Match,
    /// The accepted thickness of differences.
    pub distance: f64,
    /// The pairs, in the order of the first model; regions that exist only in the second model come last.
    pub pairs: Vec<Difference>,
    /// The number of rays.
    pub rays: u64,
}

impl DiffReport {
    /// True if no difference thicker than [`DiffReport::distance`] was found.
    pub fn is_same(&self) -> bool {
        self.pairs.iter().all(|pair| pair.is_same)
    }

    /// The pair with the thickest difference, if there is one.
    pub fn worst(&self) -> Option<&Difference> {
        let thickness = |pair: &&Difference| pair.spot.map_or(0.0, |spot| spot.thickness);
        let different = self.pairs.iter().filter(|pair| !pair.is_same);
        different.max_by(|a, b| thickness(a).total_cmp(&thickness(b)))
    }
}

/// A pair of matched regions.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Difference {
    /// The name of the region or the medium; `model` for the whole model.
    pub name: String,
    /// True for each model that has such a part.
    pub is_in: [bool; 2],
    /// True if no difference thicker than the accepted one was found.
    pub is_same: bool,
    /// True if the result is proved without rays: the same shapes at the same positions, or two empty
    /// solids.
    pub is_proved: bool,
    /// The volume of the intersection.
    pub both: Estimate,
    /// The volume in the first model only.
    pub a_only: Estimate,
    /// The volume in the second model only.
    pub b_only: Estimate,
    /// The thickest difference found, accepted or not; `None` if there was none.
    pub spot: Option<ThickestSpot>,
    /// A box around all differences beyond the accepted thickness.
    pub place: Option<Bounds>,
    /// The connected places of these differences, the largest volume first. Empty if there are so many that rays cannot tell
    /// which are connected.
    pub places: Vec<DifferencePlace>,
}

/// A connected part of space that belongs to one of the models only.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DifferencePlace {
    /// True if the first model has material there and the second one does not.
    pub is_a: bool,
    /// An estimate of the volume from a grid of rays.
    pub volume: f64,
    /// An estimate of the centre of mass.
    pub centre: Vec3,
    /// A box around the parts of rays in it.
    pub bounds: Bounds,
}

/// A place where models differ.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ThickestSpot {
    /// The middle of the chord.
    pub at: Vec3,
    /// The thickness of the difference.
    pub thickness: f64,
    /// The chord of a ray along which the thickness was measured.
    pub chord: MeasuredChord,
    /// True if the first model has material there and the second one does not.
    pub is_a: bool,
}
