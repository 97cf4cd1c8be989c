//! Scattering of one ray of light at a face or a sheet: reflection, refraction, absorption, diffuse
//! and rough scattering.
//!
//! Directions follow the law of reflection and Snell's law, powers and polarisation the Fresnel
//! equations, with the physics of [`interface`](crate::interface). [`Incident`] is the light before
//! the event, [`Scattered`] a ray after it.

use crate::element::{Action, Finish};
use crate::interface::{Amplitudes, Film, Stokes, diffract, fresnel, reflect, refract, transfer_matrix};
use crate::segments::Event;
use crate::settings::{Branches, TraceSettings};
use crate::start_surfaces::ExitSide;
use crate::system::{HitFace, Substance};
use num_complex::Complex64;
use rand::{Rng, RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Affine, Vec3};

/// Light incident on a face or a sheet; its direction and the normal against it are of unit length.
pub(crate) struct Incident {
    pub direction: Vec3,
    pub normal: Vec3,
    pub wavelength_nm: f64,
    pub power: f64,
    pub stokes: Option<Stokes>,
    /// The refractive index of the medium before the interface.
    pub index: f64,
    /// The key of the random numbers of this ray.
    pub stream: u64,
}

/// The maximum number of facets of a rough face that are drawn to find one that is neither masked
/// nor shadowed. At a grazing angle one in 15 of the visible facets is accepted.
const MAX_FACETS: usize = 1024;

/// A ray that leaves an event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scattered {
    pub direction: Vec3,
    pub power: f64,
    pub stokes: Option<Stokes>,
    pub side: ExitSide,
    /// The optical path that a sheet adds.
    pub delay: f64,
}

/// The outcome of an event: up to two rays; the rest of the power is absorbed.
pub(crate) struct Outcome {
    pub event: Event,
    pub rays: [Option<Scattered>; 2],
}

impl Outcome {
    fn absorbed() -> Outcome {
        Outcome { event: Event::Absorbed, rays: [None, None] }
    }

    fn one(event: Event, ray: Scattered) -> Outcome {
        if ray.power > 0.0 { Outcome { event, rays: [Some(ray), None] } } else { Outcome::absorbed() }
    }
}

impl Incident {
    fn random(&self, settings: &TraceSettings) -> ChaCha8Rng {
        let mut random = ChaCha8Rng::seed_from_u64(settings.seed);
        random.set_stream(self.stream);
        random
    }

    /// All of the light in a new direction.
    fn redirected(&self, direction: Vec3, side: ExitSide) -> Scattered {
        Scattered { direction, power: self.power, stokes: self.stokes, side, delay: 0.0 }
    }

    /// The light reflected by an ideal mirror.
    fn mirrored(&self, reflectance: f64) -> Scattered {
        let direction = reflect(self.direction, self.normal);
        // a perfect conductor: the phases of s and p differ by half a turn about the direction of travel
        let amplitude = reflectance.sqrt();
        let amplitudes = [Complex64::from(-amplitude), Complex64::from(amplitude)];
        self.with(amplitudes, direction, self.normal, ExitSide::Incident)
    }

    /// A ray with amplitudes for s and p, a diagonal Jones matrix.
    fn with(&self, amplitudes: [Complex64; 2], direction: Vec3, normal: Vec3, side: ExitSide) -> Scattered {
        let mean = 0.5 * (amplitudes[0].norm_sqr() + amplitudes[1].norm_sqr());
        let stokes = self.stokes.map(|stokes| {
            let s = self.direction.cross(normal).try_normalize().unwrap_or(stokes.axis);
            let mut after = stokes.rotated_to(s, self.direction).through_jones(amplitudes);
            after.axis = s;
            after
        });
        let power = stokes.map_or(self.power * mean, |stokes| stokes.power());
        Scattered { direction, power, stokes, side, delay: 0.0 }
    }

