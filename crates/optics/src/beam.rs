//! Input light: beams of rays with wavelength, power and polarisation, and the trait of light sources.

use crate::error::OpticsError;
use crate::interface::Stokes;
use crate::system::System;
use rayweave_math::Vec3;
use rayweave_model::{RayBatch, Rays};
use rayweave_shape::Ray;
use std::ops::Range;

/// Input rays of light as columns.
#[derive(Clone, Debug, Default)]
pub struct Beam {
    rays: RayBatch,
    wavelength_nm: Vec<f64>,
    power: Vec<f64>,
    source: Vec<u32>,
    /// Polarisation by ray, up to the last polarised ray; the rays after it are unpolarised.
    stokes: Vec<Option<Stokes>>,
}

/// One input ray of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The origin and direction; the direction need not be of unit length.
    pub ray: Ray,
    /// The vacuum wavelength in nanometres.
    pub wavelength_nm: f64,
    /// The power, in any unit.
    pub power: f64,
    /// The number of the source.
    pub source: u32,
    /// The polarisation, or `None` for unpolarised light; the power in the Stokes vector is ignored.
    pub stokes: Option<Stokes>,
}

impl Beam {
    /// Appends a ray.
    pub fn push(&mut self, light: Light) {
        self.rays.push(light.ray);
        self.wavelength_nm.push(light.wavelength_nm);
        self.power.push(light.power);
        self.source.push(light.source);
        if light.stokes.is_some() {
            self.stokes.resize(self.len() - 1, None);
            self.stokes.push(light.stokes);
        }
    }

    /// The rays.
    pub fn rays(&self) -> Rays<'_> {
        self.rays.rays()
    }

    /// The vacuum wavelengths in nanometres.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelength_nm
    }

    /// The powers.
    pub fn powers(&self) -> &[f64] {
        &self.power
    }

    /// The numbers of the sources.
    pub fn sources(&self) -> &[u32] {
        &self.source
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.power.len()
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.power.is_empty()
    }

    /// Removes all rays and keeps the memory.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.wavelength_nm.clear();
        self.power.clear();
        self.source.clear();
        self.stokes.clear();
    }

    /// Ray number `i`.
    pub fn get(&self, i: usize) -> Light {
        Light {
            ray: self.rays().get(i),
            wavelength_nm: self.wavelength_nm[i],
            power: self.power[i],
            source: self.source[i],
            stokes: self.stokes.get(i).copied().flatten(),
        }
    }

    /// Checks that all rays can be traced through a system.
    ///
    /// # Errors
    /// [`OpticsError`] for the first invalid ray or power, or wavelength outside the range of a medium.
    pub fn check(&self, system: &System) -> Result<(), OpticsError> {
        system.program().check_rays(self.rays())?;
        let bad = |column, ray, value, range| OpticsError::BadLight { column, ray, value, range };
        let first = |column: &[f64], is_good: fn(f64) -> bool| {
            // a branch-free fold; the position is searched for only if a value is invalid
            let all = column.iter().fold(true, |all, &value| all & is_good(value));
            if all { None } else { column.iter().position(|&value| !is_good(value)) }
        };
        if let Some(ray) = first(&self.power, |power| (power >= 0.0) & power.is_finite()) {
            return Err(bad("power", ray, self.power[ray], "at least 0 and finite"));
        }
        if let Some(ray) = first(&self.wavelength_nm, |length| (length > 0.0) & length.is_finite()) {
            let value = self.wavelength_nm[ray];
            return Err(bad("wavelength_nm", ray, value, "greater than 0 and finite"));
        }
        let least = self.wavelength_nm.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.wavelength_nm.iter().copied().fold(0.0, f64::max);
        system.media().try_for_each(|medium| {
            let range_nm @ [lo, hi] = medium.range_nm();
            let outside = |&wavelength: &f64| !(lo..=hi).contains(&wavelength);
            if least >= lo && most <= hi {
                return Ok(());
            }
            let Some(ray) = self.wavelength_nm.iter().position(outside) else { return Ok(()) };
            let (wavelength_nm, medium) = (self.wavelength_nm[ray], medium.name().to_owned());
            Err(OpticsError::Wavelength { ray, wavelength_nm, medium, range_nm })
        })
    }
}

impl FromIterator<Light> for Beam {
    fn from_iter<I: IntoIterator<Item = Light>>(lights: I) -> Beam {
        let mut beam = Beam::default();
        lights.into_iter().for_each(|light| beam.push(light));
        beam
    }
}

/// A source of light that emits any range of its rays, so that a run of any length takes bounded memory.
pub trait Emitter: Sync {
    /// The number of rays.
    fn count(&self) -> usize;

    /// Appends the rays of a range. The same ray numbers always give the same rays.
    fn emit(&self, range: Range<usize>, beam: &mut Beam);
}

impl Emitter for Beam {
    fn count(&self) -> usize {
        self.len()
    }

    fn emit(&self, range: Range<usize>, beam: &mut Beam) {
        let known = self.stokes.len().clamp(range.start, range.end);
        if known > range.start {
            beam.stokes.resize(beam.len(), None);
            beam.stokes.extend_from_slice(&self.stokes[range.start..known]);
        }
        beam.rays.extend(self.rays(), range.clone());
        beam.wavelength_nm.extend_from_slice(&self.wavelength_nm[range.clone()]);
        beam.power.extend_from_slice(&self.power[range.clone()]);
        beam.source.extend_from_slice(&self.source[range]);
    }
}

impl Light {
    /// Unpolarised light of source 0 and power 1.
    pub fn new(origin: impl Into<Vec3>, direction: impl Into<Vec3>, wavelength_nm: f64) -> Light {
        let ray = Ray::new(origin.into(), direction.into());
        Light { ray, wavelength_nm, power: 1.0, source: 0, stokes: None }
    }
}
