//! The indices of the media, kept: light comes in few wavelengths most of the time.

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
    optics: Optics,
}

/// What light sees of a medium.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Optics {
    /// Its index.
    pub index: Complex64,
    /// The absorption per unit of length.
    pub absorption: f64,
}

impl Optics {
    /// What a length takes of a power (Beer-Lambert).
    pub fn lost(self, power: f64, length: f64) -> f64 {
        match self.absorption != 0.0 && length > 0.0 {
            true => -libm::expm1(-self.absorption * length) * power,
            false => 0.0,
        }
    }
}

/// A cache in which each pair of medium and wavelength has one place.
#[derive(Clone, Debug)]
pub(crate) struct Indices {
    slots: Vec<Slot>,
}

impl Default for Indices {
    fn default() -> Indices {
        let optics = Optics::default();
        Indices { slots: vec![Slot { wavelength_bits: 0, medium: u32::MAX, optics }; SLOTS] }
    }
}

impl Indices {
    /// What light of a wavelength sees of a medium, by its number.
    pub fn of(&mut self, system: &System, medium: u32, wavelength_nm: f64) -> Optics {
        let wavelength_bits = wavelength_nm.to_bits();
        // multiplicative hashing (Knuth, The Art of Computer Programming 3, section 6.4)
        let key = (wavelength_bits ^ u64::from(medium) << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let slot = &mut self.slots[(key >> 58) as usize % SLOTS];
        if (slot.wavelength_bits, slot.medium) != (wavelength_bits, medium) {
            let optics = optics(system, medium, wavelength_nm);
            *slot = Slot { wavelength_bits, medium, optics };
        }
        slot.optics
    }
}

fn optics(system: &System, medium: u32, wavelength_nm: f64) -> Optics {
    match &system.media[medium as usize] {
        Substance::Transparent(medium) => {
            let index = medium.index(wavelength_nm);
            Optics { index, absorption: absorption_per_nm(index, wavelength_nm) * system.unit_nm }
        }
        // light that starts inside of what no light enters ends there
        Substance::Opaque | Substance::Metal(_) => {
            Optics { index: Complex64::ONE, absorption: f64::INFINITY }
        }
    }
}
