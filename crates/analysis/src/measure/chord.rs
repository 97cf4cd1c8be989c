//! Chords: pieces of rays inside regions.

use rayweave_math::Vec3;

/// A piece of a ray inside a region.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasuredChord {
    /// The start point.
    pub from: Vec3,
    /// The end point.
    pub to: Vec3,
}

impl MeasuredChord {
    /// The length.
    pub fn length(&self) -> f64 {
        (self.to - self.from).length()
    }

    pub(super) fn or_longer(self, other: MeasuredChord) -> MeasuredChord {
        if other.length() > self.length() { other } else { self }
    }
}
