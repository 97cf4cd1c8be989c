//! Light sources: patterns of rays with spectrum, power and polarisation.
//!
//! A [`Source`] is a [`Pattern`] of rays with a [`Spectrum`], a [`Power`], a seed and a placement.
//! In its own frame it emits along +z. Ray k is a function of the source and of k alone, so that
//! any range of rays can be generated in any order, on any thread, with the same bits. (Every lamp
//! behaves like a static lamp of PyRayT; a different seed gives a different lamp.)
//!
//! ```
//! use rayweave_optics::component::Aperture;
//! use rayweave_optics::source::{BeamProfile, Pattern, Power, Sampling, Source, Spectrum};
//!
//! let laser = Source::new(Pattern::Beam {
//!     aperture: Aperture::circle(4.0),
//!     profile: BeamProfile::Gaussian { radius: 1.0 },
//!     sampling: Sampling::Fibonacci { count: 10_000 },
//! })?
//! .spectrum(&Spectrum::Line(532.0))?
//! .power(Power::Total(1.0))?;
//!
//! let rays = laser.rays(2_000..3_000);
//! assert_eq!(rays.len(), 1_000);
//! assert_eq!((rays.id[0], rays.wavelength_nm[0]), (2_000, 532.0));
//! # Ok::<(), rayweave_optics::source::SourceError>(())
//! ```
//!
//! A [`Tracer`](crate::Tracer) takes a source, or several as [`Sources`], as its [`Emitter`].
//!
//! | PyRayT | Rayweave |
//! | --- | --- |
//! | `LineOfRays(spacing)` | [`Pattern::Line`] |
//! | `CircleOfRays(diameter)` | [`Pattern::Circle`] |
//! | `ConeOfRays(cone_angle)` | [`Pattern::Cone`] |
//! | `WedgeOfRays(angle)` | [`Pattern::Wedge`] |
//! | `Lamp(width, length, max_angle)`, `StaticLamp` | [`Pattern::Lamp`] |
//! | `intensity`, 100 for each ray | [`Power::PerRay`] |

mod error;
mod listed;
mod pattern;
mod random;
mod rays;
mod sampling;
mod spectrum;

pub use error::SourceError;
pub use listed::ListedRays;
pub use pattern::{BeamProfile, Emission, Pattern};
pub use rays::SourceRays;
pub use sampling::Sampling;
pub use spectrum::{Cumulative, Spectrum, Wavelengths, planck};

use crate::interface::Stokes;
use crate::{Beam, Emitter, Light};
use error::positive;
use pattern::Prepared;
use random::{NUMBERS, Numbers, RayNumbers};
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_shape::Ray;
use std::ops::Range;

/// The power of the rays of a source, in any unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Power {
    /// The power of each ray, times its weight: the cosine for a lamp, the given power for listed rays.
    PerRay(f64),
    /// The power of all rays together; for a lamp, whose rays differ at random, the mean.
    Total(f64),
}

/// A source of light.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    prepared: Prepared,
    wavelengths: Wavelengths,
    /// The power of a ray of weight 1.
    unit_power: f64,
    seed: u64,
    place: Affine,
    /// The Stokes parameters, relative to x; `None` for unpolarised light.
    stokes: Option<[f64; 4]>,
    /// The linear part of `place` divided by its size, so that directions do not overflow.
    turn: Mat3,
}

impl Source {
    /// A source at the origin, with a wavelength of 633 nm and a power of 100 for each ray (1 for listed
    /// rays with powers).
    ///
    /// # Errors
    /// [`SourceError`] for settings that are out of range or inconsistent.
    pub fn new(pattern: Pattern) -> Result<Source, SourceError> {
        let has_powers = matches!(&pattern, Pattern::Rays(listed) if listed.has_powers());
        Ok(Source {
            prepared: Prepared::new(pattern)?,
            wavelengths: Spectrum::default().wavelengths()?,
            unit_power: if has_powers { 1.0 } else { 100.0 },
            seed: 0,
            place: Affine::IDENTITY,
            stokes: None,
            turn: Mat3::IDENTITY,
        })
    }

    /// Sets the spectrum.
    ///
    /// # Errors
    /// As for [`Spectrum::wavelengths`].
    pub fn spectrum(self, spectrum: &Spectrum) -> Result<Source, SourceError> {
        Ok(Source { wavelengths: spectrum.wavelengths()?, ..self })
    }

    /// Sets the power.
    ///
    /// # Errors
    /// A power that is not positive.
    pub fn power(self, power: Power) -> Result<Source, SourceError> {
        let unit_power = match power {
            Power::PerRay(power) => positive("source", "power", power)?,
            Power::Total(power) => {
                let rays = self.count() as f64 * self.prepared.pattern.mean_weight();
                positive("source", "power", power)? / rays
            }
        };
        Ok(Source { unit_power, ..self })
    }

