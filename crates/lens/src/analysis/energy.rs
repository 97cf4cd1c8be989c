//! Encircled energy and geometric modulation transfer function (MTF).

use super::{Arrival, Spot};

/// The distances from the centroid with the powers, sorted by distance.
fn distances(arrivals: &[Arrival]) -> Vec<(f64, f64)> {
    let [x, y] = Spot::of(arrivals).map_or([0.0; 2], |spot| spot.centroid);
    let off = |arrival: &Arrival| libm::hypot(arrival.position.x - x, arrival.position.y - y);
    let mut found: Vec<(f64, f64)> = arrivals.iter().map(|arrival| (off(arrival), arrival.power)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

/// The fraction of the power within each radius about the centroid; NaN if there is no light.
pub fn encircled_energy(arrivals: &[Arrival], radii: &[f64]) -> Vec<f64> {
    let distances = distances(arrivals);
    let total: f64 = distances.iter().map(|(_, power)| power).sum();
    let within = |radius: f64| -> f64 {
        distances.iter().take_while(|(distance, _)| *distance <= radius).map(|(_, power)| power).sum()
    };
    radii.iter().map(|&radius| within(radius) / total).collect()
}

/// The radius of the smallest circle about the centroid that contains a fraction of the power; `None` if
/// there is no light.
pub fn encircled_energy_radius(arrivals: &[Arrival], fraction: f64) -> Option<f64> {
    let distances = distances(arrivals);
    let wanted = fraction * distances.iter().map(|(_, power)| power).sum::<f64>();
    let mut sum = 0.0;
    let reached = distances.iter().find(|(_, power)| {
        sum += power;
        sum >= wanted * (1.0 - 1e-12)
    });
    reached.map(|(distance, _)| *distance)
}

/// The geometric MTF along a direction (x, y of the sheet) at frequencies in cycles per unit of length: the
/// modulus of the Fourier transform of the spot, `|sum p exp(2 pi i v s)| / sum p`, with the coordinate s
/// along the direction (W. J. Smith, *Modern Optical Engineering*, section on the modulation transfer
/// function). Diffraction is not included: close to the diffraction limit the result is too high, and it can
/// exceed that limit. NaN if there is no light.
pub fn geometric_mtf(arrivals: &[Arrival], direction: [f64; 2], frequencies: &[f64]) -> Vec<f64> {
    let length = libm::hypot(direction[0], direction[1]);
    let [a, b] = direction.map(|component| component / length);
    let modulation = |frequency: f64| {
        let (mut real, mut imaginary, mut power) = (0.0, 0.0, 0.0);
        for arrival in arrivals {
            let place = a * arrival.position.x + b * arrival.position.y;
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * frequency * place);
            real += arrival.power * cos;
            imaginary += arrival.power * sin;
            power += arrival.power;
        }
        libm::hypot(real, imaginary) / power
    };
    frequencies.iter().map(|&frequency| modulation(frequency)).collect()
}
