//! Volume confidence intervals: estimates of volumes, areas and moments, and the results of measurements.

use super::chord::MeasuredChord;
use super::moments::{centre_weights, inertia, inertia_weights};
use super::tally::Tally;
use rayweave_math::{Mat3, Vec3};

/// A value with its confidence interval: `value - half_width` to `value + half_width`.
///
/// The half width is the standard error times the quantile of the normal distribution for the confidence of the settings: 2.5758
/// at 99 %, the default, and 1.9600 at 95 %.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Half the width of the interval.
    pub half_width: f64,
}

impl Estimate {
    /// True if the interval contains a number.
    pub fn contains(&self, value: f64) -> bool {
        (value - self.value).abs() <= self.half_width
    }
}

/// The measurements of one region.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The name of the region.
    pub name: String,
    /// The volume, in cubed lengths of the model.
    pub volume: Estimate,
    /// The area of the boundary, in squared lengths; a boundary shared with a neighbour counts for both.
    pub area: Estimate,
    /// The centroid of the volume; `None` if no ray crossed the region.
    pub centre: Option<[Estimate; 3]>,
    /// The inertia tensor about the centre for density 1, `integral of |r|^2 1 - r r^T`, row by row, in
    /// lengths to the fifth power. Multiply by the density to obtain that of the body.
    pub inertia: [[Estimate; 3]; 3],
    /// The longest chord, a lower bound of the extent; `None` if no ray crossed the region. Volume and area
    /// are then between 0 and the half width: see [`measure`](super::measure).
    pub longest: Option<MeasuredChord>,
    /// The number of rays for the region.
    pub rays: u64,
    /// True if the volume reaches the requested precision.
    pub is_reached: bool,
}

/// The results of a measurement, in the order of the regions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurement {
    /// The regions.
    pub regions: Vec<Measured>,
    /// The number of all rays.
    pub rays: u64,
    /// The maximum number of rays, without the first round: that of the settings, or fewer where many shapes overlap.
    pub most_rays: u64,
}

impl Measurement {
    /// The total volume of all regions. The half widths are added, which is conservative for any correlation.
    pub fn volume(&self) -> Estimate {
        let sum = |of: fn(&Measured) -> f64| self.regions.iter().map(of).sum();
        Estimate { value: sum(|r| r.volume.value), half_width: sum(|r| r.volume.half_width) }
    }
}

/// The weights of the moments that give the volume.
pub(super) fn volume_weights() -> [f64; super::moments::MOMENTS] {
    let mut weights = [0.0; super::moments::MOMENTS];
    weights[0] = 1.0;
    weights
}

/// The results for a region from its integrals about `origin`; `quantile` is the ratio of half width to
/// standard deviation.
pub(super) fn report(tally: &Tally, origin: Vec3, quantile: f64) -> Measured {
    let estimate = |weights: &_| Estimate {
        value: tally.value(weights),
        half_width: quantile * tally.deviation(weights),
    };
    let volume = estimate(&volume_weights());
    let area = Estimate { value: tally.area, half_width: quantile * tally.area_deviation() };
    let is_there = volume.value > 0.0;
    let first = Vec3::new(tally.moments[1], tally.moments[2], tally.moments[3]);
    let about = if is_there { first / volume.value } else { Vec3::ZERO };
    let coordinate = |k: usize| Estimate {
        value: origin[k] + about[k],
        half_width: quantile * tally.deviation(&centre_weights(k, about)) / volume.value,
    };
    let tensor: Mat3 = inertia(&tally.moments, about);
    // a shift of the centre has no first-order effect: the first moments about it are zero
    let entry = |i: usize, j: usize| Estimate {
        value: tensor.col(j)[i],
        half_width: quantile * tally.deviation(&inertia_weights(i, j, about)),
    };
    let row = |i: usize| [0, 1, 2].map(|j| entry(i, j));
    Measured {
        name: String::new(),
        volume,
        area,
        centre: is_there.then(|| [0, 1, 2].map(coordinate)),
        inertia: [0, 1, 2].map(row),
        longest: Some(tally.longest).filter(|chord| chord.length() > 0.0),
        rays: 0,
        is_reached: false,
    }
}

/// The ratio of half width to standard deviation for a level of confidence below 1: by bisection, the root of
/// erf(q / sqrt 2) = confidence.
pub(super) fn quantile(confidence: f64) -> f64 {
    // erf(40 / sqrt 2) rounds to 1 in double precision
    let (mut lo, mut hi) = (0.0, 40.0);
    for _ in 0..64 {
        let middle = 0.5 * (lo + hi);
        let is_below = libm::erf(middle * std::f64::consts::FRAC_1_SQRT_2) < confidence;
        (lo, hi) = if is_below { (middle, hi) } else { (lo, middle) };
    }
    0.5 * (lo + hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz and Stegun, *Handbook of Mathematical Functions*, table 26.5.
    #[test]
    fn quantiles() {
        for (confidence, expected) in [(0.95, 1.959_963_985), (0.99, 2.575_829_304), (0.999, 3.290_526_731)] {
            assert!((quantile(confidence) - expected).abs() < 1e-8, "{confidence}");
        }
    }
}
