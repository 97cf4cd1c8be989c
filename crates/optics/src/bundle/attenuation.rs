//! Attenuation of a ray bundle in absorbing media (Beer-Lambert law).

use crate::trace::OpticalConstants;
use rayweave_shape::lanes::LANES;

/// Absorption of eight rays over given lengths.
pub(super) struct Attenuation {
    /// The sum of the absorbed powers.
    pub absorbed: f64,
    /// The remaining power of each ray.
    pub power: [f64; LANES],
}

impl Attenuation {
    pub fn new(
        media: &[OpticalConstants; LANES],
        power: &[f64; LANES],
        length: &[f64; LANES],
    ) -> Attenuation {
        let mut attenuation = Attenuation { absorbed: 0.0, power: *power };
        for (lane, power) in attenuation.power.iter_mut().enumerate() {
            let absorbed = media[lane].absorbed_power(*power, length[lane]);
            (attenuation.absorbed, *power) = (attenuation.absorbed + absorbed, *power - absorbed);
        }
        attenuation
    }

    /// True if all rays remain above the threshold of the settings.
    pub fn exceeds(&self, threshold: f64) -> bool {
        self.power.iter().all(|&power| power >= threshold && power > 0.0)
    }
}
