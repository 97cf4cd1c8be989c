//! Histograms as SVG, such as distributions of times and wavelengths.

use super::chart::{BELOW, LEFT, MARGIN, TOP, panel_axes};
use crate::axis::{Axis, format_number, round_step};
use crate::legend::wavelength_paint;
use crate::svg::{Anchor, Svg};

/// Values of a quantity.
#[derive(Clone, Copy, Debug)]
pub struct Histogram<'a> {
    /// The name of the quantity, such as `time`.
    pub name: &'a str,
    /// The unit.
    pub unit: &'a str,
    /// The values; those that are not finite are left out.
    pub values: &'a [f64],
    /// True for wavelengths in nm: bars have the colours of light.
    pub is_wavelength: bool,
    /// The number of bins; by default about 60 of a round width, fewer for few values.
    pub bins: Option<usize>,
    /// The ends of the axis; values beyond are left out of the bins. By default the range of the values, without a long tail.
    pub range: Option<[f64; 2]>,
}

impl<'a> Histogram<'a> {
    /// A histogram with the default bins and range.
    pub fn new(name: &'a str, unit: &'a str, values: &'a [f64]) -> Histogram<'a> {
        Histogram { name, unit, values, is_wavelength: false, bins: None, range: None }
    }
}

const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 260.0;
const HEADING: f64 = 0.0;

/// The approximate number of bins of a histogram with many values.
const BINS: f64 = 60.0;

/// The number of empty bins on either side if all values are equal.
const ALONE: f64 = 10.0;

/// The minimum fraction of the values on the axis: single late photons do not hide the shape.
const SHOWN: f64 = 0.995;

const STYLE: &str = "\
.bar { stroke: none; shape-rendering: crispEdges }
";

/// The fill of bars.
const BAR: &str = "#4a7fb0";

/// The bins of a histogram.
struct Bins {
    lo: f64,
    width: f64,
    counts: Vec<u64>,
    /// The number of values beyond the last bin.
    beyond: usize,
}

/// Draws histograms side by side: the number of values in bins of a round width. The highest 0.5 % of the values may lie beyond
/// the axis; the subtitle states their number.
///
/// ```
/// use rayweave_draw::detector::{Histogram, histograms_svg};
///
/// let times = [1.0, 1.5, 2.0, 2.1];
/// let time = Histogram::new("time", "ns", &times);
/// assert!(histograms_svg(&[time], "hits").contains("time / ns"));
/// ```
pub fn histograms_svg(histograms: &[Histogram<'_>], title: &str) -> String {
    let mut svg = Svg::default();
    svg.text("title", [MARGIN, 30.0], Anchor::Start, title, title);
    let panel = [LEFT + WIDTH + MARGIN, TOP + HEIGHT + BELOW];
    for (k, histogram) in histograms.iter().enumerate() {
        draw(histogram, [panel[0] * k as f64 + LEFT, HEADING + TOP], &mut svg);
    }
    let names: Vec<&str> = histograms.iter().map(|histogram| histogram.name).collect();
    let description = format!("Histograms: {}.", names.join(", "));
    svg.finish([panel[0] * histograms.len().max(1) as f64, HEADING + panel[1]], title, &description, STYLE)
}

fn draw(histogram: &Histogram<'_>, [left, top]: [f64; 2], svg: &mut Svg) {
    let Histogram { name, unit, is_wavelength, .. } = *histogram;
    let values: Vec<f64> = histogram.values.iter().copied().filter(|value| value.is_finite()).collect();
    let subtitle_at = [left + MARGIN - LEFT, top - 34.0];
    if values.is_empty() {
        // axes without values would have numbers of no meaning
        let text = format!("{name}: no hits");
        return svg.text("tick", subtitle_at, Anchor::Start, &text, &text);
    }
    let bins = Bins::of(histogram, &values);
    let highest = bins.counts.iter().copied().max().unwrap_or(0).max(1) as f64;
    let (right, bottom) = (left + WIDTH, top + HEIGHT);
    let across = Axis { min: bins.lo, max: bins.end(), start: left, end: right };
    let up = Axis { min: 0.0, max: 1.05 * highest, start: bottom, end: top };
    for (k, &count) in bins.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let [from, to] = [k, k + 1].map(|k| bins.lo + k as f64 * bins.width);
        let (x, end, y) = (across.position(from), across.position(to), up.position(count as f64));
        let fill = if is_wavelength { wavelength_paint(0.5 * (from + to)) } else { BAR.to_owned() };
        svg.rectangle("bar", [x, y, (end - x).max(1.0), bottom - y], &format!(r#" fill="{fill}""#));
    }
    let width = format!("hits per {} {unit}", format_number(bins.width, 1e-3 * bins.width));
    panel_axes(svg, [&across, &up], [&format!("{name} / {unit}"), &width]);
    let subtitle = subtitle(&values, unit, bins.beyond);
    svg.text("tick", subtitle_at, Anchor::Start, &subtitle, &subtitle);
}

fn subtitle(values: &[f64], unit: &str, beyond: usize) -> String {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let square = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>();
    let deviation = (square / values.len() as f64).sqrt();
    let [mean, deviation] = [mean, deviation].map(|x| format_number(x, 1e-4 * mean.abs().max(1e-300)));
    let beyond = if beyond > 0 { format!(", {beyond} beyond the axis") } else { String::new() };
    format!("{} hits, mean {mean} {unit}, standard deviation {deviation} {unit}{beyond}", values.len())
}

/// The number of the bin of a value, counted from the one that begins at `lo`. A value that only rounding keeps below the edge of a
/// bin belongs to that bin.
fn bin_number(value: f64, lo: f64, width: f64) -> f64 {
    // the wavelength of a photon comes from its energy: 420 nm become an energy and 419.99999999999994 nm. These are two roundings
    // of constant and value each, and two more in the difference and the quotient: at most 8 of half an epsilon
    let error = 4.0 * f64::EPSILON * (value.abs() + lo.abs());
    ((value - lo + error) / width).floor()
}

impl Bins {
    fn of(histogram: &Histogram<'_>, values: &[f64]) -> Bins {
        let automatic = Bins::new(values);
        if histogram.bins.is_none() && histogram.range.is_none() {
            return automatic;
        }
        let [lo, hi] = histogram.range.unwrap_or([automatic.lo, automatic.end()]);
        let count = histogram.bins.unwrap_or(BINS as usize).max(1);
        let width = (hi - lo) / count as f64;
        let (mut counts, mut beyond) = (vec![0; count], 0);
        for &value in values {
            let bin = bin_number(value, lo, width);
            match bin >= 0.0 && value <= hi {
                // a value at the upper end belongs to the last bin
                true => counts[(bin as usize).min(count - 1)] += 1,
                false => beyond += 1,
            }
        }
        Bins { lo, width, counts, beyond }
    }

    fn new(values: &[f64]) -> Bins {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (Some(&first), Some(&last)) = (sorted.first(), sorted.last()) else {
            return Bins { lo: 0.0, width: 1.0, counts: vec![0], beyond: 0 };
        };
        let high = sorted[((sorted.len() - 1) as f64 * SHOWN).ceil() as usize];
        // only a long tail is cut off
        let last = if last - first > 1.5 * (high - first) && high > first { high } else { last };
        // fewer bins for few values
        let most = BINS.min((2.0 * (values.len() as f64).sqrt()).max(5.0));
        let (width, margin) = match last > first {
            true => (round_step((last - first) / most), 0.0),
            // equal values: one bin among empty ones, narrow compared with the values, but wider than their rounding errors
            false => (round_step((1e-3 * first.abs()).max(1e-6)), ALONE),
        };
        let begin = bin_number(first, 0.0, width) - margin;
        let lo = begin * width;
        let bin = |value: f64| bin_number(value, 0.0, width) - begin;
        let count = (bin(last) + margin).clamp(0.0, 4.0 * BINS) as usize + 1;
        let mut counts = vec![0; count];
        let mut beyond = 0;
        for value in sorted {
            match counts.get_mut(bin(value) as usize) {
                Some(count) => *count += 1,
                None => beyond += 1,
            }
        }
        Bins { lo, width, counts, beyond }
    }

    fn end(&self) -> f64 {
        self.lo + self.counts.len() as f64 * self.width
    }
}
