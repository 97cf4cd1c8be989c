//! Median and quartiles of repeated measurements.

/// Median, quartiles and range of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// The median.
    pub median: f64,
    /// The lower and the upper quartile.
    pub quartiles: [f64; 2],
    /// The minimum and the maximum.
    pub range: [f64; 2],
    /// Number of samples.
    pub count: usize,
}

impl Statistics {
    /// The statistics of a sample; `None` if it is empty or contains NaN.
    pub fn of(sample: &[f64]) -> Option<Statistics> {
        let mut sorted = sample.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (&first, &last) = (sorted.first()?, sorted.last()?);
        let is_number = !sorted.iter().any(|x| x.is_nan());
        is_number.then(|| Statistics {
            median: quantile(&sorted, 0.5),
            quartiles: [quantile(&sorted, 0.25), quantile(&sorted, 0.75)],
            range: [first, last],
            count: sorted.len(),
        })
    }

    /// The distance between the quartiles (interquartile range), relative to the median.
    pub fn spread(&self) -> f64 {
        (self.quartiles[1] - self.quartiles[0]) / self.median
    }

    /// Maps the statistics by a monotonic function, such as `|x| 1.0 / x` above 0.
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Statistics {
        let both = |[a, b]: [f64; 2]| {
            let (a, b) = (f(a), f(b));
            [a.min(b), a.max(b)]
        };
        Statistics {
            median: f(self.median),
            quartiles: both(self.quartiles),
            range: both(self.range),
            ..*self
        }
    }
}

/// The `p`-quantile of a sorted sample, linear between neighbours: definition 7 of Hyndman and Fan,
/// Sample Quantiles in Statistical Packages (The American Statistician 50, 1996).
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() - 1) as f64;
    let (below, part) = (place.floor() as usize, place.fract());
    let above = (below + 1).min(sorted.len() - 1);
    (1.0 - part) * sorted[below] + part * sorted[above]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_known_samples() {
        let five = Statistics::of(&[5.0, 1.0, 4.0, 2.0, 3.0]).unwrap();
        let expected = Statistics { median: 3.0, quartiles: [2.0, 4.0], range: [1.0, 5.0], count: 5 };
        assert_eq!(five, expected);
        assert_eq!(five.spread(), 2.0 / 3.0);

        let four = Statistics::of(&[1.0, 2.0, 4.0, 8.0]).unwrap();
        assert_eq!((four.median, four.quartiles), (3.0, [1.75, 5.0]));
        assert_eq!(Statistics::of(&[7.0]).unwrap().quartiles, [7.0, 7.0]);
        assert_eq!(Statistics::of(&[]), None);
        assert_eq!(Statistics::of(&[1.0, f64::NAN]), None);
    }

    #[test]
    fn follow_a_falling_function() {
        let rate = Statistics::of(&[1.0, 2.0, 4.0]).unwrap().map(|x| 8.0 / x);
        assert_eq!((rate.median, rate.range), (4.0, [2.0, 8.0]));
    }
}
