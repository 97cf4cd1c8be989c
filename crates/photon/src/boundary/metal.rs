//! Reflection at a metal, by a given reflectivity or by a complex index.

use super::event::BoundaryEvent;
use super::process::{MAX_ROUNDS, Process};
use crate::surface::{SurfaceFinish, SurfaceModel};
use num_complex::Complex64;
use rayweave_optics::interface::fresnel;

impl Process<'_> {
    /// Replaces the reflectivity by that of the complex index, if the surface has one.
    pub fn use_complex_index(&mut self, index: f64) {
        if let Some(metal) = self.values.metal {
            self.values.reflectivity = self.metal_reflectivity(index, metal);
        }
    }

    /// A dielectric in front of a metal.
    pub fn metal(&mut self, index: f64) {
        for round in 1..=MAX_ROUNDS {
            let u = self.stream.uniform();
            if round == 1 && u > self.values.reflectivity {
                let is_absorbed = u > self.values.reflectivity + self.values.transmittance;
                return if is_absorbed { self.absorb() } else { self.event = BoundaryEvent::Transmission };
            }
            if let (2.., Some(metal)) = (round, self.values.metal) {
                self.values.reflectivity = self.metal_reflectivity(index, metal);
                if !self.stream.chance(self.values.reflectivity) {
                    return self.absorb();
                }
            }
            self.reflect_at_metal(round == 1);
            if self.direction.dot(self.normal) >= 0.0 {
                return;
            }
        }
        self.absorb();
    }

    fn reflect_at_metal(&mut self, is_first: bool) {
        if self.values.model == SurfaceModel::Glisur || self.values.finish == SurfaceFinish::Polished {
            return self.reflect();
        }
        if is_first {
            self.choose_reflection();
        }
        match self.event {
            BoundaryEvent::LambertianReflection => return self.reflect(),
            BoundaryEvent::BackScattering => return self.turn_back(),
            // with a complex index the facet was selected together with the reflectivity
            BoundaryEvent::LobeReflection if self.values.metal.is_none() => self.facet = self.facet_normal(),
            BoundaryEvent::LobeReflection => {}
            _ => self.facet = self.normal,
        }
        let across = self.direction.cross(self.facet).try_normalize();
        self.mirror();
        if let (Some(across), true) = (across, self.reflected != [true; 2]) {
            let along = self.direction.cross(across).normalize();
            self.polarisation = -(if self.reflected[0] { across } else { along });
        }
    }

    /// The reflectance of a metal for the polarised photon at a facet, by the Fresnel equations with a complex index;
    /// selects the components that are reflected.
    fn metal_reflectivity(&mut self, index: f64, metal: Complex64) -> f64 {
        self.facet =
            if self.values.finish == SurfaceFinish::Ground { self.facet_normal() } else { self.normal };
        let cosine = (-self.direction.dot(self.facet)).clamp(0.0, 1.0);
        let [s, p] = fresnel(index, metal, cosine).reflected.map(|amplitude| amplitude.norm_sqr());
        let across = self.direction.cross(self.facet).try_normalize();
        let fraction = across.map_or(0.0, |across| {
            let s = self.polarisation.dot(across);
            s * s
        });
        let (s, p) = (s * fraction, p * (1.0 - fraction));
        let reflectivity = s + p;
        for _ in 0..MAX_ROUNDS {
            self.reflected = [s, p].map(|part| self.stream.uniform() * reflectivity <= part);
            if self.reflected != [false; 2] {
                break;
            }
        }
        reflectivity
    }
}
