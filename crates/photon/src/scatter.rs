//! Scattering in a material: Rayleigh and Mie.

mod lanes;

pub(crate) use lanes::LaneScattering;

use crate::material::Mie;
use crate::philox::Stream;
use rayweave_math::Vec3;

/// Rayleigh scattering of a polarised photon: the new direction and polarisation. The direction is distributed as
/// 1 + cos^2, and the polarisation as the square of its cosine to the old one (`G4OpRayleigh`).
pub(crate) fn rayleigh(direction: Vec3, polarisation: Vec3, stream: &mut Stream) -> (Vec3, Vec3) {
    loop {
        let cosine = 2.0 * stream.uniform() - 1.0;
        let scattered = stream.around(direction, cosine);
        let turned = turned(polarisation, scattered, stream);
        let overlap = turned.dot(polarisation);
        if overlap * overlap >= stream.uniform() {
            return (scattered, turned);
        }
    }
}

/// Mie scattering by the phase function of Henyey and Greenstein: the new direction and polarisation (`G4OpMieHG`).
pub(crate) fn mie(mie: &Mie, direction: Vec3, polarisation: Vec3, stream: &mut Stream) -> (Vec3, Vec3) {
    let is_forward = stream.uniform() <= mie.forward_ratio;
    let g = if is_forward { mie.forward } else { mie.backward };
    let cosine = henyey_greenstein(g, stream.uniform());
    let scattered = stream.around(direction, if is_forward { cosine } else { -cosine });
    (scattered, turned(polarisation, scattered, stream))
}

/// The cosine of the scattering angle below which a fraction `u` of the phase function with mean cosine `g` lies.
fn henyey_greenstein(g: f64, u: f64) -> f64 {
    if g == 0.0 {
        return 2.0 * u - 1.0;
    }
    let ratio = 1.0 - g + 2.0 * g * u;
    (2.0 * u * (1.0 + g) * (1.0 + g) * (1.0 - g + g * u) / (ratio * ratio) - 1.0).clamp(-1.0, 1.0)
}

/// The part of a polarisation perpendicular to a new direction, of unit length and random sign.
fn turned(polarisation: Vec3, direction: Vec3, stream: &mut Stream) -> Vec3 {
    match (polarisation - polarisation.dot(direction) * direction).try_normalize() {
        Some(turned) if stream.chance(0.5) => -turned,
        Some(turned) => turned,
        // scattered along the old polarisation: any direction is as good
        None => stream.polarisation(direction),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::philox::Purpose;
    use crate::property::PropertyTable;

    fn streams(count: u64) -> impl Iterator<Item = Stream> {
        (0..count).map(|photon| Stream::new(1, photon, 0, Purpose::Scattering))
    }

    /// The mean of the squared cosine is 2/5 for the density 3/8 (1 + c^2), and the intensity along the old
    /// polarisation is that of a dipole: the mean squared cosine to it is 1/5.
    #[test]
    fn rayleigh_scattering_is_that_of_a_dipole() {
        const COUNT: u64 = 60_000;
        let (mut cosines, mut dipole) = (0.0, 0.0);
        for mut stream in streams(COUNT) {
            let (direction, polarisation) = rayleigh(Vec3::Z, Vec3::X, &mut stream);
            assert!(direction.dot(polarisation).abs() < 1e-12 && (polarisation.length() - 1.0).abs() < 1e-12);
            cosines += direction.z * direction.z;
            dipole += direction.x * direction.x;
        }
        // standard deviations of c^2: sqrt(9/35 - 4/25) and sqrt(3/35 - 1/25), see the moments of the two densities
        let error = |variance: f64| 5.0 * (variance / COUNT as f64).sqrt();
        assert!(
            (cosines / COUNT as f64 - 0.4).abs() < error(9.0 / 35.0 - 0.16),
            "{}",
            cosines / COUNT as f64
        );
        assert!((dipole / COUNT as f64 - 0.2).abs() < error(3.0 / 35.0 - 0.04), "{}", dipole / COUNT as f64);
    }

    /// The mean cosine of the phase function is g; of two lobes the weighted difference.
    #[test]
    fn mie_scattering_has_its_mean_cosine() {
        const COUNT: u64 = 60_000;
        for (forward, backward, ratio) in [(0.9, 0.0, 1.0), (0.0, 0.0, 1.0), (0.8, 0.3, 0.75)] {
            let lobes = Mie { length: PropertyTable::constant(1.0), forward, backward, forward_ratio: ratio };
            let sum: f64 =
                streams(COUNT).map(|mut stream| mie(&lobes, Vec3::Y, Vec3::X, &mut stream).0.y).sum();
            let expected = ratio * forward - (1.0 - ratio) * backward;
            assert!((sum / COUNT as f64 - expected).abs() < 5.0 / (COUNT as f64).sqrt(), "{sum} {expected}");
        }
    }
}
