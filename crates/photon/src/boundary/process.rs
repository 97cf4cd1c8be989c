//! The state of the boundary process, and the steps that several types of surfaces share.

use super::event::BoundaryEvent;
use crate::philox::Stream;
use crate::property::PropertyTable;
use crate::surface::{OpticalSurface, SurfaceFinish, SurfaceModel, SurfaceType};
use num_complex::Complex64;
use rayweave_math::Vec3;

/// Cosines within this distance of 1 are treated as normal incidence, and directions as far behind a surface as on it
/// (Geant4's surface tolerance).
pub(crate) const GRAZING: f64 = 1e-9;

/// The number of facets and layers at which one photon may scatter in one event before it counts as absorbed. Geant4
/// has no limit for facets; each round ends with a probability of the order of 1.
pub(super) const MAX_ROUNDS: u32 = 1000;

/// The quantities of a surface at the energy of the photon.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceValues {
    pub finish: SurfaceFinish,
    pub model: SurfaceModel,
    pub kind: SurfaceType,
    pub value: f64,
    pub reflectivity: f64,
    pub transmittance: f64,
    pub efficiency: f64,
    pub metal: Option<Complex64>,
    pub lobe: f64,
    pub spike: f64,
    pub backscatter: f64,
    pub roughness: f64,
}

impl SurfaceValues {
    /// Those of an interface without a surface: polished, without losses.
    const BARE: SurfaceValues = SurfaceValues {
        finish: SurfaceFinish::Polished,
        model: SurfaceModel::Glisur,
        kind: SurfaceType::DielectricDielectric,
        value: 1.0,
        reflectivity: 1.0,
        transmittance: 0.0,
        efficiency: 0.0,
        metal: None,
        lobe: 0.0,
        spike: 0.0,
        backscatter: 0.0,
        roughness: 0.0,
    };

    pub fn new(surface: Option<&OpticalSurface>, energy: f64) -> SurfaceValues {
        let Some(surface) = surface else { return SurfaceValues::BARE };
        let at = |table: &Option<PropertyTable>, absent: f64| {
            table.as_ref().map_or(absent, |table| table.at(energy))
        };
        let lobe = |table| if surface.model == SurfaceModel::Unified { at(table, 0.0) } else { 0.0 };
        let metal = surface.metal_index.as_ref().map(|(re, im)| Complex64::new(re.at(energy), im.at(energy)));
        SurfaceValues {
            finish: surface.finish,
            model: surface.model,
            kind: surface.kind,
            value: surface.value,
            reflectivity: at(&surface.reflectivity, 1.0),
            transmittance: at(&surface.transmittance, 0.0),
            efficiency: at(&surface.efficiency, 0.0),
            // REFLECTIVITY has priority over a complex index
            metal: metal.filter(|_| surface.reflectivity.is_none()),
            lobe: lobe(&surface.lobe),
            spike: lobe(&surface.spike),
            backscatter: lobe(&surface.backscatter),
            roughness: surface.roughness,
        }
    }
}

/// The process in progress.
pub(super) struct Process<'s> {
    pub values: SurfaceValues,
    pub stream: &'s mut Stream,
    pub direction: Vec3,
    pub polarisation: Vec3,
    pub normal: Vec3,
    pub facet: Vec3,
    pub energy: f64,
    pub event: BoundaryEvent,
    /// For a metal: which of the components s and p is reflected.
    pub reflected: [bool; 2],
}

