//! The axes of drawings: the way from values to places, and numbers as people read them.

/// A stretch of values (times, lengths) on a stretch of the drawing.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// The first value.
    pub t_min: f64,
    /// The last value, greater than the first.
    pub t_max: f64,
    /// Where the first one is drawn.
    pub left: f64,
    /// Where the last one is drawn.
    pub right: f64,
}

/// The part of the axis that is free before the first root and after the last.
const PADDING: f64 = 0.06;

impl Axis {
    /// An axis that shows all of some increasing values with something around them.
    pub fn around(times: &[f64], left: f64, right: f64) -> Axis {
        let (lo, hi) = match times {
            [] => (-1.0, 1.0),
            [only] => (*only, *only),
            [first, .., last] => (*first, *last),
        };
        // half of each, since the difference may be more than the largest number
        let span = 2.0 * PADDING * (0.5 * hi - 0.5 * lo);
        let margin = if span > 0.0 { span } else { 0.5 * lo.abs().max(2.0) };
        let cut = |t: f64| t.clamp(f64::MIN, f64::MAX);
        Axis { t_min: cut(lo - margin), t_max: cut(hi + margin), left, right }
    }

    /// Where a value is drawn; beyond the ends for values beyond the window.
    pub fn place(&self, t: f64) -> f64 {
        let part = (0.5 * t - 0.5 * self.t_min) / (0.5 * self.t_max - 0.5 * self.t_min);
        self.left + part * (self.right - self.left)
    }

    /// True for values strictly within the window.
    pub fn shows(&self, t: f64) -> bool {
        self.t_min < t && t < self.t_max
    }

    /// Round values within the window, about `count` of them, with their texts.
    pub fn ticks(&self, count: f64) -> Vec<(f64, String)> {
        let step = round_step((self.t_max / count) - (self.t_min / count));
        let first = (self.t_min / step).ceil();
        // at a great distance from zero neighbouring numbers may be farther apart than the step
        let whole = |k: i32| (first + f64::from(k)) * step;
        let mut ticks: Vec<f64> = (0..64).map(whole).take_while(|&t| t <= self.t_max).collect();
        ticks.dedup();
        let step = step.max(f64::MIN_POSITIVE);
        ticks.into_iter().map(|t| (t, number(t, step))).collect()
    }

    /// The least difference between numbers that is worth writing: less than a pixel.
    pub fn resolution(&self) -> f64 {
        let per_unit = (self.right - self.left) * 2.0;
        (self.t_max / per_unit - self.t_min / per_unit).max(f64::MIN_POSITIVE)
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below a step.
pub fn round_step(step: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(step)));
    let factors = [1.0, 2.0, 5.0, 10.0];
    let enough = factors.into_iter().find(|factor| factor * power >= step * 0.999);
    enough.unwrap_or(10.0) * power
}

/// A number to a resolution: with as many digits as that needs, without zeros at the end.
pub fn number(t: f64, resolution: f64) -> String {
    if t.abs() < 0.5 * resolution {
        return "0".to_owned();
    }
    let size = libm::log10(t.abs().max(resolution));
    let digits = (size - libm::floor(libm::log10(resolution))).ceil().clamp(1.0, 17.0);
    // through the exponential form, which is cut to so many digits
    let exponent_form = format!("{:.*e}", digits as usize, t);
    let rounded: f64 = exponent_form.parse().unwrap_or(t);
    // next to the largest number rounding up leads nowhere
    let rounded = if rounded.is_finite() { rounded } else { t };
    let plain = rounded.to_string();
    let with_exponent = format!("{rounded:e}").replace('e', "\u{d7}10^");
    let text = if plain.chars().count() <= with_exponent.chars().count() + 1 { plain } else { with_exponent };
    text.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_they_need() {
        let cases = [
            (0.1 + 0.2, 1e-3, "0.3"),
            (1.0 / 3.0, 1e-3, "0.3333"),
            (-2.0, 0.01, "\u{2212}2"),
            (-0.0, 0.01, "0"),
            (1e-17, 0.01, "0"),
            (100_000_000.25, 0.1, "100000000.25"),
            (1e8, 1e3, "1\u{d7}10^8"),
            (2.5e-9, 1e-10, "2.5\u{d7}10^\u{2212}9"),
            (123_456.0, 1000.0, "123500"),
            (f64::MAX, 1e306, "1.7976931348623157\u{d7}10^308"),
        ];
        for (t, resolution, text) in cases {
            assert_eq!(number(t, resolution), text);
        }
    }

    #[test]
    fn ticks_are_round_and_within() {
        let axis = |t_min, t_max| Axis { t_min, t_max, left: 0.0, right: 100.0 };
        let ticks = |t_min, t_max| axis(t_min, t_max).ticks(5.0).into_iter().map(|t| t.0).collect::<Vec<_>>();
        assert_eq!(ticks(-0.5, 10.0), [0.0, 5.0, 10.0]);
        assert_eq!(ticks(-0.72, 12.72), [0.0, 5.0, 10.0]);
        assert_eq!(ticks(1.0, 2.0), [1.0, 1.2000000000000002, 1.4000000000000001, 1.6, 1.8, 2.0]);
        for (t_min, t_max) in [(1e8, 1e8 + 1e-6), (f64::MIN, f64::MAX), (5e-324, 1e-320), (-3e-300, 2e300)] {
            let ticks = ticks(t_min, t_max);
            assert!(ticks.len() <= 11, "{t_min} {t_max}: {ticks:?}");
            assert!(ticks.iter().all(|&t| t_min <= t && t <= t_max), "{ticks:?}");
            assert!(ticks.windows(2).all(|pair| pair[0] < pair[1]), "{ticks:?}");
        }
    }

    #[test]
    fn axes_leave_room() {
        let axis = Axis::around(&[2.0, 4.0], 100.0, 200.0);
        assert!(axis.shows(2.0) && axis.shows(4.0));
        assert!((axis.place(3.0) - 150.0).abs() < 1e-12);
        for times in [&[][..], &[0.0], &[1e300], &[-5e-324], &[f64::MIN, f64::MAX]] {
            let axis = Axis::around(times, 0.0, 1.0);
            assert!(axis.t_min < axis.t_max && axis.place(axis.t_min) == 0.0, "{times:?}");
            assert!((axis.place(axis.t_max) - 1.0).abs() < 1e-12, "{times:?}");
        }
    }
}
