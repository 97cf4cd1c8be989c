//! The interface between two dielectrics, bare or with paint in front of it or behind a layer.

use super::event::BoundaryEvent;
use super::process::{GRAZING, MAX_ROUNDS, Process, mirrored};
use crate::property::wavelength_nm;
use crate::surface::{SurfaceFinish, SurfaceModel};
use rayweave_math::Vec3;

/// A photon at a facet between two dielectrics, below the critical angle: its amplitudes by the Fresnel equations (J. D.
/// Jackson, *Classical Electrodynamics*, section 7.3).
#[derive(Clone, Copy, Debug)]
pub(super) struct FacetWave {
    index: f64,
    behind: f64,
    /// Cosines of the angles of incidence and refraction.
    cosines: [f64; 2],
    is_oblique: bool,
    /// The unit vector perpendicular to the plane of incidence.
    across: Vec3,
    /// The incident amplitudes across the plane of incidence and in it.
    incident: [f64; 2],
    /// The refracted amplitudes.
    refracted: [f64; 2],
}

impl FacetWave {
    /// The fraction of the power that a bare interface transmits.
    pub fn transmittance(&self) -> f64 {
        let [s, p] = self.refracted;
        let [flux1, flux2] = [self.index * self.cosines[0], self.behind * self.cosines[1]];
        if self.cosines[0] == 0.0 { 0.0 } else { flux2 * (s * s + p * p) / flux1 }
    }

    /// The fraction of the incident power that oscillates perpendicular to the plane of incidence.
    pub fn fraction_across(&self) -> f64 {
        let [s, p] = self.incident.map(|amplitude| amplitude * amplitude);
        s / (s + p)
    }

    /// The polarisation with two amplitudes for a direction in the plane of incidence.
    fn polarisation(&self, direction: Vec3, [s, p]: [f64; 2]) -> Vec3 {
        let along = direction.cross(self.across).normalize();
        (p * along + s * self.across) / (s * s + p * p).sqrt()
    }
}