    /// Scatters light at a face between two media.
    ///
    /// `index` is the refractive index behind the face, at the hit.
    pub fn scatter_at_face(
        &self,
        (behind, index): (&Substance, Complex64),
        face: &HitFace<'_>,
        settings: &TraceSettings,
    ) -> Outcome {
        let behind = (behind, index);
        match face.finish {
            Finish::Polished => self.at_interface(behind, &[], self.normal, settings),
            // films are listed from outside
            Finish::Coated(films) if face.from_inside => {
                let turned: Vec<Film> = films.iter().rev().copied().collect();
                self.at_interface(behind, &turned, self.normal, settings)
            }
            Finish::Coated(films) => self.at_interface(behind, films, self.normal, settings),
            Finish::Rough { slope } => {
                let ratio = match behind.0 {
                    Substance::Transparent(_) => Some(self.index / index.re),
                    Substance::Opaque | Substance::Metal(_) => None,
                };
                let facet = self.sample_facet(*slope, ratio, settings);
                self.at_interface(behind, &[], facet, settings)
            }
            Finish::Mirror { reflectance } => Outcome::one(Event::Reflected, self.mirrored(*reflectance)),
            Finish::Absorber => Outcome::absorbed(),
            Finish::Diffuse { reflectance } => self.diffuse(*reflectance, settings),
            Finish::Splitter { reflectance } => match behind.0 {
                Substance::Transparent(_) => {
                    match refract(self.direction, self.normal, self.index / index.re) {
                        Some(through) => self.split(*reflectance, through, settings),
                        None => Outcome::one(Event::TotallyReflected, self.mirrored(1.0)),
                    }
                }
                Substance::Opaque | Substance::Metal(_) => {
                    Outcome::one(Event::Reflected, self.mirrored(*reflectance))
                }
            },
        }
    }

    /// Scatters light at a smooth interface, according to the Fresnel equations or the transfer matrix of films.
    fn at_interface(
        &self,
        (behind, index): (&Substance, Complex64),
        films: &[Film],
        normal: Vec3,
        settings: &TraceSettings,
    ) -> Outcome {
        let is_metal = match behind {
            Substance::Opaque => return Outcome::absorbed(),
            Substance::Transparent(_) => false,
            Substance::Metal(_) => true,
        };
        // a gradient with no index here is not a medium: the face absorbs
        if index.re.is_nan() || index.re <= 0.0 {
            return Outcome::absorbed();
        }
        if !is_metal && settings.branches == Branches::Ideal {
            return self.ideal(index.re, normal);
        }
        let behind = if is_metal { index } else { Complex64::from(index.re) };
        let cosine = -self.direction.dot(normal);
        let found = transfer_matrix(self.index, films, behind, cosine.min(1.0), self.wavelength_nm);
        let through = match is_metal {
            true => None,
            false => refract(self.direction, normal, self.index / index.re),
        };
        self.branch(&found, through, normal, is_metal, settings)
    }

    /// Lossless refraction, or total internal reflection.
    fn ideal(&self, index: f64, normal: Vec3) -> Outcome {
        if index == self.index {
            return Outcome::one(Event::Transmitted, self.redirected(self.direction, ExitSide::Transmitted));
        }
        match refract(self.direction, normal, self.index / index) {
            Some(direction) => {
                let ones = [Complex64::ONE; 2];
                Outcome::one(Event::Transmitted, self.with(ones, direction, normal, ExitSide::Transmitted))
            }
            None => {
                let cosine = -self.direction.dot(normal);
                let found = fresnel(self.index, Complex64::from(index), cosine.min(1.0));
                // exactly all of the power, despite rounding
                let unit = found.reflected.map(|amplitude| amplitude / amplitude.norm());
                let direction = reflect(self.direction, normal);
                Outcome::one(Event::TotallyReflected, self.with(unit, direction, normal, ExitSide::Incident))
            }
        }
    }

