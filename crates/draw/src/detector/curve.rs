//! Curves as SVG: properties by wavelength.

use super::chart::{BELOW, LEFT, MARGIN, TOP, panel_axes, panel_axes_with};
use crate::axis::{Axis, format_number};
use crate::svg::{Anchor, Pixels, Svg};
use std::fmt::Write;

/// A quantity that depends on the wavelength.
#[derive(Clone, Copy, Debug)]
pub struct PropertyCurve<'a> {
    /// The name of the quantity with its unit, such as `ABSLENGTH / mm`.
    pub name: &'a str,
    /// The wavelengths in nm, and the values; pairs that are not finite are left out. Straight lines join consecutive points.
    pub points: &'a [[f64; 2]],
}

const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 260.0;

/// The number of panels side by side.
const COLUMNS: usize = 3;

const STYLE: &str = "\
.curve { fill: none; stroke: #4a7fb0; stroke-width: 2 }
";

/// The ratio of positive values above which their axis is logarithmic.
const MAX_LINEAR: f64 = 1e3;

/// The largest number of intervals between the marks of a logarithmic axis.
const MAX_MARKS: i32 = 6;

/// Draws curves, each in a panel of its own with its values by wavelength. Positive values of more than three decades have a
/// logarithmic axis.
///
/// ```
/// use rayweave_draw::detector::{PropertyCurve, property_curves_svg};
///
/// let index = PropertyCurve { name: "RINDEX", points: &[[400.0, 1.53], [700.0, 1.51]] };
/// assert!(property_curves_svg(&[index], "glass").contains("wavelength / nm"));
/// ```
pub fn property_curves_svg(curves: &[PropertyCurve<'_>], title: &str) -> String {
    let mut svg = Svg::default();
    svg.text("title", [MARGIN, 30.0], Anchor::Start, title, title);
    let panel = [LEFT + WIDTH + MARGIN, TOP + HEIGHT + BELOW];
    for (k, curve) in curves.iter().enumerate() {
        let (column, row) = (k % COLUMNS, k / COLUMNS);
        draw(curve, [panel[0] * column as f64 + LEFT, panel[1] * row as f64 + TOP], &mut svg);
    }
    let names: Vec<&str> = curves.iter().map(|curve| curve.name).collect();
    let description = format!("Properties by wavelength: {}.", names.join(", "));
    let columns = curves.len().clamp(1, COLUMNS) as f64;
    let rows = curves.len().div_ceil(COLUMNS).max(1) as f64;
    svg.finish([columns * panel[0], rows * panel[1]], title, &description, STYLE)
}

fn draw(curve: &PropertyCurve<'_>, [left, top]: [f64; 2], svg: &mut Svg) {
    let is_finite = |point: &&[f64; 2]| point.iter().all(|number| number.is_finite());
    let points: Vec<[f64; 2]> = curve.points.iter().filter(is_finite).copied().collect();
    let axis = |k: usize, start: f64, end: f64| {
        let mut values: Vec<f64> = points.iter().map(|point| point[k]).collect();
        values.sort_by(f64::total_cmp);
        Axis::around(&values, start, end)
    };
    let (across, up) = (axis(0, left, left + WIDTH), axis(1, top + HEIGHT, top));
    let values = || points.iter().map(|point| point[1]);
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    let is_logarithmic = least > 0.0 && most > MAX_LINEAR * least;
    let height = |value: f64| if is_logarithmic { libm::log10(value) } else { value };
    let up = match is_logarithmic {
        true => Axis::around(&[height(least), height(most)], top + HEIGHT, top),
        false => up,
    };
    let mut path = String::new();
    // writing to a string cannot fail
    for (k, [x, y]) in points.iter().enumerate() {
        let command = if k == 0 { 'M' } else { 'L' };
        let _ = write!(path, "{command}{} {}", Pixels(across.position(*x)), Pixels(up.position(height(*y))));
    }
    // a single point shows as a short line
    if points.len() == 1 {
        path += "h4";
    }
    svg.path("curve", path, "");
    let labels = ["wavelength / nm", curve.name];
    match is_logarithmic {
        true => panel_axes_with(svg, [&across, &up], decades(&up), labels),
        false => panel_axes(svg, [&across, &up], labels),
    }
}

/// The marks of an axis of decimal logarithms: powers of ten.
fn decades(axis: &Axis) -> Vec<(f64, String)> {
    let [first, last] = [libm::ceil(axis.min), libm::floor(axis.max)].map(|power| power as i32);
    let step = ((last - first) / MAX_MARKS + 1).max(1);
    let mark = |k: i32| {
        let value = libm::pow(10.0, f64::from(k));
        (f64::from(k), format_number(value, value))
    };
    (first..=last).step_by(step as usize).map(mark).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An absorption length from 0.01 mm to 10 m: each decade has the same height, and 100 mm is at half of it.
    #[test]
    fn values_of_many_decades_have_a_logarithmic_axis() {
        let length = |values: [f64; 3]| {
            let points: Vec<[f64; 2]> =
                [300.0, 400.0, 500.0].into_iter().zip(values).map(|(x, y)| [x, y]).collect();
            property_curves_svg(&[PropertyCurve { name: "ABSLENGTH / mm", points: &points }], "a")
        };
        let heights = |drawing: &str| {
            let line = drawing.lines().find(|line| line.contains("class=\"curve\"")).unwrap();
            let path = line.split('"').find(|part| part.starts_with('M')).unwrap();
            let ends = path[1..].split('L').map(|point| point.split(' ').nth(1).unwrap().parse::<f64>());
            ends.collect::<Result<Vec<_>, _>>().unwrap()
        };
        let drawing = length([0.01, 10.0, 1e4]);
        let [low, middle, high] = heights(&drawing).try_into().unwrap();
        assert!((0.5 * (low + high) - middle).abs() < 0.02 && low > high, "{low} {middle} {high}");
        for mark in [">0.01<", ">1<", ">100<", ">10000<"] {
            assert!(drawing.contains(mark), "{mark}: {drawing}");
        }
        // three decades, and a 0
        for values in [[0.01, 5.005, 10.0], [0.0, 5e3, 1e4]] {
            let [low, middle, high] = heights(&length(values)).try_into().unwrap();
            assert!((0.5 * (low + high) - middle).abs() < 0.02, "{low} {middle} {high}");
        }
    }
}
