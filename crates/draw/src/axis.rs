//! Axes of drawings: the map from values to positions, tick marks, and the text of numbers.

/// An interval of values (times, lengths) drawn along an interval of positions.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// The smallest value.
    pub min: f64,
    /// The largest value, above `min`.
    pub max: f64,
    /// The position of the smallest value, in pixels.
    pub start: f64,
    /// The position of the largest value, in pixels.
    pub end: f64,
}

/// The free fraction of the axis before the first value and after the last.
const PADDING: f64 = 0.06;

/// The maximum number of tick marks of an axis.
const MAX_TICKS: i32 = 64;

impl Axis {
    /// An axis that contains all of the given increasing values, with padding on both sides.
    pub fn around(values: &[f64], start: f64, end: f64) -> Axis {
        let (lo, hi) = match values {
            [] => (-1.0, 1.0),
            [only] => (*only, *only),
            [first, .., last] => (*first, *last),
        };
        // halved before the subtraction, since the difference may overflow
        let span = 2.0 * PADDING * (0.5 * hi - 0.5 * lo);
        let margin = if span > 0.0 { span } else { 0.5 * lo.abs().max(2.0) };
        let finite = |value: f64| value.clamp(f64::MIN, f64::MAX);
        Axis { min: finite(lo - margin), max: finite(hi + margin), start, end }
    }

    /// The position of a value; beyond the ends for values out of range.
    pub fn position(&self, value: f64) -> f64 {
        let part = (0.5 * value - 0.5 * self.min) / (0.5 * self.max - 0.5 * self.min);
        self.start + part * (self.end - self.start)
    }

    /// True for values strictly between the ends.
    pub fn contains(&self, value: f64) -> bool {
        self.min < value && value < self.max
    }

    /// About `count` round values between the ends, with their texts.
    pub fn ticks(&self, count: f64) -> Vec<(f64, String)> {
        let step = round_step((self.max / count) - (self.min / count));
        let first = (self.min / step).ceil();
        // far from zero, the distance between neighbouring floats may exceed the step
        let tick = |k: i32| (first + f64::from(k)) * step;
        let mut ticks: Vec<f64> = (0..MAX_TICKS).map(tick).take_while(|&value| value <= self.max).collect();
        ticks.dedup();
        let step = step.max(f64::MIN_POSITIVE);
        ticks.into_iter().map(|value| (value, format_number(value, step))).collect()
    }

    /// The smallest visible difference between values: half a pixel.
    pub fn resolution(&self) -> f64 {
        let per_unit = (self.end - self.start) * 2.0;
        (self.max / per_unit - self.min / per_unit).max(f64::MIN_POSITIVE)
    }
}

/// The smallest number of the form 1, 2 or 5 times a power of ten that is at least a step.
pub fn round_step(step: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(step)));
    let factors = [1.0, 2.0, 5.0, 10.0];
    let enough = factors.into_iter().find(|factor| factor * power >= step * 0.999);
    enough.unwrap_or(10.0) * power
}

/// A number rounded to a resolution ([`rayweave_math::format_to_resolution`]), with a typographic minus sign.
pub fn format_number(value: f64, resolution: f64) -> String {
    rayweave_math::format_to_resolution(value, resolution).replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minus_signs_are_those_of_typography() {
        assert_eq!(format_number(-2.0, 0.01), "\u{2212}2");
        assert_eq!(format_number(2.5e-9, 1e-10), "2.5\u{d7}10^\u{2212}9");
    }

    #[test]
    fn ticks_are_round_and_within() {
        let axis = |min, max| Axis { min, max, start: 0.0, end: 100.0 };
        let ticks = |min, max| axis(min, max).ticks(5.0).into_iter().map(|t| t.0).collect::<Vec<_>>();
        assert_eq!(ticks(-0.5, 10.0), [0.0, 5.0, 10.0]);
        assert_eq!(ticks(-0.72, 12.72), [0.0, 5.0, 10.0]);
        assert_eq!(ticks(1.0, 2.0), [1.0, 1.2000000000000002, 1.4000000000000001, 1.6, 1.8, 2.0]);
        for (min, max) in [(1e8, 1e8 + 1e-6), (f64::MIN, f64::MAX), (5e-324, 1e-320), (-3e-300, 2e300)] {
            let ticks = ticks(min, max);
            assert!(ticks.len() <= 11, "{min} {max}: {ticks:?}");
            assert!(ticks.iter().all(|&t| min <= t && t <= max), "{ticks:?}");
            assert!(ticks.windows(2).all(|pair| pair[0] < pair[1]), "{ticks:?}");
        }
    }

    #[test]
    fn axes_leave_room() {
        let axis = Axis::around(&[2.0, 4.0], 100.0, 200.0);
        assert!(axis.contains(2.0) && axis.contains(4.0));
        assert!((axis.position(3.0) - 150.0).abs() < 1e-12);
        for times in [&[][..], &[0.0], &[1e300], &[-5e-324], &[f64::MIN, f64::MAX]] {
            let axis = Axis::around(times, 0.0, 1.0);
            assert!(axis.min < axis.max && axis.position(axis.min) == 0.0, "{times:?}");
            assert!((axis.position(axis.max) - 1.0).abs() < 1e-12, "{times:?}");
        }
    }
}
