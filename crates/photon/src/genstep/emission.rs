//! Generation of the photons of a genstep.

use super::cerenkov;
use crate::philox::{Stream, perpendicular};
use crate::photon::Photon;
use crate::property::{PropertyTable, Spectrum};
use crate::sample::linear_quantile;
use crate::scintillation;
use rayweave_math::Vec3;

/// The path of a particle along which photons start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    pub position: Vec3,
    pub time: f64,
    pub displacement: Vec3,
    pub step_length: f64,
    pub velocity: [f64; 2],
}

impl Path {
    /// The position and time after a fraction of the step (`G4Cerenkov`, `G4Scintillation`).
    fn at(&self, fraction: f64) -> (Vec3, f64) {
        let [before, after] = self.velocity;
        let length = fraction * self.step_length;
        let delay = if length > 0.0 { length / (before + 0.5 * fraction * (after - before)) } else { 0.0 };
        (self.position + fraction * self.displacement, self.time + delay)
    }
}

/// A Cerenkov photon: on the cone around the path, polarised in the plane of the path and its direction. It starts with a
/// density that is linear along the step.
pub(super) fn cerenkov_photon(
    path: &Path,
    (index, inverse_beta, energies): (Option<&PropertyTable>, f64, [f64; 2]),
    density: [f64; 2],
    stream: &mut Stream,
) -> Photon {
    let fraction = stream.uniform();
    let sample = index.and_then(|index| cerenkov::sample(index, inverse_beta, energies, fraction));
    // a genstep with photons has an index above the threshold
    let (energy, cosine) = sample.unwrap_or((energies[0], 1.0));
    let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
    let azimuth = std::f64::consts::TAU * stream.uniform();
    let axis = path.displacement.normalize();
    let (x, y) = perpendicular(axis);
    let outwards = libm::cos(azimuth) * x + libm::sin(azimuth) * y;
    let (position, time) = path.at(linear_quantile(density[0], density[1], stream.uniform()));
    let direction = (sine * outwards + cosine * axis).normalize();
    let polarisation = (cosine * outwards - sine * axis).normalize();
    Photon { position, direction, polarisation, energy, time }
}

/// A scintillation photon: in a random direction, unpolarised. That of a neutral particle starts at the end of the step.
pub(super) fn scintillation_photon(
    path: &Path,
    is_charged: bool,
    (spectrum, decay, rise): (&Spectrum, f64, f64),
    stream: &mut Stream,
) -> Photon {
    let energy = scintillation::energy(spectrum, stream);
    let direction = stream.direction();
    let polarisation = stream.polarisation(direction);
    let fraction = stream.uniform();
    let (position, start) = path.at(if is_charged { fraction } else { 1.0 });
    let time = start + scintillation::delay(decay, rise, stream);
    Photon { position, direction, polarisation, energy, time }
}
