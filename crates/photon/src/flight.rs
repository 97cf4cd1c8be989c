//! Photons in flight, and the ways in which they end.

use crate::photon::Photon;

/// A photon in flight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flight {
    /// The number of the source's photon that this one is, or comes from.
    pub origin: u64,
    /// The number that selects the random numbers.
    pub number: u64,
    /// Number of steps of its whole history, with those of the photons it was emitted from.
    pub steps: u32,
    /// The region in which it probably is; `u32::MAX` if that is not known.
    pub region: u32,
    pub photon: Photon,
}

/// The way in which a photon ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum End {
    /// Absorbed in a material, `ABSLENGTH`.
    Absorbed,
    /// Absorbed by a wavelength shifter that emitted no photon.
    ShifterAbsorbed,
    /// Absorbed at a surface.
    SurfaceAbsorbed,
    /// Absorbed on entering a material without a refractive index.
    NoIndex,
    /// Detected.
    Detected,
    /// Left the world.
    Escaped,
    /// Stopped at the maximum number of steps.
    StepLimit,
    /// Stopped at the maximum time.
    TimeLimit,
}

impl End {
    /// All ways, in the order of reports.
    pub const ALL: [End; 8] = [
        End::Absorbed,
        End::ShifterAbsorbed,
        End::SurfaceAbsorbed,
        End::NoIndex,
        End::Detected,
        End::Escaped,
        End::StepLimit,
        End::TimeLimit,
    ];

    /// The name in reports, such as `absorbed`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            End::Absorbed => "absorbed",
            End::ShifterAbsorbed => "shifter_absorbed",
            End::SurfaceAbsorbed => "surface_absorbed",
            End::NoIndex => "no_index",
            End::Detected => "detected",
            End::Escaped => "escaped",
            End::StepLimit => "step_limit",
            End::TimeLimit => "time_limit",
        }
    }
}
