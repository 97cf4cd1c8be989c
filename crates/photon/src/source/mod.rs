//! Sources of photons.

use crate::error::PhotonError;
use crate::philox::{Purpose, Stream};
use crate::property::HC_MEV_NM;
use rayweave_math::Vec3;

/// A photon at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// The position in mm.
    pub position: Vec3,
    /// The direction: a unit vector.
    pub direction: Vec3,
    /// The polarisation: a unit vector perpendicular to the direction.
    pub polarisation: Vec3,
    /// The energy in MeV.
    pub energy: f64,
    /// The time in ns.
    pub time: f64,
}

/// Photons by number: the photon of a number is a function of the seed and the number alone.
#[derive(Clone, Debug)]
pub enum Source {
    /// Photons from one point.
    Point(PointSource),
    /// Given photons; the photon with number k is the one at index k.
    Photons(Vec<Photon>),
}

/// A point that emits photons of one wavelength at time 0, unpolarised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSource {
    position: Vec3,
    energy: f64,
    direction: Option<Vec3>,
}

impl PointSource {
    /// A point that emits in all directions with equal probability. The position is in mm, the wavelength in nm.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] if the position is not finite or the wavelength is not positive and finite.
    pub fn isotropic(position: Vec3, wavelength_nm: f64) -> Result<PointSource, PhotonError> {
        if !position.is_finite() {
            return Err(PhotonError::setting(
                format!("the source is at {position}"),
                "its coordinates must be finite",
            ));
        }
        if !(wavelength_nm > 0.0 && wavelength_nm.is_finite()) {
            let problem = format!("the wavelength is {wavelength_nm} nm");
            return Err(PhotonError::setting(problem, "it must be positive and finite"));
        }
        Ok(PointSource { position, energy: HC_MEV_NM / wavelength_nm, direction: None })
    }

    /// The same point with one direction for all photons.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] if the direction is zero or not finite.
    pub fn towards(self, direction: Vec3) -> Result<PointSource, PhotonError> {
        match direction.try_normalize() {
            Some(unit) => Ok(PointSource { direction: Some(unit), ..self }),
            None => {
                let problem = format!("the direction of the source is {direction}");
                Err(PhotonError::setting(problem, "it must be finite and not zero"))
            }
        }
    }

    fn photon(&self, stream: &mut Stream) -> Photon {
        let direction = self.direction.unwrap_or_else(|| stream.direction());
        let polarisation = stream.polarisation(direction);
        Photon { position: self.position, direction, polarisation, energy: self.energy, time: 0.0 }
    }
}

impl Source {
    /// The photon of a number.
    pub(crate) fn photon(&self, seed: u64, number: u64) -> Photon {
        match self {
            Source::Point(point) => point.photon(&mut Stream::new(seed, number, 0, Purpose::Emission)),
            Source::Photons(photons) => photons[number as usize],
        }
    }

    /// The number of photons, if it is limited.
    pub(crate) fn limit(&self) -> Option<u64> {
        match self {
            Source::Point(_) => None,
            Source::Photons(photons) => Some(photons.len() as u64),
        }
    }

    /// Checks given photons.
    pub(crate) fn check(&self) -> Result<(), PhotonError> {
        let Source::Photons(photons) = self else { return Ok(()) };
        for (index, photon) in photons.iter().enumerate() {
            let fault = match () {
                () if !photon.position.is_finite() => "its position must be finite",
                () if (photon.direction.length() - 1.0).abs() > 1e-6 => "its direction must have length 1",
                () if (photon.polarisation.length() - 1.0).abs() > 1e-6 => {
                    "its polarisation must have length 1"
                }
                () if photon.polarisation.dot(photon.direction).abs() > 1e-6 => {
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
