//! Gensteps: steps of charged particles that emit Cerenkov or scintillation photons.
//!
//! A genstep states how many photons a step emits; [`Gensteps`] generates them one by one, each from its own random numbers.
//! The layouts of arrays are those of [`gensteps_from_array`].
//!
//! *Sources*: Geant4 Physics Reference Manual 11.4, chapters "Cerenkov Effect" and "Scintillation"; the densities are those of
//! `G4Cerenkov` and `G4Scintillation`, sampled by the inverses of their integrals instead of rejection.

pub(crate) mod cerenkov;
mod emission;
mod layout;
mod resolve;

use rayweave_math::Vec3;

pub use cerenkov::cerenkov_yield;
pub use layout::{GenstepNumbers, gensteps_from_array, photons_from_opticks};
pub use resolve::Gensteps;

/// A step of a particle, and the number of photons that it emits. Lengths are in mm, times in ns, velocities in mm/ns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Genstep {
    /// The process.
    pub process: EmissionProcess,
    /// The number of the material in the program that recorded the step.
    pub material: u32,
    /// The number of photons.
    pub photons: u32,
    /// The position of the particle before the step.
    pub position: Vec3,
    /// The time before the step.
    pub time: f64,
    /// The displacement from the position before the step to the one after it.
    pub displacement: Vec3,
    /// The length of the step: at least that of the displacement.
    pub step_length: f64,
    /// The charge of the particle, in units of that of the positron.
    pub charge: f64,
    /// The velocities before and after the step.
    pub velocity: [f64; 2],
}

/// The process that emits the photons of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmissionProcess {
    /// The Cerenkov effect.
    Cerenkov {
        /// The inverse of the mean velocity of the step, in units of that of light.
        inverse_beta: f64,
        /// The wavelengths in nm, which the range of `RINDEX` is cut to; 0 and infinity for no cut.
        wavelengths: [f64; 2],
        /// The mean numbers of photons per length before and after the step, in any unit.
        density: [f64; 2],
    },
    /// Scintillation.
    Scintillation {
        /// The component, 1 to 3; `None` to find it by its time constant, or if that is 0, to choose one for each photon by
        /// the yields of the material.
        component: Option<u32>,
        /// The time constant in ns; 0 for that of the material.
        time: f64,
        /// The rise time in ns; `None` for that of the material.
        rise_time: Option<f64>,
    },
}
