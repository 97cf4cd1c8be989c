//! The optical boundary process: what happens to a photon where it reaches another volume.
//!
//! *Source*: Geant4 Physics Reference Manual 11.4, "Boundary process", and the decisions of `G4OpBoundaryProcess`:
//! loss at the surface first, then the Fresnel equations for the polarised photon at a microfacet, then the lobes of
//! the reflection. The fields of [`Boundary`] are the state between these decisions.

use crate::philox::Stream;
use crate::property::{PropertyTable, wavelength_nm};
use crate::surface::{OpticalSurface, SurfaceFinish, SurfaceModel, SurfaceType};
use num_complex::Complex64;
use rayweave_math::Vec3;
use rayweave_optics::interface::fresnel;

/// Cosines within this distance of 1 are treated as normal incidence, and directions as far behind a surface as on it
/// (Geant4's surface tolerance).
const GRAZING: f64 = 1e-9;

/// The number of facets and layers at which one photon may scatter in one event before it counts as absorbed. Geant4
/// has no limit for facets; each round ends with a probability of the order of 1.
const MAX_ROUNDS: u32 = 1000;

/// The result of the boundary process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BoundaryEvent {
    /// Refraction at an interface.
    FresnelRefraction,
    /// Reflection at an interface or a metal.
    FresnelReflection,
    /// Reflection beyond the critical angle.
    TotalInternalReflection,
    /// Diffuse reflection.
    LambertianReflection,
    /// Reflection about the normal of a facet.
    LobeReflection,
    /// Mirror reflection about the mean normal.
    SpikeReflection,
    /// Reflection into the direction of incidence.
    BackScattering,
    /// Absorption at the surface.
    Absorption,
    /// Absorption at the surface, with detection.
    Detection,
    /// Undeviated transmission.
    Transmission,
    /// The same material on both sides.
    SameMaterial,
    /// Absorption, since the material behind has no refractive index.
    NoIndex,
}

/// A photon at a boundary between two media.
#[derive(Clone, Copy, Debug)]
pub struct Boundary<'a> {
    /// The direction of the photon: a unit vector.
    pub direction: Vec3,
    /// The polarisation: a unit vector perpendicular to the direction.
    pub polarisation: Vec3,
    /// The unit normal, against the direction of the incident photon.
    pub normal: Vec3,
    /// The energy in MeV.
    pub energy: f64,
    /// The index in front of the boundary.
    pub index: f64,
    /// The index behind it, if there is one.
    pub index_behind: Option<f64>,
    /// True for the same material on both sides.
    pub is_same_material: bool,
    /// The surface; `None` for a bare interface.
    pub surface: Option<&'a OpticalSurface>,
}

/// The quantities of a surface at the energy of the photon.
#[derive(Clone, Copy, Debug)]
struct SurfaceValues {
    finish: SurfaceFinish,
    model: SurfaceModel,
    kind: SurfaceType,
    value: f64,
    reflectivity: f64,
    transmittance: f64,
    efficiency: f64,
    metal: Option<Complex64>,
    lobe: f64,
    spike: f64,
    backscatter: f64,
    roughness: f64,
}

impl SurfaceValues {
    fn new(surface: Option<&OpticalSurface>, energy: f64) -> SurfaceValues {
        let default = OpticalSurface { value: 1.0, ..OpticalSurface::default() };
        let surface = surface.unwrap_or(&default);
        let at = |table: &Option<PropertyTable>, absent: f64| {
            table.as_ref().map_or(absent, |table| table.at(energy))
        };
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
            lobe: at(&surface.lobe, 0.0),
            spike: at(&surface.spike, 0.0),
            backscatter: at(&surface.backscatter, 0.0),
            roughness: surface.roughness,
        }
    }
}

/// The process in progress.
struct Process<'s> {
    values: SurfaceValues,
    stream: &'s mut Stream,
    direction: Vec3,
    polarisation: Vec3,
    normal: Vec3,
    facet: Vec3,
    energy: f64,
    event: BoundaryEvent,
    /// For a metal: which of the components s and p is reflected.
    reflected: [bool; 2],
}

