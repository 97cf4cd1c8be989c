//! Surfaces with tables: measured reflectors (`LUT`), computed reflectors (`DAVIS`) and dichroic filters.

use super::event::BoundaryEvent;
use super::process::{GRAZING, MAX_ROUNDS, Process};
use crate::property::wavelength_nm;
use crate::surface::{SurfaceFinish, SurfaceModel};
use crate::tables::{DavisTable, DichroicTable, LutTable};
use rayweave_math::Vec3;

impl Process<'_> {
    /// The angle of incidence in radians.
    fn incidence(&self) -> f64 {
        libm::acos((-self.direction.dot(self.normal)).clamp(-1.0, 1.0))
    }

    /// Reflection into a measured distribution of directions, after the losses at the surface
    /// (`G4OpBoundaryProcess::DielectricLUT`).
    pub fn lut(&mut self, table: &LutTable) {
        let (angle, reversed) = (self.incidence(), -self.direction);
        let across = reversed.cross(self.normal);
        let across = if across.length() < GRAZING { orthogonal(reversed) } else { across }.normalize();
        for _ in 0..MAX_ROUNDS {
            if self.is_lost() {
                return;
            }
            let [theta, phi] = table.sample(angle.to_degrees(), self.stream.uniform());
            let in_plane = rotated(reversed, across, angle - theta);
            let direction = rotated(in_plane, across.cross(in_plane).normalize(), -phi);
            if direction.dot(self.normal) > 0.0 {
                self.event = BoundaryEvent::LutReflection;
                return self.leave_along(direction);
            }
        }
        self.absorb();
    }

    /// Reflection or transmission into samples of directions (`G4OpBoundaryProcess::DielectricLUTDAVIS`). Geant4 leaves the
    /// polarisation of reflected photons as it was, not perpendicular to their direction; here it turns with them, as that
    /// of transmitted photons does in both.
    pub fn davis(&mut self, table: &DavisTable) {
        let row = DavisTable::row(self.incidence().to_degrees());
        let is_reflected = self.stream.uniform() <= table.reflectance(row);
        if !is_reflected && self.values.efficiency > 0.0 {
            return self.absorb();
        }
        self.event = if is_reflected { BoundaryEvent::LobeReflection } else { BoundaryEvent::Transmission };
        if row == 0 {
            // within a degree of the normal photons return or pass undeviated
            return if is_reflected {
                self.turn_back()
            };
        }
        let Some([azimuth, elevation]) = table.sample(is_reflected, row, self.stream.uniform()) else {
            return self.absorb();
        };
        let across = self.normal.cross(self.direction).normalize();
        let along = across.cross(self.normal);
        let lateral = libm::cos(azimuth) * along + libm::sin(azimuth) * across;
        self.leave_along(libm::sin(elevation) * lateral + libm::cos(elevation) * self.normal);
    }

    /// Undeviated transmission by the table, or reflection (`G4OpBoundaryProcess::DielectricDichroic`).
    pub fn dichroic(&mut self, table: &DichroicTable) {
        let transmittance = table.transmittance(wavelength_nm(self.energy), self.incidence().to_degrees());
        if self.stream.chance(transmittance) {
            self.event = BoundaryEvent::Dichroic;
            return;
        }
        if self.values.model == SurfaceModel::Glisur || self.values.finish == SurfaceFinish::Polished {
            return self.reflect();
        }
        self.choose_reflection();
        match self.event {
            BoundaryEvent::LambertianReflection => self.reflect(),
            BoundaryEvent::BackScattering => self.turn_back(),
            BoundaryEvent::SpikeReflection => self.mirror(),
            _ => self.reflect_at_facet(),
        }
    }

    /// The mirror reflection about a facet that sends the photon away from the surface.
    fn reflect_at_facet(&mut self) {
        let incident = (self.direction, self.polarisation);
        for _ in 0..MAX_ROUNDS {
            (self.direction, self.polarisation) = incident;
            self.facet = self.facet_normal();
            self.mirror();
            if self.direction.dot(self.normal) > 0.0 {
                return;
            }
        }
        self.absorb();
    }
}

/// A vector turned about a unit vector by an angle in radians (Rodrigues).
fn rotated(vector: Vec3, axis: Vec3, angle: f64) -> Vec3 {
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    cosine * vector + sine * axis.cross(vector) + (1.0 - cosine) * axis.dot(vector) * axis
}

/// A vector perpendicular to another: the smallest component becomes 0, as in CLHEP, whose choice decides the azimuth of
/// photons at normal incidence.
fn orthogonal(v: Vec3) -> Vec3 {
    let [x, y, z] = v.to_array().map(f64::abs);
    match () {
        () if x < y && x < z => Vec3::new(0.0, v.z, -v.y),
        () if x >= y && y < z => Vec3::new(-v.z, 0.0, v.x),
        () => Vec3::new(v.y, -v.x, 0.0),
    }
}
