//! Scales of colours: linear, or logarithmic for values of different magnitudes.

use crate::DrawError;
use crate::axis::{Axis, format_number};
use rayweave_error::Message;
use std::str::FromStr;

/// The scale of the colours of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapScale {
    /// From 0 to the largest value.
    #[default]
    Linear,
    /// From the smallest value above 0 to the largest one, by the logarithm; cells without hits are grey.
    Logarithmic,
}

/// Parses `linear` or `log`.
impl FromStr for MapScale {
    type Err = DrawError;

    fn from_str(text: &str) -> Result<MapScale, DrawError> {
        match text {
            "linear" => Ok(MapScale::Linear),
            "log" => Ok(MapScale::Logarithmic),
            _ => {
                let reason = "it must be linear or log";
                Err(DrawError::Option(Message::new(format!("`{text}` is not a scale of hit maps"), reason)))
            }
        }
    }
}

/// The largest ratio of the values of a logarithmic scale.
const MAX_RATIO: f64 = 1e6;

/// The ratio of values below which a logarithmic scale has marks at 2 and 5 times the powers of ten.
const FEW_DECADES: f64 = 1e3;

/// The ends of a scale.
#[derive(Clone, Copy, Debug)]
pub struct ColourScale {
    /// The value of the darkest colour; `None` for a linear scale from 0.
    least: Option<f64>,
    /// The value of the brightest colour.
    peak: f64,
}

impl ColourScale {
    /// A linear scale from 0.
    pub fn linear(peak: f64) -> ColourScale {
        ColourScale { least: None, peak }
    }

    /// The scale of some values, none of which is negative.
    pub fn of(scale: MapScale, values: impl Iterator<Item = f64> + Clone) -> ColourScale {
        let peak = values.clone().fold(0.0, f64::max);
        let least = values.filter(|value| *value > 0.0).fold(f64::INFINITY, f64::min);
        let is_linear = scale == MapScale::Linear || peak == 0.0;
        // equal values are in the middle of a decade
        let least = if least < peak { least.max(peak / MAX_RATIO) } else { 0.1 * peak };
        ColourScale { least: (!is_linear).then_some(least), peak }
    }

    /// The place of a value on the scale, from 0 to 1; `None` for 0 on a logarithmic scale.
    pub fn part(&self, value: f64) -> Option<f64> {
        match self.least {
            None => Some(value / self.peak),
            Some(_) if value <= 0.0 => None,
            Some(least) => Some((libm::log(value / least) / libm::log(self.peak / least)).clamp(0.0, 1.0)),
        }
    }

    /// The marks of a colour bar of a height in pixels: places from 0 to 1, and texts.
    pub fn ticks(&self, height: f64) -> Vec<(f64, String)> {
        let Some(least) = self.least else {
            let axis = Axis { min: 0.0, max: self.peak.max(f64::MIN_POSITIVE), start: 0.0, end: 1.0 };
            let ticks = axis.ticks((height / 45.0).max(1.0)).into_iter();
            return ticks.map(|(value, text)| (axis.position(value), text)).collect();
        };
        let factors: &[f64] = if self.peak / least < FEW_DECADES { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let [first, last] = [least, self.peak].map(|value| libm::floor(libm::log10(value)) as i32);
        let powers = (first..=last).map(|k| libm::pow(10.0, f64::from(k)));
        let values = powers.flat_map(|power| factors.iter().map(move |factor| (factor * power, power)));
        let shown = values.filter(|(value, _)| (least..=self.peak).contains(value));
        shown.filter_map(|(value, power)| Some((self.part(value)?, format_number(value, power)))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_scale_has_equal_steps_for_equal_ratios() {
        let scale = ColourScale::of(MapScale::Logarithmic, [0.0, 0.5, 5.0, 50.0].into_iter());
        assert_eq!(scale.part(0.0), None);
        for (value, part) in [(0.5, 0.0), (5.0, 0.5), (50.0, 1.0), (0.1, 0.0)] {
            assert!((scale.part(value).unwrap() - part).abs() < 1e-12, "{value}");
        }
        let ticks: Vec<String> = scale.ticks(250.0).into_iter().map(|(_, text)| text).collect();
        assert_eq!(ticks, ["0.5", "1", "2", "5", "10", "20", "50"]);
        // one value
        assert_eq!(ColourScale::of(MapScale::Logarithmic, [3.0].into_iter()).part(3.0), Some(1.0));
        assert_eq!(ColourScale::linear(8.0).part(2.0), Some(0.25));
        let error = "lin".parse::<MapScale>().unwrap_err().to_string();
        assert_eq!(error, "`lin` is not a scale of hit maps: it must be linear or log.");
    }
}
