//! Estimates and their reports.

use super::chord::Chord;
use super::moments::{centre_weights, inertia, inertia_weights};
use super::tally::Tally;
use rayweave_math::{Mat3, Vec3};

/// A number with its confidence interval: `value - half_width` to `value + half_width`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Half the width of the interval.
    pub half_width: f64,
}

impl Estimate {
    /// True if a number lies in the interval.
    pub fn holds(&self, value: f64) -> bool {
        (value - self.value).abs() <= self.half_width
    }
}

/// The measurements of one region.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The name of the region.
    pub name: String,
    /// Its volume, in cubed lengths of the model.
    pub volume: Estimate,
    /// The area of its boundary, in squared lengths; a boundary shared with a neighbour counts for both.
    pub area: Estimate,
    /// The centre of its volume; `None` if no ray crossed the region.
    pub centre: Option<[Estimate; 3]>,
    /// The inertia tensor about the centre for density 1, `integral of |r|^2 1 - r r^T`, row by row, in lengths to the fifth
    /// power. Times the density it is the tensor of the body.
    pub inertia: [[Estimate; 3]; 3],
    /// The longest piece of a ray in it, a lower bound of its extent; `None` if no ray crossed the region. Its volume and area are
    /// then between 0 and the half width: see [`measure`](super::measure).
    pub longest: Option<Chord>,
    /// The number of rays for it.
    pub rays: u64,
    /// True if the volume reaches the precision.
    pub is_reached: bool,
}

/// The measurements of a model, region by region in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurement {
    /// The regions.
    pub regions: Vec<Measured>,
    /// The number of all rays.
    pub rays: u64,
}

impl Measurement {
    /// The volume of all regions together; the half widths are added, which is safe whatever they have in common.
    pub fn volume(&self) -> Estimate {
        let sum = |of: fn(&Measured) -> f64| self.regions.iter().map(of).sum();
        Estimate { value: sum(|r| r.volume.value), half_width: sum(|r| r.volume.half_width) }
    }
}

/// The weights that make the volume of moments.
pub(super) fn volume_weights() -> [f64; super::moments::MOMENTS] {
    let mut weights = [0.0; super::moments::MOMENTS];
    weights[0] = 1.0;
    weights
}

/// The report on a region from its integrals about `origin`; `quantile` turns deviations into half widths.
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
    // moving the centre changes nothing to first order: the first moments about it are zero
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

/// How many deviations a half width has, for a level of confidence below 1: the root of erf(q / sqrt 2) = confidence, by
/// halving.
pub(super) fn quantile(confidence: f64) -> f64 {
    // erf(40 / sqrt 2) is 1 in double precision
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
