//! The optical boundary process: what happens to a photon where it reaches another volume.
//!
//! *Source*: Geant4 Physics Reference Manual 11.4, "Boundary process", and the decisions of `G4OpBoundaryProcess`:
//! loss at the surface first, then the Fresnel equations for the polarised photon at a microfacet, then the lobes of
//! the reflection. The fields of [`Boundary`] are the state between these decisions.

mod bare;
mod coating;
mod collected;
mod event;
mod interface;
mod lanes;
mod measured;
mod metal;
mod painted;
mod process;
#[cfg(test)]
mod tests;

pub(crate) use bare::EVENTS as BARE_EVENTS;
pub(crate) use collected::{AtBoundary, Departed, LaneBoundaries, LaneSurface, SurfacePoint};
pub use event::BoundaryEvent;
pub(crate) use lanes::Group;
pub(crate) use painted::{EVENTS as PAINTED_EVENTS, Reflection};
#[cfg(feature = "gpu")]
pub(crate) use process::GRAZING;

use crate::philox::Stream;
use crate::surface::{MeasuredTable, OpticalSurface, SurfaceFinish, SurfaceType};
use process::{Process, SurfaceValues};
use rayweave_math::Vec3;

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

impl Boundary<'_> {
    /// Applies the process: the photon gets its new direction and polarisation. The returned flag is true if it
    /// continues behind the boundary.
    pub fn apply(&mut self, stream: &mut Stream) -> (BoundaryEvent, bool) {
        let mut process = Process {
            values: SurfaceValues::new(self.surface, self.energy),
            stream,
            direction: self.direction,
            polarisation: self.polarisation,
            normal: self.normal,
            facet: self.normal,
            energy: self.energy,
            event: BoundaryEvent::Absorption,
            reflected: [true; 2],
        };
        self.run(&mut process);
        (self.direction, self.polarisation) =
            (renormalised(process.direction), renormalised(process.polarisation));
        (process.event, self.direction.dot(self.normal) < 0.0)
    }

    fn run(&self, process: &mut Process<'_>) {
        let (finish, kind) = (process.values.finish, process.values.kind);
        let layer = || self.surface.and_then(|surface| Some(surface.index.as_ref()?.at(self.energy)));
        let behind = if finish.is_back_painted() { layer() } else { self.index_behind };
        let is_bare = matches!(finish, SurfaceFinish::Polished | SurfaceFinish::Ground);
        let is_interface = kind == SurfaceType::DielectricDielectric && is_bare;
        if is_interface && self.is_same_material {
            process.event = BoundaryEvent::SameMaterial;
            return;
        }
        if behind.is_none() && (finish.is_back_painted() || is_interface || kind == SurfaceType::Coated) {
            process.event = BoundaryEvent::NoIndex;
            return;
        }
        process.use_complex_index(self.index);
        let table = self.surface.and_then(|surface| surface.table.as_ref());
        let coating = self.surface.and_then(|surface| surface.coating.as_ref());
        match (kind, behind) {
            (SurfaceType::DielectricMetal, _) => process.metal(self.index),
            (SurfaceType::Coated, Some(behind)) => match coating {
                Some(coating) => process.coated(coating, self.index, behind),
                None => process.absorb(),
            },
            (
                SurfaceType::DielectricLut
                | SurfaceType::DielectricLutDavis
                | SurfaceType::DielectricDichroic,
                _,
            ) => match table {
                Some(MeasuredTable::Lut(table)) => process.lut(table),
                Some(MeasuredTable::Davis(table)) => process.davis(table),
                Some(MeasuredTable::Dichroic(table)) => process.dichroic(table),
                None => process.absorb(),
            },
            (_, Some(behind)) if finish.is_back_painted() => process.interface(self.index, behind),
            (_, behind) => process.dielectric(self.index, behind.unwrap_or(self.index)),
        }
    }
}

/// The unit vector along a vector that is one up to rounding: a Newton step for the inverse of its length, whose error is
/// 3/8 of the square of the deviation of the squared length from 1.
fn renormalised(vector: Vec3) -> Vec3 {
    let square = vector.length_squared();
    if (square - 1.0).abs() < 1e-8 { vector * (1.5 - 0.5 * square) } else { vector.normalize() }
}
