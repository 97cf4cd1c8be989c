//! A thin film between two dielectrics.

use super::event::BoundaryEvent;
use super::process::{MAX_ROUNDS, Process};
use crate::property::wavelength_nm;
use crate::surface::Coating;
use num_complex::Complex64;
use rayweave_optics::interface::{Film, transfer_matrix};

impl Process<'_> {
    /// Reflection by a thin film, or transmission through it (`G4OpBoundaryProcess::CoatedDielectricDielectric`). A
    /// transmitted photon is absorbed at a surface with an efficiency.
    ///
    /// The reflectance is that of the film; the polarisation follows the Fresnel equations of the bare interface, as in
    /// Geant4. Beyond the critical angle of the two media all is reflected, where Geant4 has no valid number.
    pub fn coated(&mut self, coating: &Coating, mut index: f64, mut behind: f64) {
        let film_index = coating.index.at(self.energy);
        let film = Film::new(film_index, 0.0, coating.thickness * 1e6);
        let wavelength = wavelength_nm(self.energy);
        let mut is_through = false;
        for _ in 0..MAX_ROUNDS {
            if is_through {
                self.normal = -self.normal;
                (index, behind) = (behind, index);
            }
            self.facet = self.facet_of_finish();
            let cosine = (-self.direction.dot(self.facet)).clamp(0.0, 1.0);
            let is_beyond = index * (1.0 - cosine * cosine).sqrt() >= film_index;
            let open = self.wave(index, behind);
            let open = open.filter(|_| !is_beyond || coating.has_frustrated_transmission);
            let transmittance = open.map_or(0.0, |wave| {
                let amplitudes = transfer_matrix(index, &[film], Complex64::from(behind), cosine, wavelength);
                let [s, p] = amplitudes.reflected.map(|amplitude| amplitude.norm_sqr());
                1.0 - p - (s - p) * wave.fraction_across()
            });
            match (open, self.stream.chance(transmittance)) {
                (Some(_), true) if self.values.efficiency > 0.0 => return self.absorb(),
                (Some(wave), true) => {
                    is_through = true;
                    self.event = match is_beyond {
                        true => BoundaryEvent::CoatedFrustratedTransmission,
                        false => BoundaryEvent::CoatedRefraction,
                    };
                    self.refract(&wave);
                }
                (Some(wave), false) => {
                    is_through = false;
                    self.event = match is_beyond {
                        true => BoundaryEvent::TotalInternalReflection,
                        false => BoundaryEvent::CoatedReflection,
                    };
                    self.reflect_wave(&wave);
                }
                (None, _) => {
                    is_through = false;
                    self.event = BoundaryEvent::TotalInternalReflection;
                    self.mirror();
                }
            }
            if self.has_left(is_through) {
                return;
            }
        }
        self.absorb();
    }
}