    /// The reflected and the transmitted ray, or one of them at random.
    fn branch(
        &self,
        found: &Amplitudes,
        through: Option<Vec3>,
        normal: Vec3,
        is_metal: bool,
        settings: &TraceSettings,
    ) -> Outcome {
        let back = self.with(found.reflected, reflect(self.direction, normal), normal, ExitSide::Incident);
        let Some(direction) = through else {
            let event = if is_metal { Event::Reflected } else { Event::TotallyReflected };
            return Outcome::one(event, back);
        };
        let on = self.with(found.transmitted, direction, normal, ExitSide::Transmitted);
        self.choose(back, on, settings)
    }

    /// Reflects a fraction of the light and transmits the rest, independent of polarisation.
    fn split(&self, reflectance: f64, through: Vec3, settings: &TraceSettings) -> Outcome {
        let back = self.mirrored(reflectance);
        let amplitudes = [Complex64::from((1.0 - reflectance).sqrt()); 2];
        let on = self.with(amplitudes, through, self.normal, ExitSide::Transmitted);
        if settings.branches == Branches::Ideal {
            let rays = [back, on].map(|ray| (ray.power > 0.0).then_some(ray));
            return Outcome { event: Event::Split, rays };
        }
        self.choose(back, on, settings)
    }

    fn choose(&self, back: Scattered, on: Scattered, settings: &TraceSettings) -> Outcome {
        match settings.branches {
            Branches::Ideal | Branches::Both => match (back.power > 0.0, on.power > 0.0) {
                (true, true) => Outcome { event: Event::Split, rays: [Some(on), Some(back)] },
                (true, false) => Outcome::one(Event::Reflected, back),
                _ => Outcome::one(Event::Transmitted, on),
            },
            Branches::Random => {
                let drawn: f64 = self.random(settings).random::<f64>() * self.power;
                // the chosen ray carries all the power; absorbed light ends
                let all = |ray: Scattered| Scattered {
                    power: self.power,
                    stokes: ray.stokes.map(|stokes| stokes.with_power(self.power)),
                    ..ray
                };
                match () {
                    () if drawn < back.power => Outcome::one(Event::Reflected, all(back)),
                    () if drawn < back.power + on.power => Outcome::one(Event::Transmitted, all(on)),
                    () => self.absorbed_or_transmitted(back, on, all),
                }
            }
        }
    }

    /// The outcome of a draw beyond the sum of both powers: absorbed, or transmitted where only
    /// rounding keeps the sum below 1.
    fn absorbed_or_transmitted(
        &self,
        back: Scattered,
        on: Scattered,
        all: impl Fn(Scattered) -> Scattered,
    ) -> Outcome {
        let is_rounding = self.power - (back.power + on.power) <= 1e-12 * self.power;
        if is_rounding { Outcome::one(Event::Transmitted, all(on)) } else { Outcome::absorbed() }
    }

    /// Diffuse reflection according to Lambert's cosine law: uniform on the disk below the
    /// hemisphere (Malley's method).
    fn diffuse(&self, reflectance: f64, settings: &TraceSettings) -> Outcome {
        let mut random = self.random(settings);
        let (radius, angle) = (random.random::<f64>().sqrt(), std::f64::consts::TAU * random.random::<f64>());
        let (u, v) = self.normal.any_orthonormal_pair();
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let height = (1.0 - radius * radius).max(0.0).sqrt();
        let direction = (radius * (cosine * u + sine * v) + height * self.normal).normalize();
        let power = reflectance * self.power;
        let stokes = self.stokes.map(|_| Stokes::unpolarised(power, direction));
        let ray = Scattered { direction, power, stokes, side: ExitSide::Incident, delay: 0.0 };
        Outcome::one(Event::Scattered, ray)
    }

