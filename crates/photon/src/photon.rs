//! Photons at one moment, and the numbers that select their random numbers.

use rayweave_math::Vec3;
use rayweave_shape::Ray;

/// A photon at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// The position in mm.
    pub position: Vec3,
    /// The direction: a unit vector.
    pub direction: Vec3,
    /// The polarisation: a unit vector perpendicular to the direction. Zero in a list of photons means unpolarised: a random
    /// one is chosen.
    pub polarisation: Vec3,
    /// The energy in MeV.
    pub energy: f64,
    /// The time in ns.
    pub time: f64,
}

impl Photon {
    /// The line of flight.
    #[inline]
    pub(crate) fn ray(&self) -> Ray {
        Ray { origin: self.position, direction: self.direction }
    }
}

/// The run that photons are emitted for: what their random numbers depend on, beside their own number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EventKey {
    pub seed: u64,
    pub event: u32,
}

impl EventKey {
    /// The number that selects the random numbers of a photon.
    pub fn number(self, photon: u64) -> u64 {
        u64::from(self.event) << 32 | photon
    }
}

/// The largest number of photons of an event: each has a number of 32 bits.
pub(crate) const MAX_PHOTONS: u64 = 1 << 32;

/// The direction of the part of a vector that is perpendicular to a unit vector; `None` if it is lost in rounding.
pub(crate) fn transverse(vector: Vec3, direction: Vec3) -> Option<Vec3> {
    let part = vector - vector.dot(direction) * direction;
    if part.length() < 1e-9 * vector.length() {
        return None;
    }
    let part = part.try_normalize()?;
    // again, for what rounding has left along the direction
    (part - part.dot(direction) * direction).try_normalize()
}