impl Process<'_> {
    pub fn absorb(&mut self) {
        let is_detected = self.stream.chance(self.values.efficiency);
        self.event = if is_detected { BoundaryEvent::Detection } else { BoundaryEvent::Absorption };
    }

    /// True if the photon is lost or transmitted at the surface before it is reflected or refracted.
    pub fn is_lost(&mut self) -> bool {
        let u = self.stream.uniform();
        match () {
            () if u > self.values.reflectivity + self.values.transmittance => self.absorb(),
            () if u > self.values.reflectivity => self.event = BoundaryEvent::Transmission,
            () => return false,
        }
        true
    }

    /// Reflection by paint: diffuse, or about a facet, or about the normal.
    pub fn reflect(&mut self) {
        if self.event == BoundaryEvent::LambertianReflection {
            let direction = self.stream.lambertian(self.normal);
            return self.leave_along(direction);
        }
        self.event = BoundaryEvent::SpikeReflection;
        if self.values.finish == SurfaceFinish::Ground {
            self.event = BoundaryEvent::LobeReflection;
            // with a complex index the facet was selected together with the reflectivity
            if self.values.metal.is_none() {
                self.facet = self.facet_normal();
            }
        } else {
            self.facet = self.normal;
        }
        self.mirror();
    }

    /// The mirror reflection about the facet, without a phase between s and p.
    pub fn mirror(&mut self) {
        self.direction = mirrored(self.direction, self.facet);
        self.polarisation = -mirrored(self.polarisation, self.facet);
    }

    /// A new direction with the polarisation of the mirror reflection that leads to it.
    pub fn leave_along(&mut self, direction: Vec3) {
        if let Some(facet) = (direction - self.direction).try_normalize() {
            self.facet = facet;
            self.polarisation = -mirrored(self.polarisation, facet);
        }
        self.direction = direction;
    }

    pub fn turn_back(&mut self) {
        (self.direction, self.polarisation) = (-self.direction, -self.polarisation);
    }

    /// Selects the kind of reflection of a rough surface of the unified model.
    pub fn choose_reflection(&mut self) {
        let u = self.stream.uniform();
        let SurfaceValues { spike, lobe, backscatter, .. } = self.values;
        self.event = match () {
            () if u < spike => {
                self.facet = self.normal;
                BoundaryEvent::SpikeReflection
            }
            () if u < spike + lobe => BoundaryEvent::LobeReflection,
            () if u < spike + lobe + backscatter => BoundaryEvent::BackScattering,
            () => BoundaryEvent::LambertianReflection,
        };
    }

    /// The normal of the surface if it is polished, otherwise that of a facet.
    pub fn facet_of_finish(&mut self) -> Vec3 {
        if self.values.finish == SurfaceFinish::Polished { self.normal } else { self.facet_normal() }
    }

    /// The normal of a microfacet that the photon can reach.
    pub fn facet_normal(&mut self) -> Vec3 {
        if self.values.model.has_gaussian_facets() { self.gaussian_facet() } else { self.facet_in_ball() }
    }

    /// A facet at an angle of the density exp(-alpha^2 / (2 sigma^2)) sin alpha.
    fn gaussian_facet(&mut self) -> Vec3 {
        let sigma = self.values.value;
        if sigma == 0.0 {
            return self.normal;
        }
        let bound = (4.0 * sigma).min(1.0);
        for _ in 0..MAX_ROUNDS {
            let alpha = sigma * self.stream.normal();
            let is_outside = alpha >= std::f64::consts::FRAC_PI_2;
            if self.stream.uniform() * bound > libm::sin(alpha) || is_outside {
                continue;
            }
            let facet = self.stream.around(self.normal, libm::cos(alpha));
            if self.direction.dot(facet) < 0.0 {
                return facet;
            }
        }
        self.normal
    }

    /// The normal moved by a point of the ball of radius 1 - polish.
    fn facet_in_ball(&mut self) -> Vec3 {
        // Geant4 sets the polish of a dichroic surface to 0
        let polish = if self.values.model == SurfaceModel::Dichroic { 0.0 } else { self.values.value };
        if polish >= 1.0 {
            return self.normal;
        }
        for _ in 0..MAX_ROUNDS {
            let smear = Vec3::from_array([(); 3].map(|()| 2.0 * self.stream.uniform() - 1.0));
            let facet = self.normal + (1.0 - polish) * smear;
            if smear.length_squared() <= 1.0 && self.direction.dot(facet) < 0.0 {
                return facet.normalize();
            }
        }
        self.normal
    }
}

/// A vector mirrored at the plane with a unit normal.
pub(super) fn mirrored(vector: Vec3, normal: Vec3) -> Vec3 {
    vector - 2.0 * vector.dot(normal) * normal
}
