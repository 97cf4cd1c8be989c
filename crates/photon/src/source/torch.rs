//! Torches: photons of one kind from a point, a disc, a line, a surface or a volume.

use super::volume::SourceVolume;
use crate::error::PhotonError;
use crate::material::ScintillationComponent;
use crate::philox::{Stream, perpendicular};
use crate::photon::{Photon, transverse};
use crate::property::HC_MEV_NM;
use crate::sample::LinearDensity;
use crate::scintillation::{ScintillationLight, delay};
use rayweave_math::Vec3;

/// A source of photons whose position, direction, wavelength, polarisation and time are independent of each other, except for the
/// wavelength and time of scintillation light.
#[derive(Clone, Debug)]
pub struct Torch {
    origin: Origin,
    directions: Directions,
    wavelengths: WavelengthDistribution,
    polarisation: Option<Vec3>,
    pulse: Pulse,
}

/// The places where photons start, each with equal probability per length, area or volume. Lengths are in mm.
#[derive(Clone, Debug)]
pub enum Origin {
    /// A point.
    Point(Vec3),
    /// A flat disc.
    Disc {
        /// The centre.
        centre: Vec3,
        /// The normal; its length does not matter.
        axis: Vec3,
        /// The radius.
        radius: f64,
    },
    /// A straight line between two points.
    Line(Vec3, Vec3),
    /// The inside of a volume, or the boundary of it.
    Volume(SourceVolume),
}

/// The directions of photons, each with equal probability per solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Directions {
    /// All of them.
    Isotropic,
    /// Those within an angle from an axis; 0 for the axis alone.
    Cone {
        /// The axis; its length does not matter.
        axis: Vec3,
        /// The angle between the axis and the outermost direction, in degrees, from 0 to 180.
        half_angle: f64,
    },
}

/// The distribution of wavelengths in vacuum, in nm.
#[derive(Clone, Debug, PartialEq)]
pub enum WavelengthDistribution {
    /// One wavelength.
    Single(f64),
    /// A density per nm.
    Density(LinearDensity),
    /// The scintillation light of a material, which also delays the emission.
    Scintillation(ScintillationLight),
}

/// The distribution of emission times in ns: the sum of a uniform, a normal and an exponential part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pulse {
    /// The start and the end of the uniform part.
    pub interval: [f64; 2],
    /// The standard deviation of the normal part, whose mean is 0.
    pub deviation: f64,
    /// The mean of the exponential part.
    pub decay: f64,
}

/// The second constant of radiation hc / k in nm K (CODATA 2018, exact constants).
const SECOND_RADIATION: f64 = 1.438_776_877e7;

/// The number of points of the table of a black body; the density between them is linear.
const BLACK_BODY_POINTS: u32 = 2049;

impl WavelengthDistribution {
    /// All wavelengths between two with equal probability.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] if they are not positive, finite and in ascending order.
    pub fn uniform(from: f64, to: f64) -> Result<WavelengthDistribution, PhotonError> {
        check_range(from, to)?;
        Ok(WavelengthDistribution::Density(LinearDensity::new(vec![(from, 1.0), (to, 1.0)])?))
    }

    /// The photons of a black body with a temperature in K between two wavelengths: a density in proportion to
    /// 1 / (l^4 (exp(hc / l k T) - 1)) (Planck 1901), linear between 2,049 wavelengths.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] if the wavelengths are not positive, finite and in ascending order, if the temperature is not
    /// positive and finite, and if it is so low that there are no photons.
    pub fn black_body(temperature: f64, from: f64, to: f64) -> Result<WavelengthDistribution, PhotonError> {
        check_range(from, to)?;
        if !(temperature > 0.0 && temperature.is_finite()) {
            let problem = format!("the temperature is {temperature} K");
            return Err(PhotonError::setting(problem, "it must be positive and finite"));
        }
        let exponent = |nm: f64| SECOND_RADIATION / (nm * temperature);
        // relative to the longest wavelength, so that low temperatures do not underflow
        let (scale, least) = (to, exponent(to));
        let density = |nm: f64| {
            let x = exponent(nm);
            libm::pow(scale / nm, 4.0) * libm::exp(least - x) / -libm::expm1(-x)
        };
        let last = BLACK_BODY_POINTS - 1;
        let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(last);
        let points = (0..=last).map(|k| (at(k), density(at(k)))).collect();
        Ok(WavelengthDistribution::Density(LinearDensity::new(points)?))
    }

