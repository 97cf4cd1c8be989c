//! Distributions with linear densities, sampled by the inverse of their integral.

use crate::error::PropertyError;

/// The fraction of an interval below which a fraction `u` of the integral of a linear density lies, whose values at the ends
/// are `a` and `b`: the root of a x + (b - a) x^2 / 2 = u (a + b) / 2 in the form without cancellation.
pub(crate) fn linear_quantile(a: f64, b: f64, u: f64) -> f64 {
    let total = a + b;
    if total <= 0.0 {
        return u;
    }
    let root = (a * a + u * (b - a) * total).max(0.0).sqrt();
    // both are 0 only at the start of a density that rises from 0
    if a + root == 0.0 { 0.0 } else { (u * total / (a + root)).min(1.0) }
}

/// A density that is linear between its points and 0 beyond them.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearDensity {
    points: Vec<f64>,
    values: Vec<f64>,
    /// The integral from the first point to each point.
    cumulative: Vec<f64>,
}

impl LinearDensity {
    /// The density with some values at some points, in any order.
    ///
    /// # Errors
    ///
    /// Fewer than two points, a point that is not positive and finite, a negative value or one that is not finite, and no
    /// positive value.
    pub fn new(mut points: Vec<(f64, f64)>) -> Result<LinearDensity, PropertyError> {
        for (index, &(point, value)) in points.iter().enumerate() {
            if !(point > 0.0 && point.is_finite()) {
                return Err(PropertyError::Wavelength { index, wavelength: point });
            }
            if !value.is_finite() {
                return Err(PropertyError::Value { index, value });
            }
            if value < 0.0 {
                return Err(PropertyError::Negative { index, value });
            }
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for pair in points.windows(2) {
            sum += 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0);
            cumulative.push(sum);
        }
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(if points.is_empty() { PropertyError::Empty } else { PropertyError::Dark });
        }
        let (points, values) = points.into_iter().unzip();
        Ok(LinearDensity { points, values, cumulative })
    }

    /// The point below which a fraction of the integral lies.
    #[must_use]
    pub fn quantile(&self, fraction: f64) -> f64 {
        let last = self.points.len() - 1;
        let target = fraction * self.cumulative[last];
        let k = self.cumulative.partition_point(|&sum| sum <= target).clamp(1, last);
        let area = self.cumulative[k] - self.cumulative[k - 1];
        let rest = ((target - self.cumulative[k - 1]) / area).clamp(0.0, 1.0);
        let x = linear_quantile(self.values[k - 1], self.values[k], if area > 0.0 { rest } else { 0.0 });
        self.points[k - 1] + x * (self.points[k] - self.points[k - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_densities_are_inverted() {
        // density 2 x: quantile sqrt(u); density 2 (1 - x): 1 - sqrt(1 - u)
        for u in [0.0, 0.1, 0.5, 0.99, 1.0] {
            assert!((linear_quantile(0.0, 1.0, u) - u.sqrt()).abs() < 1e-15);
            assert!((linear_quantile(1.0, 0.0, u) - (1.0 - (1.0 - u).sqrt())).abs() < 1e-15);
            assert!((linear_quantile(3.0, 3.0, u) - u).abs() < 1e-15);
        }
        let triangle = LinearDensity::new(vec![(2.0, 1.0), (1.0, 0.0), (3.0, 0.0)]).unwrap();
        for (u, expected) in [(0.125, 1.5), (0.5, 2.0), (0.875, 2.5), (1.0, 3.0)] {
            assert!((triangle.quantile(u) - expected).abs() < 1e-12, "{u}");
        }
        assert!(LinearDensity::new(vec![(1.0, 1.0)]).is_err());
        assert!(LinearDensity::new(vec![(1.0, -1.0), (2.0, 1.0)]).is_err());
    }
}
