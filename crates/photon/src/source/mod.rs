//! Sources of photons.

mod copies;
mod torch;
mod volume;

use crate::detector::Detector;
use crate::draws::isotropic;
use crate::error::PhotonError;
use crate::genstep::Gensteps;
use crate::philox::{Purpose, Stream};
use crate::photon::{EventKey, MAX_PHOTONS, Photon};
use rayweave_math::Vec3;
use rayweave_model::Evaluator;
use std::ops::Range;

pub use torch::{Directions, Origin, Pulse, Torch, WavelengthDistribution};
pub use volume::SourceVolume;

/// Photons by number: the photon of a number is a function of the seed, the event and the number alone.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a run has one source")]
pub enum Source {
    /// Photons of one kind, from a point, a line, a surface or a volume.
    Torch(Torch),
    /// Given photons; the photon with number k is the one at index k.
    Photons(Vec<Photon>),
    /// Cerenkov and scintillation photons along the steps of particles.
    Gensteps(Gensteps),
}

/// Passes on the photons of a range of numbers that are equal to `template` except for random directions and polarisations.
pub(crate) fn turned(template: Photon, key: EventKey, numbers: Range<u64>, mut put: impl FnMut(Photon)) {
    let streams = numbers.map(|number| key.number(number));
    isotropic(key.seed, streams, |[direction, polarisation]| {
        put(Photon { direction, polarisation, ..template });
    });
}

impl Source {
    /// The number of photons, if it is limited.
    #[must_use]
    pub fn limit(&self) -> Option<u64> {
        match self {
            Source::Torch(_) => None,
            Source::Photons(photons) => Some(photons.len() as u64),
            Source::Gensteps(gensteps) => Some(gensteps.photons()),
        }
    }

    /// The genstep of each of some photons; `None` for other sources.
    pub(crate) fn parents(&self, photons: &[i64]) -> Option<Vec<i64>> {
        let Source::Gensteps(gensteps) = self else { return None };
        Some(photons.iter().map(|&photon| gensteps.parent(photon as u64) as i64).collect())
    }

    /// The photon without its direction and polarisation, if all photons leave one point in [random directions](turned) and are
    /// equal otherwise.
    pub(crate) fn at_point(&self) -> Option<Photon> {
        let Source::Torch(torch) = self else { return None };
        torch.template().filter(|_| torch.volume().is_none())
    }

    /// Appends the photons of a range of numbers.
    pub(crate) fn emit<E: Evaluator>(
        &self,
        (detector, evaluator): (&Detector, &E),
        scratch: &mut E::Scratch,
        key: EventKey,
        numbers: Range<u64>,
        photons: &mut Vec<Photon>,
    ) {
        let stream = |number: u64| Stream::new(key.seed, key.number(number), 0, Purpose::Emission);
        let first = photons.len();
        match self {
            Source::Torch(torch) => {
                match torch.template() {
                    Some(template) => {
                        turned(template, key, numbers.clone(), |photon| photons.push(photon));
                    }
                    None => photons.extend(numbers.clone().map(|number| torch.photon(&mut stream(number)))),
                }
                if let Some(volume) = torch.volume() {
                    volume.place(evaluator, scratch, key, numbers.start, &mut photons[first..]);
                }
            }
            Source::Photons(list) => photons.extend(numbers.map(|number| {
                let photon = list[number as usize];
                if photon.polarisation != Vec3::ZERO {
                    return photon;
                }
                Photon { polarisation: stream(number).polarisation(photon.direction), ..photon }
            })),
            Source::Gensteps(gensteps) => gensteps.emit(detector, numbers, stream, photons),
        }
    }

    /// Checks the numbers of the photons to emit.
    pub(crate) fn check_range(&self, numbers: &Range<u64>) -> Result<(), PhotonError> {
        let Range { start, end } = numbers;
        // the range is half-open
        let problem = || format!("photons {start} to {} are requested", end.saturating_sub(1));
        if let Some(limit) = self.limit().filter(|limit| limit < end) {
            return Err(PhotonError::setting(
                problem(),
                format!("the source has {limit} photons, numbered from 0"),
            ));
        }
        if *end > MAX_PHOTONS {
            return Err(PhotonError::setting(problem(), "an event has at most 4294967296 photons"));
        }
        Ok(())
    }

    /// Checks given photons.
    pub(crate) fn check(&self) -> Result<(), PhotonError> {
        let Source::Photons(photons) = self else { return Ok(()) };
        for (index, photon) in photons.iter().enumerate() {
            let is_polarised = photon.polarisation != Vec3::ZERO;
            let fault = match () {
                () if !photon.position.is_finite() => "its position must be finite",
                () if !is_near(photon.direction.length(), 1.0) => "its direction must have length 1",
                () if is_polarised && !is_near(photon.polarisation.length(), 1.0) => {
                    "its polarisation must have length 1, or 0 if it is unpolarised"
                }
                () if !is_near(photon.polarisation.dot(photon.direction), 0.0) => {
                    "its polarisation must be perpendicular to its direction"
                }
                () if !(photon.energy > 0.0 && photon.energy.is_finite()) => {
                    "its energy must be positive and finite"
                }
                () if !photon.time.is_finite() => "its time must be finite",
                () => continue,
            };
            return Err(PhotonError::setting(format!("photon {index} is invalid"), fault));
        }
        Ok(())
    }
}

/// True for lengths and products of unit vectors that are equal up to rounding in single precision; false for NaN.
fn is_near(value: f64, expected: f64) -> bool {
    (value - expected).abs() <= 1e-6
}