    /// Sets the polarisation by the Stokes parameters i, q, u, v, of which only the ratios matter.
    /// Light with q > 0 is polarised along the x axis of the source, projected onto the plane
    /// perpendicular to each ray; with u > 0, between x and y. A mirrored source emits mirrored
    /// light.
    ///
    /// # Errors
    /// [`SourceError::Stokes`] for parameters with more polarised than total power.
    pub fn stokes(self, parameters: [f64; 4]) -> Result<Source, SourceError> {
        let [i, q, u, v] = parameters;
        let is_light = i > 0.0 && i.is_finite() && (q * q + u * u + v * v).sqrt() <= i * (1.0 + 1e-12);
        match is_light {
            true => Ok(Source { stokes: Some(parameters), ..self }),
            false => Err(SourceError::Stokes { parameters }),
        }
    }

    /// Whether the light is polarised.
    pub fn is_polarised(&self) -> bool {
        self.stokes.is_some()
    }

    /// Sets the seed of the random numbers; 0 by default.
    pub fn seed(self, seed: u64) -> Source {
        Source { seed, ..self }
    }

    /// Moves the source by an affine map, after earlier ones, as for solids.
    ///
    /// # Errors
    /// A map that is singular or not finite.
    pub fn apply(self, world_from_local: &Affine) -> Result<Source, SourceError> {
        let place = self.place.then(world_from_local);
        place.inverse()?;
        let size =
            place.linear.to_cols_array().into_iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
        Ok(Source { turn: place.linear * (1.0 / size), place, ..self })
    }

    /// The number of rays.
    pub fn count(&self) -> u64 {
        self.prepared.pattern.count()
    }

    /// The rays with numbers in a range, clipped to [`Source::count`].
    pub fn rays(&self, range: Range<u64>) -> SourceRays {
        let mut rays = SourceRays::default();
        self.each(range, 0, |k, light| rays.push(k, &light));
        rays
    }

    /// Generates the rays of a range, for the source with this number in a list.
    fn each(&self, range: Range<u64>, number: u32, mut take: impl FnMut(u64, Light)) {
        let range = range.start..range.end.min(self.count());
        let is_random = self.prepared.pattern.is_random() || !self.wavelengths.is_line();
        let mut random = is_random.then(|| RayNumbers::from(self.seed, u64::from(number), range.start));
        for k in range {
            let numbers = random.as_mut().map_or([0.0; NUMBERS], RayNumbers::ray);
            take(k, self.light(k, &numbers, number));
        }
    }

    fn light(&self, k: u64, numbers: &Numbers, source: u32) -> Light {
        let local = self.prepared.ray(k, numbers);
        let listed = match &self.prepared.pattern {
            Pattern::Rays(listed) => listed.wavelength_nm(k as usize),
            _ => None,
        };
        let direction = self.turn * local.direction;
        let direction = direction / direction.length();
        Light {
            ray: Ray::new(self.place.point(local.origin), direction),
            wavelength_nm: listed.unwrap_or_else(|| self.wavelengths.at(numbers[4])),
            power: self.unit_power * local.weight,
            source,
            stokes: self.stokes.map(|parameters| self.polarisation(parameters, direction)),
        }
    }

    /// The Stokes parameters relative to the axis that is perpendicular to a ray and nearest to x.
    fn polarisation(&self, parameters: [f64; 4], direction: Vec3) -> Stokes {
        let x = self.turn * Vec3::X;
        // the parameters hold in the frame of the source: a mirror reverses u and v
        let [i, q, u, v] = parameters;
        let parameters = if self.turn.determinant() < 0.0 { [i, q, -u, -v] } else { parameters };
        let across = (x - direction * x.dot(direction)).try_normalize();
        Stokes { parameters, axis: across.unwrap_or_else(|| direction.any_orthonormal_vector()) }
    }
}

impl Emitter for Source {
    fn count(&self) -> usize {
        Source::count(self) as usize
    }

    fn emit(&self, range: Range<usize>, beam: &mut Beam) {
        self.each(range.start as u64..range.end as u64, 0, |_, light| beam.push(light));
    }
}

/// Several sources as one: rays are numbered through all sources, and each source has its own random numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sources {
    sources: Vec<Source>,
}

impl Sources {
    /// The sources in order; their numbers are 0, 1, ...
    pub fn new(sources: Vec<Source>) -> Sources {
        Sources { sources }
    }

    /// The sources.
    pub fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// The number of all rays.
    pub fn count(&self) -> u64 {
        self.sources.iter().map(Source::count).fold(0, u64::saturating_add)
    }

    /// The rays with numbers in a range, clipped to [`Sources::count`].
    pub fn rays(&self, range: Range<u64>) -> SourceRays {
        let mut rays = SourceRays::default();
        self.append(range, &mut rays);
        rays
    }

    /// Appends the rays with numbers in a range to others.
    pub fn append(&self, range: Range<u64>, rays: &mut SourceRays) {
        self.each(range, |k, light| rays.push(k, &light));
    }

    fn each(&self, range: Range<u64>, mut take: impl FnMut(u64, Light)) {
        let mut first = 0;
        for (number, source) in (0..).zip(&self.sources) {
            let piece = range.start.saturating_sub(first)..range.end.saturating_sub(first);
            source.each(piece, number, |k, light| take(first + k, light));
            first = first.saturating_add(source.count());
        }
    }
}

impl Emitter for Sources {
    fn count(&self) -> usize {
        Sources::count(self) as usize
    }

    fn emit(&self, range: Range<usize>, beam: &mut Beam) {
        self.each(range.start as u64..range.end as u64, |_, light| beam.push(light));
    }
}