impl Boundary<'_> {
    /// Applies the process: the photon gets its new direction and polarisation. The returned flag is true if it
    /// continues behind the boundary.
    pub fn apply(&mut self, stream: &mut Stream) -> (BoundaryEvent, bool) {
        let values = SurfaceValues::new(self.surface, self.energy);
        let mut process = Process {
            values,
            stream,
            direction: self.direction,
            polarisation: self.polarisation,
            normal: self.normal,
            facet: self.normal,
            energy: self.energy,
            event: BoundaryEvent::Absorption,
            reflected: [true; 2],
        };
        let event = process.run(self);
        (self.direction, self.polarisation) =
            (process.direction.normalize(), process.polarisation.normalize());
        (event, self.direction.dot(self.normal) < 0.0)
    }
}

impl Process<'_> {
    fn run(&mut self, boundary: &Boundary<'_>) -> BoundaryEvent {
        let finish = self.values.finish;
        let is_bare = matches!(finish, SurfaceFinish::Polished | SurfaceFinish::Ground);
        let is_dielectric = self.values.kind == SurfaceType::DielectricDielectric;
        let layer = || boundary.surface.and_then(|surface| Some(surface.index.as_ref()?.at(boundary.energy)));
        let behind = if finish.is_back_painted() { layer() } else { boundary.index_behind };
        if finish.is_back_painted() && behind.is_none() {
            return BoundaryEvent::NoIndex;
        }
        if is_dielectric && is_bare {
            if boundary.is_same_material {
                return BoundaryEvent::SameMaterial;
            }
            if behind.is_none() {
                return BoundaryEvent::NoIndex;
            }
        }
        match (self.values.kind, behind) {
            (SurfaceType::DielectricMetal, _) => self.metal(boundary.index),
            (_, Some(behind)) if finish.is_back_painted() => self.interface(boundary.index, behind),
            (_, behind) => self.dielectric(boundary.index, behind.unwrap_or(boundary.index)),
        }
        self.event
    }

    fn absorb(&mut self) {
        let is_detected = self.stream.chance(self.values.efficiency);
        self.event = if is_detected { BoundaryEvent::Detection } else { BoundaryEvent::Absorption };
    }

    /// True if the photon is lost or transmitted at the surface before it is reflected or refracted.
    fn is_lost(&mut self) -> bool {
        let u = self.stream.uniform();
        match () {
            () if u > self.values.reflectivity + self.values.transmittance => self.absorb(),
            () if u > self.values.reflectivity => self.event = BoundaryEvent::Transmission,
            () => return false,
        }
        true
    }

    fn dielectric(&mut self, index: f64, behind: f64) {
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

    /// Reflection by paint: diffuse, or about a facet, or about the normal.
    fn reflect(&mut self) {
        if self.event == BoundaryEvent::LambertianReflection {
            let incident = self.direction;
            self.direction = self.stream.lambertian(self.normal);
            self.facet = (self.direction - incident).normalize();
        } else {
            self.event = BoundaryEvent::SpikeReflection;
            self.facet = self.normal;
            if self.values.finish == SurfaceFinish::Ground {
                self.event = BoundaryEvent::LobeReflection;
                self.facet = self.facet_normal();
            }
            self.direction = mirrored(self.direction, self.facet);
        }
        self.polarisation = -mirrored(self.polarisation, self.facet);
    }

    /// The mirror reflection about the facet, without a phase between s and p.
    fn mirror(&mut self) {
        self.direction = mirrored(self.direction, self.facet);
        self.polarisation = -mirrored(self.polarisation, self.facet);
    }

    /// Selects the kind of reflection of a rough surface of the unified model.
    fn choose_reflection(&mut self) {
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

    fn turn_back(&mut self) {
        (self.direction, self.polarisation) = (-self.direction, -self.polarisation);
    }

    /// The normal of a microfacet that the photon can reach.
    fn facet_normal(&mut self) -> Vec3 {
        match self.values.model {
            SurfaceModel::Unified => {
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
            SurfaceModel::Glisur => {
                let polish = self.values.value;
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
    }

    /// A dielectric in front of a metal.
    fn metal(&mut self, index: f64) {
        if let Some(metal) = self.values.metal {
            self.values.reflectivity = self.metal_reflectivity(index, metal);
        }
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

    /// The reflectance of a metal for the polarised photon at a facet, by Fresnel's equations with a complex index;
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

    /// The interface between two dielectrics, with paint behind it for the back-painted finishes.
    fn interface(&mut self, mut index: f64, mut behind: f64) {
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
            let rise = self.direction.dot(self.normal);
            let is_done = if is_through { rise <= 0.0 } else { rise >= -GRAZING };
            if !is_done {
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

    /// False if the roughness of the surface makes a reflection diffuse.
    fn passes_roughness(&mut self, index: f64, behind: f64) -> bool {
        let roughness = self.values.roughness;
        if roughness == 0.0 || index <= behind {
            return true;
        }
        let facet =
            if self.values.finish == SurfaceFinish::Polished { self.normal } else { self.facet_normal() };
        let cosine = -self.direction.dot(facet);
        let wavelength = wavelength_nm(self.energy) * 1e-6;
        let phase = 4.0 * std::f64::consts::PI * roughness * index * cosine / wavelength;
        self.stream.chance(libm::exp(-phase * phase))
    }

    /// One event at one facet; true for refraction.
    fn refract_or_reflect(&mut self, index: f64, behind: f64, passes_roughness: bool) -> bool {
        self.facet =
            if self.values.finish == SurfaceFinish::Polished { self.normal } else { self.facet_normal() };
        let (direction, polarisation, facet) = (self.direction, self.polarisation, self.facet);
        let cos1 = -direction.dot(facet);
        let is_oblique = cos1.abs() < 1.0 - GRAZING;
        let sin1 = if is_oblique { (1.0 - cos1 * cos1).sqrt() } else { 0.0 };
        let sin2 = sin1 * index / behind;
        if sin2 >= 1.0 {
            self.event = BoundaryEvent::TotalInternalReflection;
            if self.is_reflected_like_a_facet(passes_roughness) {
                self.mirror();
            }
            return false;
        }
        let cos2 = (1.0 - sin2 * sin2).sqrt().copysign(cos1);
        // amplitudes of the incident wave: across the plane of incidence and in it
        let across = if is_oblique { direction.cross(facet).normalize() } else { polarisation };
        let (s1, p1) = if is_oblique {
            let s = polarisation.dot(across);
            (s, (polarisation - s * across).length())
        } else {
            (0.0, 1.0)
        };
        let flux1 = index * cos1;
        let s2 = 2.0 * flux1 * s1 / (index * cos1 + behind * cos2);
        let p2 = 2.0 * flux1 * p1 / (behind * cos1 + index * cos2);
        let transmitted = behind * cos2 * (s2 * s2 + p2 * p2);
        let transmittance = if cos1 == 0.0 { 0.0 } else { transmitted / flux1 };
        // directions of oscillation: `along` lies in the plane of incidence
        let combine = |direction: Vec3, s: f64, p: f64| {
            let along = direction.cross(across).normalize();
            (p * along + s * across) / (s * s + p * p).sqrt()
        };
        if self.stream.chance(transmittance) {
            self.event = BoundaryEvent::FresnelRefraction;
            if is_oblique {
                let bend = cos1 - cos2 * (behind / index);
                self.direction = (direction + bend * facet).normalize();
                self.polarisation = combine(self.direction, s2, p2);
            }
            return true;
        }
        self.event = BoundaryEvent::FresnelReflection;
        if self.is_reflected_like_a_facet(passes_roughness) {
            self.direction = mirrored(direction, self.facet);
            self.polarisation = match () {
                () if is_oblique => combine(self.direction, s2 - s1, behind * p2 / index - p1),
                () if behind > index => -polarisation,
                () => polarisation,
            };
        }
        false
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

/// A vector mirrored at the plane with a unit normal.
fn mirrored(vector: Vec3, normal: Vec3) -> Vec3 {
    vector - 2.0 * vector.dot(normal) * normal
}