impl Process<'_> {
    /// A surface between two dielectrics whose losses come first.
    pub fn dielectric(&mut self, index: f64, behind: f64) {
        if self.is_lost() {
            return;
        }
        match self.values.finish {
            SurfaceFinish::PolishedFrontPainted => self.reflect(),
            SurfaceFinish::GroundFrontPainted => {
                self.event = BoundaryEvent::LambertianReflection;
                self.reflect();
            }
            _ => self.interface(index, behind),
        }
    }

    /// The interface between two dielectrics, with paint behind it for the back-painted finishes.
    pub fn interface(&mut self, mut index: f64, mut behind: f64) {
        let (mut is_inside, mut is_swapped, mut is_through) = (false, false, false);
        let passes_roughness = self.passes_roughness(index, behind);
        for _ in 0..MAX_ROUNDS {
            if is_through {
                is_swapped = !is_swapped;
                self.normal = -self.normal;
                (index, behind) = (behind, index);
            }
            is_through = self.refract_or_reflect(index, behind, passes_roughness);
            if is_through {
                is_inside = !is_inside;
            } else {
                is_swapped = false;
            }
            if !self.has_left(is_through) {
                continue;
            }
            if !(is_inside && !is_swapped && self.values.finish.is_back_painted()) || self.is_lost() {
                return;
            }
            // reflection by the paint, back through the layer
            if self.event == BoundaryEvent::FresnelRefraction {
                is_swapped = !is_swapped;
                (index, behind) = (behind, index);
            } else {
                self.normal = -self.normal;
            }
            if self.values.finish == SurfaceFinish::GroundBackPainted {
                self.event = BoundaryEvent::LambertianReflection;
            }
            self.reflect();
            self.normal = -self.normal;
            is_through = false;
        }
        self.absorb();
    }

    /// True if the photon leaves the surface after refraction or reflection at a facet.
    pub fn has_left(&self, is_through: bool) -> bool {
        let rise = self.direction.dot(self.normal);
        if is_through { rise <= 0.0 } else { rise >= -GRAZING }
    }

    /// False if the roughness of the surface makes a reflection diffuse.
    fn passes_roughness(&mut self, index: f64, behind: f64) -> bool {
        let roughness = self.values.roughness;
        if roughness == 0.0 || index <= behind {
            return true;
        }
        let facet = self.facet_of_finish();
        let cosine = -self.direction.dot(facet);
        let wavelength = wavelength_nm(self.energy) * 1e-6;
        let phase = 4.0 * std::f64::consts::PI * roughness * index * cosine / wavelength;
        self.stream.chance(libm::exp(-phase * phase))
    }

    /// One event at one facet; true for refraction.
    fn refract_or_reflect(&mut self, index: f64, behind: f64, passes_roughness: bool) -> bool {
        self.facet = self.facet_of_finish();
        let Some(wave) = self.wave(index, behind) else {
            self.event = BoundaryEvent::TotalInternalReflection;
            if self.is_reflected_like_a_facet(passes_roughness) {
                self.mirror();
            }
            return false;
        };
        if self.stream.chance(wave.transmittance()) {
            self.event = BoundaryEvent::FresnelRefraction;
            self.refract(&wave);
            return true;
        }
        self.event = BoundaryEvent::FresnelReflection;
        if self.is_reflected_like_a_facet(passes_roughness) {
            self.reflect_wave(&wave);
        }
        false
    }

    /// The amplitudes of the photon at the facet; `None` beyond the critical angle.
    pub fn wave(&self, index: f64, behind: f64) -> Option<FacetWave> {
        let cosine = -self.direction.dot(self.facet);
        let is_oblique = cosine.abs() < 1.0 - GRAZING;
        let sin1 = if is_oblique { (1.0 - cosine * cosine).sqrt() } else { 0.0 };
        let sin2 = sin1 * index / behind;
        if sin2 >= 1.0 {
            return None;
        }
        let refracted = (1.0 - sin2 * sin2).sqrt().copysign(cosine);
        let across =
            if is_oblique { self.direction.cross(self.facet).normalize() } else { self.polarisation };
        let [s, p] = if is_oblique {
            let s = self.polarisation.dot(across);
            [s, (self.polarisation - s * across).length()]
        } else {
            [0.0, 1.0]
        };
        let flux = 2.0 * index * cosine;
        Some(FacetWave {
            index,
            behind,
            cosines: [cosine, refracted],
            is_oblique,
            across,
            incident: [s, p],
            refracted: [
                flux * s / (index * cosine + behind * refracted),
                flux * p / (behind * cosine + index * refracted),
            ],
        })
    }

    /// Direction and polarisation behind the facet.
    pub fn refract(&mut self, wave: &FacetWave) {
        if wave.is_oblique {
            let bend = wave.cosines[0] - wave.cosines[1] * (wave.behind / wave.index);
            self.direction = (self.direction + bend * self.facet).normalize();
            self.polarisation = wave.polarisation(self.direction, wave.refracted);
        }
    }

    /// Direction and polarisation after reflection by a bare interface.
    pub fn reflect_wave(&mut self, wave: &FacetWave) {
        self.direction = mirrored(self.direction, self.facet);
        let [[s1, p1], [s2, p2]] = [wave.incident, wave.refracted];
        self.polarisation = match () {
            () if wave.is_oblique => {
                wave.polarisation(self.direction, [s2 - s1, wave.behind * p2 / wave.index - p1])
            }
            () if wave.behind > wave.index => -self.polarisation,
            () => self.polarisation,
        };
    }

    /// Selects the kind of a reflection; applies diffuse reflection and backscattering. True for the others.
    fn is_reflected_like_a_facet(&mut self, passes_roughness: bool) -> bool {
        if !passes_roughness {
            self.event = BoundaryEvent::LambertianReflection;
        }
        if self.values.model == SurfaceModel::Unified && self.values.finish != SurfaceFinish::Polished {
            self.choose_reflection();
        }
        match self.event {
            BoundaryEvent::LambertianReflection => self.reflect(),
            BoundaryEvent::BackScattering => self.turn_back(),
            _ => return true,
        }
        false
    }
}
