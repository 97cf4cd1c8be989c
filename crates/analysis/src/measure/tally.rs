//! Sums over cells, with their covariances.

use super::chord::MeasuredChord;
use super::moments::{MOMENTS, Moments, dot};

/// The entries of a symmetric matrix on and above its diagonal.
pub(super) const ENTRIES: usize = MOMENTS * (MOMENTS + 1) / 2;

/// The contribution of one ray to one region.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RayContribution {
    pub moments: Moments,
    pub area: f64,
    pub longest: MeasuredChord,
}

/// An estimate of all integrals over a region, and of its surface area, with covariances.
#[derive(Clone, Debug)]
pub(super) struct Tally {
    pub moments: Moments,
    pub area: f64,
    pub longest: MeasuredChord,
    /// Variances and covariances of the moments, row by row above the diagonal.
    covariance: [f64; ENTRIES],
    area_variance: f64,
}

impl Default for Tally {
    fn default() -> Self {
        Tally {
            moments: [0.0; MOMENTS],
            area: 0.0,
            longest: MeasuredChord::default(),
            covariance: [0.0; ENTRIES],
            area_variance: 0.0,
        }
    }
}

impl Tally {
    /// The estimate with these sums.
    pub fn of_sums(
        moments: Moments,
        [area, area_variance]: [f64; 2],
        covariance: [f64; ENTRIES],
        longest: MeasuredChord,
    ) -> Tally {
        Tally { moments, area, longest, covariance, area_variance }
    }

    /// Adds a cell of area 1, sampled by two rays.
    pub fn cell(&mut self, a: &RayContribution, b: &RayContribution) {
        let mut half = [0.0; MOMENTS];
        for k in 0..MOMENTS {
            self.moments[k] += 0.5 * (a.moments[k] + b.moments[k]);
            half[k] = 0.5 * (a.moments[k] - b.moments[k]);
        }
        self.area += 0.5 * (a.area + b.area);
        self.longest = self.longest.or_longer(a.longest).or_longer(b.longest);
        self.area_variance += (0.5 * (a.area - b.area)).powi(2);
        let mut entries = self.covariance.iter_mut();
        for i in 0..MOMENTS {
            // `half` comes first in the zip: it ends the loop without consuming an entry of the next row
            for (other, entry) in half[i..].iter().zip(entries.by_ref()) {
                *entry += half[i] * other;
            }
        }
    }

    /// Adds a multiple of an independent estimate, with separate factors for moments and area.
    pub fn add(&mut self, other: &Tally, factor: f64, area_factor: f64) {
        super::moments::add(&mut self.moments, &other.moments, factor);
        self.area += area_factor * other.area;
        self.longest = self.longest.or_longer(other.longest);
        self.area_variance += area_factor * area_factor * other.area_variance;
        let pairs = self.covariance.iter_mut().zip(&other.covariance);
        pairs.for_each(|(own, entry)| *own += factor * factor * entry);
    }

    /// The standard deviation of a weighted sum of moments.
    pub fn deviation(&self, weights: &Moments) -> f64 {
        let mut entries = self.covariance.iter();
        let mut variance = 0.0;
        for i in 0..MOMENTS {
            let row: Vec<f64> = entries.by_ref().take(MOMENTS - i).copied().collect();
            variance += weights[i] * weights[i] * row[0];
            variance +=
                2.0 * weights[i] * row[1..].iter().zip(&weights[i + 1..]).map(|(c, w)| c * w).sum::<f64>();
        }
        variance.max(0.0).sqrt()
    }

    /// The standard deviation of the surface area.
    pub fn area_deviation(&self) -> f64 {
        self.area_variance.sqrt()
    }

    /// A weighted sum of moments.
    pub fn value(&self, weights: &Moments) -> f64 {
        dot(weights, &self.moments)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_cells_by_hand() {
        let found = |volume: f64, x: f64| {
            let mut moments = [0.0; MOMENTS];
            (moments[0], moments[1]) = (volume, x);
            RayContribution { moments, area: volume, ..RayContribution::default() }
        };
        let mut tally = Tally::default();
        tally.cell(&found(1.0, 0.0), &found(3.0, 4.0));
        tally.cell(&found(2.0, 2.0), &found(2.0, 0.0));
        assert_eq!((tally.moments[0], tally.moments[1], tally.area), (4.0, 3.0, 4.0));
        let mut weights = [0.0; MOMENTS];
        weights[0] = 1.0;
        // (1 - 3)^2 / 4
        assert_eq!((tally.deviation(&weights), tally.area_deviation()), (1.0, 1.0));
        weights[1] = 2.0;
        // of volume + 2 x: cells (1, 11) and (6, 2), so (10^2 + 4^2) / 4
        assert!((tally.deviation(&weights) - 29f64.sqrt()).abs() < 1e-14);
    }
}