    /// The normal of a random microfacet of a rough face: Gaussian slopes by the method of Box &
    /// Muller (Ann. Math. Stat. 29, 610, 1958), weighted by the visible area of the facet, which is
    /// the cosine of its angle to the light divided by that of its angle to the mean normal.
    ///
    /// A facet that faces away from the light, or would scatter it to the wrong side of the mean
    /// face, is masked or shadowed by others (Walter, Marschner, Li & Torrance, *Microfacet Models
    /// for Refraction through Rough Surfaces*, EGSR 2007, section 4.1). A new facet is drawn
    /// instead, so that the shadowed power is shared among the remaining directions, and none is
    /// lost. `ratio` is the index before divided by the index behind.
    fn sample_facet(&self, slope: f64, ratio: Option<f64>, settings: &TraceSettings) -> Vec3 {
        let mut random = self.random(settings);
        // the branch is drawn from the same stream and must not use the same number
        random.next_u64();
        let (u, v) = self.normal.any_orthonormal_pair();
        let cosine = -self.direction.dot(self.normal);
        // slopes beyond six standard deviations, one in 10^9, do not increase the bound
        let most = cosine + 6.0 * slope * (1.0 - cosine * cosine).max(0.0).sqrt();
        for _ in 0..MAX_FACETS {
            let (a, b): (f64, f64) = (1.0 - random.random::<f64>(), random.random());
            let length = slope * (-2.0 * libm::log(a)).sqrt();
            let angle = std::f64::consts::TAU * b;
            let tilt = length * (libm::cos(angle) * u + libm::sin(angle) * v);
            let is_visible = random.random::<f64>() * most < -self.direction.dot(self.normal + tilt);
            let facet = (self.normal + tilt).normalize();
            if is_visible && self.is_unshadowed(facet, ratio) {
                return facet;
            }
        }
        self.normal
    }

    /// True if light reaches a facet and leaves it on the right side of the mean face, both
    /// reflected and refracted.
    fn is_unshadowed(&self, facet: Vec3, ratio: Option<f64>) -> bool {
        let through = ratio.and_then(|ratio| refract(self.direction, facet, ratio));
        self.direction.dot(facet) < 0.0
            && reflect(self.direction, facet).dot(self.normal) > 0.0
            && through.is_none_or(|through| through.dot(self.normal) < 0.0)
    }

    /// Scatters light at a sheet with a frame and its inverse. `point` is the hit, `unit_nm` the
    /// unit of length.
    pub fn scatter_at_sheet(
        &self,
        action: &Action,
        (frame, local): (&Affine, &Affine),
        point: Vec3,
        unit_nm: f64,
        settings: &TraceSettings,
    ) -> Outcome {
        let on = |direction| self.redirected(direction, ExitSide::Transmitted);
        match action {
            Action::Absorb => Outcome::absorbed(),
            Action::Record => Outcome::one(Event::Passed, on(self.direction)),
            Action::Mirror { reflectance } => Outcome::one(Event::Reflected, self.mirrored(*reflectance)),
            Action::Splitter { reflectance } => self.split(*reflectance, self.direction, settings),
            Action::ThinLens { focal_length } => {
                let (direction, delay) =
                    thin_lens(local.vector(self.direction), local.point(point), *focal_length);
                let direction = frame.vector(direction).normalize();
                Outcome::one(Event::Bent, Scattered { delay: self.index * delay, ..on(direction) })
            }
            Action::Grating { lines, order, reflects } => {
                let side = if *reflects { self.normal } else { -self.normal };
                // the optical path gains `order` wavelengths with each period from the centre
                let periods = lines.dot(local.point(point));
                // a covector, the gradient of the number of periods: a stretched grating has fewer lines
                let lines = local.linear.transpose() * *lines;
                let lines = lines - lines.dot(side) * side;
                let wavelength = self.wavelength_nm / unit_nm;
                let media = [self.index; 2];
                let found = diffract(self.direction, side, media, lines, *order, wavelength);
                let exit = if *reflects { ExitSide::Incident } else { ExitSide::Transmitted };
                match found {
                    Some(direction) => {
                        let delay = f64::from(*order) * wavelength * periods;
                        let event = if *reflects { Event::Reflected } else { Event::Bent };
                        Outcome::one(event, Scattered { delay, ..self.redirected(direction, exit) })
                    }
                    None => Outcome::absorbed(),
                }
            }
            Action::Polariser { .. } | Action::Retarder { .. } => self.polarise(action, frame),
        }
    }