    /// The energy of a photon in MeV, and the component of scintillation that it belongs to.
    fn sample(&self, stream: &mut Stream) -> (f64, Option<&ScintillationComponent>) {
        match self {
            WavelengthDistribution::Single(nm) => (HC_MEV_NM / nm, None),
            WavelengthDistribution::Density(density) => {
                (HC_MEV_NM / density.quantile(stream.uniform()), None)
            }
            WavelengthDistribution::Scintillation(light) => {
                let (energy, component) = light.sample(stream);
                (energy, Some(component))
            }
        }
    }
}

fn check_range(from: f64, to: f64) -> Result<(), PhotonError> {
    if from > 0.0 && from < to && to.is_finite() {
        return Ok(());
    }
    let problem = format!("the wavelengths reach from {from} nm to {to} nm");
    Err(PhotonError::setting(problem, "both must be positive and finite, and the first one smaller"))
}

fn unit(vector: Vec3, what: &str) -> Result<Vec3, PhotonError> {
    vector
        .try_normalize()
        .ok_or_else(|| PhotonError::setting(format!("{what} is {vector}"), "it must be finite and not zero"))
}

fn finite(position: Vec3) -> Result<Vec3, PhotonError> {
    if position.is_finite() {
        return Ok(position);
    }
    Err(PhotonError::setting(format!("the source is at {position}"), "its coordinates must be finite"))
}

impl Torch {
    /// Unpolarised photons in all directions at time 0.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for positions that are not finite, a radius that is not positive, an axis of length 0, and a
    /// wavelength that is not positive and finite.
    pub fn new(origin: Origin, wavelengths: WavelengthDistribution) -> Result<Torch, PhotonError> {
        let origin = match origin {
            Origin::Point(position) => Origin::Point(finite(position)?),
            Origin::Line(from, to) => Origin::Line(finite(from)?, finite(to)?),
            Origin::Disc { centre, axis, radius } => {
                if !(radius > 0.0 && radius.is_finite()) {
                    let problem = format!("the radius of the source is {radius} mm");
                    return Err(PhotonError::setting(problem, "it must be positive and finite"));
                }
                let axis = unit(axis, "the axis of the source")?;
                Origin::Disc { centre: finite(centre)?, axis, radius }
            }
            Origin::Volume(volume) => Origin::Volume(volume),
        };
        if let WavelengthDistribution::Single(nm) = wavelengths
            && !(nm > 0.0 && nm.is_finite())
        {
            let problem = format!("the wavelength is {nm} nm");
            return Err(PhotonError::setting(problem, "it must be positive and finite"));
        }
        let directions = Directions::Isotropic;
        Ok(Torch { origin, directions, wavelengths, polarisation: None, pulse: Pulse::default() })
    }

    /// Unpolarised photons of one wavelength in nm from a point in mm, in all directions at time 0.
    ///
    /// # Errors
    ///
    /// As [`Torch::new`].
    pub fn point(position: Vec3, wavelength_nm: f64) -> Result<Torch, PhotonError> {
        Torch::new(Origin::Point(position), WavelengthDistribution::Single(wavelength_nm))
    }

    /// The same source with other directions.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for an axis that is zero or not finite, and an angle outside 0 to 180 degrees.
    pub fn towards(self, directions: Directions) -> Result<Torch, PhotonError> {
        let directions = match directions {
            Directions::Isotropic => Directions::Isotropic,
            Directions::Cone { axis, half_angle } => {
                if !(0.0..=180.0).contains(&half_angle) {
                    let problem = format!("the angle of the cone is {half_angle} degrees");
                    return Err(PhotonError::setting(problem, "it must be from 0 to 180"));
                }
                Directions::Cone { axis: unit(axis, "the direction of the source")?, half_angle }
            }
        };
        Ok(Torch { directions, ..self })
    }

