//! A cache of the optical constants of media by wavelength, and absorption along a length (Beer-Lambert law).

use crate::medium::absorption_per_nm;
use crate::system::{Substance, System};
use num_complex::Complex64;

/// Slots of the cache, a power of two.
const SLOTS: usize = 64;

/// A medium at a wavelength.
#[derive(Clone, Copy, Debug)]
struct Slot {
    wavelength_bits: u64,
    medium: u32,
    constants: OpticalConstants,
}

/// The optical constants of a medium at a wavelength.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OpticalConstants {
    /// The complex refractive index.
    pub index: Complex64,
    /// The absorption coefficient per unit of length.
    pub absorption: f64,
}

impl OpticalConstants {
    /// The power absorbed over a length, according to the Beer-Lambert law.
    pub fn absorbed_power(self, power: f64, length: f64) -> f64 {
        match self.absorption != 0.0 && length > 0.0 {
            true => -libm::expm1(-self.absorption * length) * power,
            false => 0.0,
        }
    }
}

/// A direct-mapped cache: each pair of medium and wavelength has one slot. Most light has few wavelengths.
#[derive(Clone, Debug)]
pub(crate) struct IndexCache {
    slots: Vec<Slot>,
}

impl Default for IndexCache {
    fn default() -> IndexCache {
        let constants = OpticalConstants::default();
        IndexCache { slots: vec![Slot { wavelength_bits: 0, medium: u32::MAX, constants }; SLOTS] }
    }
}

impl IndexCache {
    /// The optical constants of a medium, given by its number, at a wavelength.
    pub fn get(&mut self, system: &System, medium: u32, wavelength_nm: f64) -> OpticalConstants {
        let wavelength_bits = wavelength_nm.to_bits();
        // multiplicative hashing (Knuth, The Art of Computer Programming 3, section 6.4)
        let key = (wavelength_bits ^ u64::from(medium) << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let slot = &mut self.slots[(key >> 58) as usize % SLOTS];
        if (slot.wavelength_bits, slot.medium) != (wavelength_bits, medium) {
            let constants = optical_constants(system, medium, wavelength_nm);
            *slot = Slot { wavelength_bits, medium, constants };
        }
        slot.constants
    }
}

fn optical_constants(system: &System, medium: u32, wavelength_nm: f64) -> OpticalConstants {
    match &system.media[medium as usize] {
        Substance::Transparent(medium) => {
            let index = medium.index(wavelength_nm);
            let absorption = absorption_per_nm(index, wavelength_nm) * system.unit_nm;
            OpticalConstants { index, absorption }
        }
        // light that starts inside an opaque solid is absorbed there
        Substance::Opaque | Substance::Metal(_) => {
            OpticalConstants { index: Complex64::ONE, absorption: f64::INFINITY }
        }
    }
}
