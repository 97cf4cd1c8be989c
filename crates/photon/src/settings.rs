//! Settings of a run.

use crate::detector::DetectionRule;
use rayweave_model::drive::Cancel;
use std::num::NonZeroUsize;
use std::ops::Range;

/// The distribution of the time between absorption by a wavelength shifter and emission, as Geant4's parameter `WLSTimeProfile`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeProfile {
    /// Always the time constant: Geant4's default.
    #[default]
    Delta,
    /// Exponential, with the time constant as its mean.
    Exponential,
}

impl TimeProfile {
    /// All profiles.
    pub const ALL: [TimeProfile; 2] = [TimeProfile::Delta, TimeProfile::Exponential];

    /// The name in files, bindings and commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            TimeProfile::Delta => "delta",
            TimeProfile::Exponential => "exponential",
        }
    }

    /// The profile of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<TimeProfile> {
        TimeProfile::ALL.into_iter().find(|profile| profile.name() == name)
    }
}

/// Settings of a run.
#[derive(Clone, Debug)]
pub struct RunSettings {
    /// The seed of all random numbers.
    pub seed: u64,
    /// The number of the event: photons of different events have different random numbers.
    pub event: u32,
    /// The numbers of the photons to simulate. A run of a part of a range gives that part of its results.
    pub photons: Range<u64>,
    /// The rule of detection.
    pub detection: DetectionRule,
    /// The maximum number of steps of a photon.
    pub max_steps: u32,
    /// The maximum time in ns.
    pub max_time: f64,
    /// The times of wavelength shifters.
    pub wls_time_profile: TimeProfile,
    /// The number of threads; by default that of [`thread_count`](rayweave_model::drive::thread_count).
    pub threads: Option<NonZeroUsize>,
    /// Stops the run.
    pub cancel: Cancel,
}

impl RunSettings {
    /// The settings of a run of some photons: seed 0, both rules of detection, 10,000 steps, no limit of time.
    #[must_use]
    pub fn new(photons: Range<u64>) -> RunSettings {
        RunSettings {
            seed: 0,
            event: 0,
            photons,
            detection: DetectionRule::default(),
            max_steps: 10_000,
            max_time: f64::INFINITY,
            wls_time_profile: TimeProfile::default(),
            threads: None,
            cancel: Cancel::new(),
        }
    }
}
