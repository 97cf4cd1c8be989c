//! Wavefronts: optical path differences relative to a reference sphere.

use super::Arrival;
use rayweave_math::Vec3;

/// Optical path differences of a set of rays.
///
/// The reference sphere is centred at the point of the chief ray on the image; its radius is the distance
/// of the exit pupil. The difference is the path of the chief ray to the sphere minus that of the ray, in
/// waves: positive where the wavefront is ahead (W. T. Welford, *Aberrations of Optical Systems*, 1986,
/// section 7.2).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wavefront {
    /// The points of the pupil, in units of its semi-diameter.
    pub pupil: Vec<[f64; 2]>,
    /// The differences there, in waves.
    pub waves: Vec<f64>,
}

impl Wavefront {
    /// Computes the path differences relative to a chief ray. The id of a ray is the index of its
    /// point in `pupil`. `radius` is the distance from the exit pupil to the image, negative for a pupil
    /// behind it, infinite for a telecentric system; `unit_nm` is the unit of lengths.
    pub fn new(
        principal: &Arrival,
        arrivals: &[Arrival],
        pupil: &[[f64; 2]],
        radius: f64,
        unit_nm: f64,
    ) -> Wavefront {
        let reference = to_sphere(principal, principal.position, radius);
        let known = arrivals.iter().filter_map(|arrival| Some((arrival, *pupil.get(arrival.id)?)));
        let difference = |arrival: &Arrival| {
            let own = to_sphere(arrival, principal.position, radius);
            (reference - own) * unit_nm / principal.wavelength_nm
        };
        let (pupil, waves) = known.map(|(arrival, point)| (point, difference(arrival))).unzip();
        Wavefront { pupil, waves }
    }

    /// The mean difference.
    pub fn mean(&self) -> f64 {
        self.waves.iter().sum::<f64>() / self.waves.len() as f64
    }

    /// The RMS of the differences about the centroid of the image: the standard deviation of what remains without the
    /// tilt, the linear function of the coordinates of the pupil that fits best, over points that count equally. A tilt
    /// moves the image and leaves its sharpness (V. N. Mahajan, J. Opt. Soc. Am. 72, 1258, 1982). NaN if there are no points.
    pub fn rms(&self) -> f64 {
        let weights = vec![1.0; self.waves.len()];
        weighted_rms(&without_tilt(&self.pupil, &self.waves, &weights), &weights)
    }

    /// The RMS of the differences from the reference sphere about the chief ray: their standard deviation over the
    /// points, which includes tilt; NaN if there are none.
    pub fn rms_about_chief_ray(&self) -> f64 {
        let weights = vec![1.0; self.waves.len()];
        weighted_rms(&without_piston(&self.waves, &weights), &weights)
    }

    /// The greatest difference minus the least.
    pub fn peak_to_valley(&self) -> f64 {
        let fold = |start: f64, f: fn(f64, f64) -> f64| self.waves.iter().fold(start, |a, &b| f(a, b));
        fold(f64::NEG_INFINITY, f64::max) - fold(f64::INFINITY, f64::min)
    }

    /// The Strehl ratio in Mahajan's approximation exp(-(2 pi rms)^2) with the RMS about the centroid, accurate for
    /// ratios above 0.1 (V. N. Mahajan, J. Opt. Soc. Am. 73, 860, 1983): an estimate of the peak of the point spread
    /// function, wherever on the image it lies, over that of a lens without aberrations.
    pub fn strehl(&self) -> f64 {
        let phase = std::f64::consts::TAU * self.rms();
        libm::exp(-phase * phase)
    }
}

/// The differences from their weighted mean.
pub(crate) fn without_piston(waves: &[f64], weights: &[f64]) -> Vec<f64> {
    let mean = weighted_mean(waves.iter().copied(), weights);
    waves.iter().map(|wave| wave - mean).collect()
}

/// The differences without piston and tilt: the residuals of the weighted least-squares fit by a linear function of the
/// coordinates of the pupil. Points on a line determine the tilt along that line only.
pub(crate) fn without_tilt(pupil: &[[f64; 2]], waves: &[f64], weights: &[f64]) -> Vec<f64> {
    let along = |axis: usize| pupil.iter().map(|point| point[axis]).collect::<Vec<f64>>();
    let x = without_piston(&along(0), weights);
    let y = without_multiple(&without_piston(&along(1), weights), &x, weights);
    // orthogonal functions: their coefficients are independent
    let flat = without_multiple(&without_piston(waves, weights), &x, weights);
    without_multiple(&flat, &y, weights)
}

/// The values without the multiple of a function that fits them best; coordinates of a pupil, whose semi-diameter is 1,
/// that differ by rounding alone are no function to fit.
fn without_multiple(values: &[f64], function: &[f64], weights: &[f64]) -> Vec<f64> {
    let mean = |other: &[f64]| weighted_mean(other.iter().zip(function).map(|(a, b)| a * b), weights);
    let square = mean(function);
    let factor = if square > 1e-24 { mean(values) / square } else { 0.0 };
    values.iter().zip(function).map(|(value, at)| value - factor * at).collect()
}

/// The root of the weighted mean square; NaN if there are no values.
pub(crate) fn weighted_rms(values: &[f64], weights: &[f64]) -> f64 {
    weighted_mean(values.iter().map(|value| value * value), weights).sqrt()
}

fn weighted_mean(values: impl Iterator<Item = f64>, weights: &[f64]) -> f64 {
    values.zip(weights).map(|(value, weight)| weight * value).sum::<f64>() / weights.iter().sum::<f64>()
}

/// The radius of the reference sphere: the distance from the exit pupil, at `exit` on the axis, to the point
/// of the chief ray on the image; negative for a pupil behind the image along the light.
pub(crate) fn reference_radius(principal: &Arrival, exit: f64) -> f64 {
    let [x, y, z] = principal.position.to_array();
    let radius = libm::hypot(libm::hypot(x, y), z - exit);
    let is_behind = exit * principal.direction.z > 0.0;
    if is_behind { -radius } else { radius }
}

/// The optical path of a ray up to the reference sphere, without the sphere's radius, which is the same for
/// all rays: this avoids cancellation for distant pupils.
fn to_sphere(ray: &Arrival, centre: Vec3, radius: f64) -> f64 {
    let from_centre = ray.position - centre;
    let along = from_centre.dot(ray.direction);
    // |from_centre - back * direction| = |radius|: back = along +- root, and root - |radius| = square / (root + |radius|)
    let square = along * along - from_centre.length_squared();
    let root = (square + radius * radius).sqrt();
    let bend = square / (root + radius.abs());
    ray.path - ray.index * (along + bend * radius.signum())
}