    /// The same source with linearly polarised photons: the polarisation of each is the part of a vector that is
    /// perpendicular to its direction, and random if there is none.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for a vector that is zero, not finite, or parallel to the only direction of the photons.
    pub fn polarised(self, polarisation: Vec3) -> Result<Torch, PhotonError> {
        let vector = unit(polarisation, "the polarisation")?;
        if let Directions::Cone { axis, half_angle: 0.0 } = self.directions
            && transverse(vector, axis).is_none()
        {
            let problem = format!("the polarisation {polarisation} is parallel to the direction");
            return Err(PhotonError::setting(problem, "light is polarised perpendicular to its direction"));
        }
        Ok(Torch { polarisation: Some(vector), ..self })
    }

    /// The same source with other emission times.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for numbers that are not finite, an interval that ends before it starts, and negative widths.
    pub fn pulsed(self, pulse: Pulse) -> Result<Torch, PhotonError> {
        let [from, to] = pulse.interval;
        if !(from.is_finite() && to.is_finite() && from <= to) {
            let problem = format!("the emission lasts from {from} ns to {to} ns");
            return Err(PhotonError::setting(problem, "it must not end before it starts"));
        }
        for (width, name) in [(pulse.deviation, "standard deviation"), (pulse.decay, "decay time")] {
            if !(width >= 0.0 && width.is_finite()) {
                let problem = format!("the {name} of the emission is {width} ns");
                return Err(PhotonError::setting(problem, "it must be finite and at least 0"));
            }
        }
        Ok(Torch { pulse, ..self })
    }

    /// The volume in which photons are placed after their creation.
    pub(super) fn volume(&self) -> Option<&SourceVolume> {
        if let Origin::Volume(volume) = &self.origin { Some(volume) } else { None }
    }

    /// The photon without its direction and polarisation, if these are random and everything else is equal for all
    /// photons; one of a volume is at the origin.
    pub(super) fn template(&self) -> Option<Photon> {
        let WavelengthDistribution::Single(nm) = self.wavelengths else { return None };
        let Pulse { interval: [from, to], deviation, decay } = self.pulse;
        let is_plain = self.directions == Directions::Isotropic && self.polarisation.is_none();
        if !is_plain || to > from || deviation > 0.0 || decay > 0.0 {
            return None;
        }
        let position = match self.origin {
            Origin::Point(position) => position,
            Origin::Volume(_) => Vec3::ZERO,
            Origin::Line(..) | Origin::Disc { .. } => return None,
        };
        let (direction, polarisation, energy) = (Vec3::ZERO, Vec3::ZERO, HC_MEV_NM / nm);
        Some(Photon { position, direction, polarisation, energy, time: from + 0.0 })
    }

    /// A photon; one of a volume is at the origin.
    pub(super) fn photon(&self, stream: &mut Stream) -> Photon {
        let (energy, component) = self.wavelengths.sample(stream);
        let direction = match self.directions {
            Directions::Isotropic => stream.direction(),
            Directions::Cone { axis, half_angle: 0.0 } => axis,
            Directions::Cone { axis, half_angle } => {
                // 1 - cos without cancellation
                let half = libm::sin(0.5 * half_angle.to_radians());
                let cosine = 1.0 - 2.0 * half * half * stream.uniform();
                stream.around(axis, cosine)
            }
        };
        let fixed = self.polarisation.and_then(|vector| transverse(vector, direction));
        let polarisation = fixed.unwrap_or_else(|| stream.polarisation(direction));
        let Pulse { interval: [from, to], deviation, decay } = self.pulse;
        let mut time = from + if to > from { (to - from) * stream.uniform() } else { 0.0 };
        if deviation > 0.0 {
            time += deviation * stream.normal();
        }
        if decay > 0.0 {
            time += decay * stream.exponential();
        }
        if let Some(ScintillationComponent { time: decay, rise_time, .. }) = component {
            time += delay(decay.unwrap_or_default(), *rise_time, stream);
        }
        let position = match self.origin {
            Origin::Point(position) => position,
            Origin::Line(from, to) => from + (to - from) * stream.uniform(),
            Origin::Disc { centre, axis, radius } => {
                let distance = radius * stream.uniform().sqrt();
                let azimuth = std::f64::consts::TAU * stream.uniform();
                let (x, y) = perpendicular(axis);
                centre + distance * (libm::cos(azimuth) * x + libm::sin(azimuth) * y)
            }
            Origin::Volume(_) => Vec3::ZERO,
        };
        Photon { position, direction, polarisation, energy, time }
    }
}