    /// Passes light through a polariser or a retarder, using its diagonal Jones matrix.
    fn polarise(&self, action: &Action, frame: &Affine) -> Outcome {
        let Some((axis, amplitudes)) = action.jones() else { return Outcome::absorbed() };
        let across = frame.vector(axis);
        let across = across - across.dot(self.direction) * self.direction;
        let (Some(axis), Some(stokes)) = (across.try_normalize(), self.stokes) else {
            // unpolarised light has half of its power along each axis
            let power = self.power * 0.5 * (amplitudes[0].norm_sqr() + amplitudes[1].norm_sqr());
            let ray = Scattered { power, ..self.redirected(self.direction, ExitSide::Transmitted) };
            return Outcome::one(Event::Passed, ray);
        };
        let after = stokes.rotated_to(axis, self.direction).through_jones(amplitudes);
        let all = self.redirected(self.direction, ExitSide::Transmitted);
        Outcome::one(Event::Passed, Scattered { power: after.power(), stokes: Some(after), ..all })
    }
}

/// The direction behind an ideal thin lens in the plane z = 0 of its frame, and the path length that it adds.
///
/// Slopes change by the height over the focal length. The added path length makes all paths from an
/// object point to its image equal to the path through the centre of the lens. One ray does not
/// determine its object point: the point is assumed at the distance `h^2 / (h . p)` before the
/// lens, where a meridional ray crosses the axis (h is the height as a vector, p the slope). Paths
/// from every point of the axis to its image are then equal, in both directions; paths from points
/// off the axis are equal up to terms of fourth order, because no lens images all of space with
/// equal paths (Born & Wolf, *Principles of Optics*, 7th edition, section 4.2.3).
fn thin_lens(direction: Vec3, point: Vec3, focal_length: f64) -> (Vec3, f64) {
    let across = |v: Vec3| Vec3::new(v.x, v.y, 0.0);
    let height = across(point);
    let before = across(direction) / direction.z.abs();
    let behind = before - height / focal_length;
    let square = height.length_squared();
    // the sagittal component of the slope, which does not change
    let sagittal = if square > 0.0 { before.cross(height).length_squared() / square } else { 0.0 };
    let term =
        |slope: Vec3| height.dot(slope) / ((1.0 + slope.length_squared()).sqrt() + (1.0 + sagittal).sqrt());
    (behind + direction.z.signum() * Vec3::Z, term(behind) - term(before))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The path lengths from points of the axis to their images, through the centre and at any height.
    #[test]
    fn thin_lenses_make_paths_equal() {
        for (focal_length, before) in [(50.0_f64, 120.0_f64), (50.0, 30.0), (-40.0, 70.0), (50.0, 1e9)] {
            let behind = 1.0 / (1.0 / focal_length - 1.0 / before);
            for height in [Vec3::new(3.0, -4.0, 0.0), Vec3::new(0.0, 12.0, 0.0)] {
                let from = Vec3::new(0.0, 0.0, -before);
                let (direction, delay) = thin_lens((height - from).normalize(), height, focal_length);
                let image = Vec3::Z * behind;
                let across = (image - height).cross(direction).length() / direction.length();
                assert!(across < 1e-12 * behind.abs(), "{focal_length} {before}");
                // a virtual image lies behind the light: lengths count backwards
                let found =
                    (height - from).length() - before + delay + behind.signum() * (image - height).length()
                        - behind;
                assert!(found.abs() < 1e-15 * before.abs() + 2e-14, "{focal_length} {before}: {found}");
                let back = thin_lens(-direction.normalize(), height, focal_length);
                assert!((back.1 - delay).abs() < 1e-14);
            }
        }
        assert_eq!(thin_lens(Vec3::new(0.1, 0.0, 1.0), Vec3::ZERO, 10.0), (Vec3::new(0.1, 0.0, 1.0), 0.0));
    }
}
