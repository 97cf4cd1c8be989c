//! Curves as SVG: properties by wavelength.

use super::chart::{BELOW, LEFT, MARGIN, TOP, panel_axes};
use crate::axis::Axis;
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

/// Draws curves, each in a panel of its own with its values by wavelength.
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
    let mut path = String::new();
    // writing to a string cannot fail
    for (k, [x, y]) in points.iter().enumerate() {
        let command = if k == 0 { 'M' } else { 'L' };
        let _ = write!(path, "{command}{} {}", Pixels(across.position(*x)), Pixels(up.position(*y)));
    }
    // a single point shows as a short line
    if points.len() == 1 {
        path += "h4";
    }
    svg.path("curve", path, "");
    panel_axes(svg, [&across, &up], ["wavelength / nm", curve.name]);
}
