//! Pieces of rays within regions.

use rayweave_math::Vec3;

/// A piece of a ray within a region.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chord {
    /// Where it begins.
    pub from: Vec3,
    /// Where it ends.
    pub to: Vec3,
}

impl Chord {
    /// Its length.
    pub fn length(&self) -> f64 {
        (self.to - self.from).length()
    }

    pub(super) fn or_longer(self, other: Chord) -> Chord {
        if other.length() > self.length() { other } else { self }
    }
}
